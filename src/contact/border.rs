//! Pieces of triangles that the other body's surface crosses: the part inside casts, from its own middle. So thin strips
//! count with the part that is inside, and forces do not jump where a middle passes the surface.

use super::cutter::CutPiece;
use super::samples::Sample;
use crate::closest::ClosestPoint;
use crate::math::{Scalar, Vector3, direction, length};
use crate::mesh::Mesh;
use crate::octree::Tracer;

/// How far from its middle a piece reaches.
pub(super) fn reach<T: Scalar>(corners: &[Vector3<T>; 3], middle: &Vector3<T>) -> T {
    corners.iter().fold(T::zero(), |most, corner| most.max(length(&(corner - middle))))
}

/// What of a piece lies inside the other body, by the plane through the nearest point of its surface.
pub(super) enum Inside<T: Scalar> {
    All,
    Part(Sample<T>),
    Nothing,
}

/// The part of the piece that lies inside, given the nearest point to its middle, and on which side of the surface that is.
pub(super) fn inside_part<T: Scalar>(
    piece: &CutPiece<T>,
    corners: &[Vector3<T>; 3],
    other: &Tracer<'_, T>,
    nearest: &ClosestPoint<T>,
    is_inside: bool,
) -> Inside<T> {
    let middle = &piece.sample.point.position;
    let Some(inward) = inward(other.mesh(), middle, nearest, is_inside) else { return Inside::All };
    let depths = corners.map(|corner| (corner - nearest.position).dot(&inward));
    let Some((part, weights)) = positive_part(depths) else {
        return if depths.iter().all(|&depth| depth > T::zero()) { Inside::All } else { Inside::Nothing };
    };
    let mean = |vectors: &[Vector3<T>; 3]| vectors[0] * weights[0] + vectors[1] * weights[1] + vectors[2] * weights[2];
    let mut sample = piece.sample;
    sample.area *= part;
    sample.point.position = mean(corners);
    sample.point.weights = mean(&piece.corner_weights).into();
    if sample.area > T::zero() { Inside::Part(sample) } else { Inside::Nothing }
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
