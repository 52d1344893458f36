use crate::math::margins::NARROW_BOX;
use crate::math::{Aabb, Scalar, Vector3};

/// A box in narrow numbers: its lower coordinates and the negatives of its upper ones, within the mesh's box and in units
/// of its longest side, rounded outward. So two boxes are at most d apart where no lower side of either and upper side of
/// the other sum to more than d.
pub(crate) type Sides = [f32; 6];

/// What narrow numbers are in units of.
#[derive(Clone, Copy)]
pub(crate) struct Narrow<T: Scalar> {
    origin: Vector3<T>,
    pub(crate) inverse: T,
}

impl<T: Scalar> Narrow<T> {
    pub(crate) fn new(mesh_box: &Aabb<T>) -> Self {
        let inverse = T::one() / mesh_box.longest_side();
        // A mesh without extent: all is near.
        Self { origin: mesh_box.lower, inverse: if inverse.is_finite() { inverse } else { T::zero() } }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn lower(&self, axis: usize, value: T) -> f32 {
        ((value - self.origin[axis]) * self.inverse).to_f64() as f32 - NARROW_BOX
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn upper(&self, axis: usize, value: T) -> f32 {
        -((value - self.origin[axis]) * self.inverse).to_f64() as f32 - NARROW_BOX
    }

    pub(crate) fn distance(&self, distance: T) -> f32 {
        (distance * self.inverse).to_f64() as f32 + NARROW_BOX
    }
}
