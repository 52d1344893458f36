//! Rays and hits.

use crate::math::{Aabb, Scalar, Vector3, margins};

/// A half line, cut at `t_max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray<T: Scalar> {
    /// Where it starts (t = 0).
    pub origin: Vector3<T>,
    /// Where it goes; need not be of unit length. `t` counts multiples of it.
    pub direction: Vector3<T>,
    /// Hits beyond this `t` do not count; may be infinite.
    pub t_max: T,
}

impl<T: Scalar> Ray<T> {
    /// A ray without an end.
    pub fn new(origin: Vector3<T>, direction: Vector3<T>) -> Self {
        Self { origin, direction, t_max: T::INFINITY }
    }

    /// The `t` at which a ray from inside the box leaves it, and a little more: a hit on the box's very face must not be lost to
    /// the rounding of either distance.
    pub fn exit_from(&self, aabb: &Aabb<T>) -> T {
        let margin = aabb.reach_from(&self.origin) * margins::margin(margins::RAY_END);
        let mut exit = T::INFINITY;
        for axis in 0..3 {
            let (origin, direction) = (self.origin[axis], self.direction[axis]);
            if direction > T::zero() {
                exit = exit.min((aabb.upper[axis] - origin + margin) / direction);
            } else if direction < T::zero() {
                exit = exit.min((aabb.lower[axis] - origin - margin) / direction);
            }
        }
        exit
    }

    /// The same ray, ending at `t_max`.
    pub fn until(self, t_max: T) -> Self {
        Self { t_max, ..self }
    }
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit<T: Scalar> {
    /// The triangle's index in its mesh.
    pub triangle: u32,
    /// The point is `origin + t · direction`.
    pub t: T,
    /// Barycentric weights of the point at the triangle's three corners; they sum to 1.
    pub weights: [T; 3],
    /// True where the ray meets the triangle from inside (ray · normal > 0), false where it enters.
    pub is_exit: bool,
}

impl<T: Scalar> Hit<T> {
    /// What this crossing adds to the winding number at the ray's origin.
    pub(crate) fn sign(&self) -> i32 {
        if self.is_exit { 1 } else { -1 }
    }

    /// Whether this hit comes before `other` along the ray; at equal `t` the smaller triangle index does.
    pub fn is_before(&self, other: &Self) -> bool {
        self.t < other.t || (self.t == other.t && self.triangle < other.triangle)
    }
}
