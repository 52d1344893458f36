//! Pieces of triangles that the other body's surface crosses. Only the part inside casts, from its own middle. So a thin strip
//! counts with the part that is inside, and forces do not jump when a piece's middle passes the surface.

use super::part::{Cut, Part};
use crate::closest::ClosestPoint;
use crate::detection::pair::Direction;
use crate::detection::sample::{CutPiece, Sample, SamplePacket};
use crate::math::{Kernel, LANE_COUNT, Lanes, Mask, Scalar, Vector3, direction, vector_in_lane};
use crate::memory::Room;
use crate::mesh::Mesh;
use crate::octree::{PointDistances, Tracer};

/// A piece is cut by at most this many planes: three faces meet at a simple corner of the other body.
const MOST_PLANES: usize = 3;

/// Holds the pieces in a packet against the other body's surface, and keeps what lies inside of those that it
/// crosses. Gives which of the rays in `exits` are no contacts thereby.
pub(crate) struct CutAtSurface<'a, 'b, T: Scalar> {
    pub(crate) direction: &'a Direction<'b, T>,
    pub(crate) samples: &'a SamplePacket<T>,
    pub(crate) exits: Mask,
    pub(crate) distances: &'a mut PointDistances<T>,
    pub(crate) inside: &'a mut Vec<Sample<T>>,
}

impl<T: Scalar> Kernel<T> for CutAtSurface<'_, '_, T> {
    type Output = Mask;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) -> Mask {
        let Direction { pair, side } = *self.direction;
        let (own, other) = (pair.tracers[side].mesh(), pair.tracers[1 - side]);
        let Self { samples, distances, .. } = self;
        let lanes = |mask: Mask| (0..LANE_COUNT).filter(move |lane| mask >> lane & 1 == 1);
        let mut reaches = [T::zero(); LANE_COUNT];
        for lane in lanes(samples.cut) {
            let part = Part::whole(&samples.corner_weights[lane]);
            let corners = own.corners(samples.indices[lane]);
            reaches[lane] = part.reach(&corners, &vector_in_lane(&samples.lanes.position, lane));
        }
        other.distances_of_packet::<L>(&samples.lanes.position, samples.cut, &reaches, distances);
        let mut crossed = 0;
        for lane in lanes(samples.cut & !L::load(&reaches).is_at_most(L::load(&distances.distances))) {
            let piece = samples.piece(lane, own);
            let is_inside = self.exits >> lane & 1 == 1;
            let nearest = other.closest_of_packet(&piece.sample.point.position, reaches[lane], lane, distances);
            let part = nearest.and_then(|nearest| inside_part(&piece, own, other, &nearest, is_inside));
            if let Some(sample) = part {
                self.inside.room_for(1).push(sample);
                crossed |= Mask::from(is_inside) << lane;
            }
        }
        crossed
    }
}

/// The part of a piece that lies inside the other body, given the point of its surface nearest to the middle, and on which
/// side of it that is; `None` where the surface does not cross the piece.
fn inside_part<T: Scalar>(
    piece: &CutPiece<T>,
    own: &Mesh<T>,
    other: &Tracer<'_, T>,
    first: &ClosestPoint<T>,
    is_inside: bool,
) -> Option<Sample<T>> {
    let whole = Part::whole(&piece.corner_weights);
    let corners = own.corners(piece.sample.point.triangle);
    let (mut part, mut middle, mut nearest, mut known) = (whole, piece.sample.point.position, *first, Some(is_inside));
    for round in 0..MOST_PLANES {
        if round > 0 {
            // After the first cut nobody knows on which side the new middle is; a triangle tells only within its face.
            (middle, known) = (part.middle(&corners).0, None);
            let found = other.closest_point(&middle, part.reach(&corners, &middle));
            let within_face = |point: &ClosestPoint<T>| point.weights.iter().all(|&weight| weight > T::zero());
            let Some(found) = found.filter(within_face) else { break };
            nearest = found;
        }
        let Some(inward) = inward(other.mesh(), &middle, &nearest, known) else { break };
        match part.beyond(&corners, &nearest.position, &inward) {
            Cut::All => break,
            Cut::Some(inside) => part = inside,
            Cut::Nothing => return None,
        }
    }
    let is_cut = part.count != whole.count || part.weights != whole.weights;
    let area = piece.sample.area * (part.doubled_area() / whole.doubled_area());
    (is_cut && area > T::zero()).then(|| {
        let (position, weights) = part.middle(&corners);
        let mut sample = Sample { area, ..piece.sample };
        (sample.point.position, sample.point.weights) = (position, weights.into());
        sample
    })
}

/// The direction in which the depth below the surface grows at the point, given on which side of it that is if it is known;
/// `None` where no triangle tells.
fn inward<T: Scalar>(
    other: &Mesh<T>,
    point: &Vector3<T>,
    nearest: &ClosestPoint<T>,
    is_inside: Option<bool>,
) -> Option<Vector3<T>> {
    let within_face = nearest.weights.iter().all(|&weight| weight > T::zero());
    let (away, outward) = (point - nearest.position, other.scaled_normal(nearest.triangle));
    let is_inside = is_inside.unwrap_or_else(|| away.dot(&outward) < T::zero());
    match direction(&away) {
        Some(away) if !within_face => Some(if is_inside { away } else { -away }),
        _ => direction(&-outward),
    }
}
