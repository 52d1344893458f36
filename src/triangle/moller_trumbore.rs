use crate::math::{Scalar, Vector3};
use crate::triangle::ray::{Hit, Ray};

/// The test of Möller and Trumbore 1997, "Fast, minimum storage ray–triangle intersection": both sides count, there is no
/// threshold on the determinant, and no hit where it is not finite or anything is NaN. Edges shared by two triangles are not
/// guarded.
pub fn moller_trumbore<T: Scalar>(ray: &Ray<T>, corners: &[Vector3<T>; 3], triangle: u32) -> Option<Hit<T>> {
    let edge1 = corners[1] - corners[0];
    let edge2 = corners[2] - corners[0];
    let across = ray.direction.cross(&edge2);
    let determinant = edge1.dot(&across);
    let from_corner = ray.origin - corners[0];
    let along = from_corner.cross(&edge1);

    let v = from_corner.dot(&across) / determinant;
    let w = ray.direction.dot(&along) / determinant;
    let t = edge2.dot(&along) / determinant;
    let zero = T::zero();
    let is_within = v >= zero && w >= zero && v + w <= T::one();
    if is_within && t >= zero && t.is_finite() && determinant.is_finite() {
        // The determinant is −direction · (edge1 × edge2): negative where the ray leaves.
        Some(Hit { triangle, t, weights: [T::one() - v - w, v, w], is_exit: determinant < zero })
    } else {
        None
    }
}
