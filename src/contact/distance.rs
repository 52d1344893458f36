//! The pressure at surface points inside the other body: by their distance to its surface.

use crate::math::{LANE_COUNT, Lanes, Mask, Scalar};
use crate::octree::{PacketHits, PointDistances, Tracer};
use crate::ray::{Hit, Ray, RayPacket};

/// What is pressed against what: the measure of depth that a contact's force grows with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ContactLaw {
    /// Pressure k · m at every surface point inside the other body, m being the distance to the nearest point of that
    /// body's surface. The force is the gradient of k times the integral of m over the overlap, so that closed paths cost
    /// no work; it is that of Archimedes on what lies in a flat face, and near that of hydroelastic contact (Elandt et al.,
    /// IROS 2019; Masterjohn et al., RA-L 2022) elsewhere. A contact's `cos_alpha` is then m / depth.
    ///
    /// Rays' own law stays where a body folds over itself, so that m may lead to an inner fold: for rays that went past
    /// folds, and for contacts of a body with itself.
    #[default]
    Pressure,
    /// Pressure k · depth · cos α along the ray, at points whose ray leaves the other body before their own: the paper's
    /// (Hermann, Faure, Raffin 2008, section 4). It is no gradient, and beside edges it may point the wrong way.
    RayLength,
}

/// m / depth of one ray; `usual` where the depth is too small for a quotient.
pub(super) fn distance_over_depth<T: Scalar>(other: &Tracer<'_, T>, ray: &Ray<T>, hit: &Hit<T>, usual: T) -> T {
    let nearest = other.closest_point(&ray.origin, hit.t);
    ratio(nearest.map_or(hit.t, |nearest| nearest.distance), hit.t, usual)
}

/// The same for the rays in `asked`; the others' numbers stay.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn distances_over_depths<T: Scalar, L: Lanes<T>>(
    other: &Tracer<'_, T>,
    packet: &RayPacket<T>,
    asked: Mask,
    hits: &PacketHits<T>,
    room: &mut PointDistances<T>,
    cosines: &mut [T; LANE_COUNT],
) {
    other.distances_of_packet::<L>(&packet.origin, asked, &hits.t, room);
    for lane in (0..LANE_COUNT).filter(|lane| asked >> lane & 1 == 1) {
        cosines[lane] = ratio(room.distances[lane], hits.t[lane], cosines[lane]);
    }
}

fn ratio<T: Scalar>(distance: T, depth: T, usual: T) -> T {
    let ratio = distance / depth;
    // The hit is a point of the surface: only roundings make it the nearer one. On the surface the quotient is none.
    if ratio <= T::one() {
        ratio
    } else if depth > T::zero() {
        T::one()
    } else {
        usual
    }
}
