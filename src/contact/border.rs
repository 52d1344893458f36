//! Pieces of triangles that the other body's surface crosses: the part inside casts, from its own middle. So thin strips
//! count with the part that is inside, and forces do not jump where a middle passes the surface.

use super::cutter::CutPiece;
use super::pair::Direction;
use super::rays::Rays;
use super::samples::Sample;
use crate::closest::ClosestPoint;
use crate::math::{Kernel, LANE_COUNT, Lanes, Mask, Scalar, Vector3, direction, length};
use crate::memory::Room;
use crate::mesh::Mesh;

/// Holds the pieces in a packet against the other body's surface, and keeps what lies inside of those that it
/// crosses. Gives which of the rays in `exits` are no contacts thereby.
pub(super) struct CutAtSurface<'a, 'b, T: Scalar> {
    pub(super) direction: &'a Direction<'b, T>,
    pub(super) rays: &'a mut Rays<T>,
    pub(super) exits: Mask,
    pub(super) inside: &'a mut Vec<Sample<T>>,
}

impl<T: Scalar> Kernel<T> for CutAtSurface<'_, '_, T> {
    type Output = Mask;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) -> Mask {
        let Direction { pair, side } = *self.direction;
        let (own, other) = (pair.tracers[side].mesh(), pair.tracers[1 - side]);
        let rays = self.rays;
        let lanes = |mask: Mask| (0..LANE_COUNT).filter(move |lane| mask >> lane & 1 == 1);
        let asked = rays.cut;
        let mut reaches = [T::zero(); LANE_COUNT];
        for lane in lanes(asked) {
            let piece = rays.piece(lane, own);
            reaches[lane] = reach(&piece.corners(own), &piece.sample.point.position);
        }
        other.distances_of_packet::<L>(&rays.samples.position, asked, &reaches, &mut rays.distances);
        let mut crossed = 0;
        for lane in lanes(asked & !L::load(&reaches).is_at_most(L::load(&rays.distances.distances))) {
            let piece = rays.piece(lane, own);
            let is_inside = self.exits >> lane & 1 == 1;
            let nearest = other.closest_point(&piece.sample.point.position, reaches[lane]);
            let part = nearest.and_then(|nearest| inside_part(&piece, own, other.mesh(), &nearest, is_inside));
            if let Some(part) = part {
                self.inside.room_for(1).push(part);
                crossed |= Mask::from(is_inside) << lane;
            }
        }
        crossed
    }
}

/// How far from its middle a piece reaches.
fn reach<T: Scalar>(corners: &[Vector3<T>; 3], middle: &Vector3<T>) -> T {
    corners.iter().fold(T::zero(), |most, corner| most.max(length(&(corner - middle))))
}

/// The part of a piece that lies inside the other body, by the plane through the nearest point of its surface, given on
/// which side of the surface the middle is; `None` where the plane does not cross it.
fn inside_part<T: Scalar>(
    piece: &CutPiece<T>,
    own: &Mesh<T>,
    other: &Mesh<T>,
    nearest: &ClosestPoint<T>,
    is_inside: bool,
) -> Option<Sample<T>> {
    let inward = inward(other, &piece.sample.point.position, nearest, is_inside)?;
    let corners = piece.corners(own);
    let (part, weights) = positive_part(corners.map(|corner| (corner - nearest.position).dot(&inward)))?;
    let mean = |vectors: &[Vector3<T>; 3]| vectors[0] * weights[0] + vectors[1] * weights[1] + vectors[2] * weights[2];
    let mut sample = piece.sample;
    sample.area *= part;
    sample.point.position = mean(&corners);
    sample.point.weights = mean(&piece.corner_weights).into();
    (sample.area > T::zero()).then_some(sample)
}

/// The direction in which the depth below the surface grows at the point; `None` where no triangle tells.
fn inward<T: Scalar>(
    other: &Mesh<T>,
    point: &Vector3<T>,
    nearest: &ClosestPoint<T>,
    is_inside: bool,
) -> Option<Vector3<T>> {
    let within_face = nearest.weights.iter().all(|&weight| weight > T::zero());
    let away = point - nearest.position;
    match direction(&away) {
        Some(away) if !within_face => Some(if is_inside { away } else { -away }),
        _ => direction(&-other.scaled_normal(nearest.triangle)),
    }
}

/// Of a triangle with a linear function given at its corners: how much of it has positive values, and the weights of that
/// part's middle. `None` where no part, or all, has.
fn positive_part<T: Scalar>(values: [T; 3]) -> Option<(T, [T; 3])> {
    let is_positive = values.map(|value| value > T::zero());
    let count = is_positive.iter().filter(|&&is| is).count();
    if count == 0 || count == 3 {
        return None;
    }
    // The corner on a side of its own, and where the edges from it to the others cross zero.
    let alone = (0..3).find(|&corner| is_positive[corner] == (count == 1))?;
    let others = [(alone + 1) % 3, (alone + 2) % 3];
    let crossings = others.map(|corner| values[alone] / (values[alone] - values[corner]));
    let third = T::one() / T::of(3.0);
    let cut_off = crossings[0] * crossings[1];
    let mut middle = [T::zero(); 3];
    middle[others[0]] = crossings[0] * third;
    middle[others[1]] = crossings[1] * third;
    middle[alone] = T::one() - middle[others[0]] - middle[others[1]];
    if count == 1 {
        return Some((cut_off, middle));
    }
    let rest = T::one() - cut_off;
    (rest > T::zero()).then(|| (rest, middle.map(|weight| (third - weight * cut_off) / rest)))
}
