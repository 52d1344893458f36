//! The pressure at surface points inside the other body: by their distance to its surface.

use crate::bvh::PacketHits;
use crate::contact::quadrature::packet::KnownDistances;
use crate::math::Scalar;
use crate::query::{PointDistances, Tracer};
use crate::simd::{LANE_COUNT, Lanes, Mask};
use crate::triangle::RayPacket;

/// Replaces the cosines in these lanes by m / depth, m being the distance to the other body's surface. Rays without a depth
/// keep their cosine.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn distances_over_depths<T: Scalar, L: Lanes<T>>(
    other: &Tracer<'_, T>,
    packet: &RayPacket<T>,
    lanes: Mask,
    known: &KnownDistances<T>,
    hits: &PacketHits<T>,
    scratch: &mut PointDistances<T>,
    cosines: &mut [T; LANE_COUNT],
) {
    other.distances_of_packet::<L>(&packet.origin, lanes & !known.lanes, &hits.t, scratch);
    for lane in (0..LANE_COUNT).filter(|lane| lanes >> lane & 1 == 1) {
        let is_known = known.lanes >> lane & 1 == 1 && hits.t[lane] > T::zero();
        cosines[lane] = if is_known {
            known.distances[lane] / hits.t[lane]
        } else {
            ratio(scratch.distances[lane], hits.t[lane], cosines[lane])
        };
    }
}

fn ratio<T: Scalar>(distance: T, depth: T, otherwise: T) -> T {
    let ratio = distance / depth;
    // The hit is a point of the surface too, so only rounding can make it nearer than the nearest. On the surface itself the
    // quotient is undefined.
    if ratio <= T::one() {
        ratio
    } else if depth > T::zero() {
        T::one()
    } else {
        otherwise
    }
}
