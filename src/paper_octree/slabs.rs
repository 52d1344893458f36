use crate::math::{Aabb, Scalar, Vector3, margins};
use crate::triangle::Ray;

/// A ray as the faces of boxes see it: where it crosses the plane x = a, t = (a − origin) · inverse.
///
/// Planes are moved outward by `margin`. A triangle test may accept a ray that passes its triangle at a distance of a
/// few rounding units of the largest coordinate difference involved. A box that is nearer may not be skipped, or the octree
/// would miss what testing every triangle finds. The margin is relative to the reach from the ray's origin to the far end of
/// the mesh's box, so it scales with the scene. It is infinite for rays that are to meet every box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slabs<T: Scalar> {
    pub(crate) origin: Vector3<T>,
    pub(crate) inverse: Vector3<T>,
    pub(crate) margin: T,
}

impl<T: Scalar> Slabs<T> {
    pub(crate) fn new(ray: &Ray<T>, mesh_box: &Aabb<T>) -> Self {
        // A finite stand-in for 1/0 keeps 0 · ∞ out of the planes.
        let inverse = ray.direction.map(|d| (T::one() / d).clamp(-T::LARGEST, T::LARGEST));
        let (reach, length) = (mesh_box.reach_from(&ray.origin), ray.direction.amax());
        let [least, most] = margins::reaches_told_apart();
        // Unlike in the default tree, a far origin does not make the stand-in smaller.
        let is_told_apart = length * least <= reach && T::one() <= length * most;
        let margin = if is_told_apart { reach * margins::margin(margins::BOX_FACE) } else { T::INFINITY };
        Self { origin: ray.origin, inverse, margin }
    }

    /// Whether the ray runs backwards along an axis.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn is_mirrored(&self, axis: usize) -> bool {
        self.inverse[axis] < T::zero()
    }

    /// The `t` at which the ray crosses a face with outward direction −axis.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn at_lower(&self, axis: usize, face: T) -> T {
        // The margin comes after the difference: far from the world's origin it would vanish in the rounding of the face.
        (face - self.origin[axis] - self.margin) * self.inverse[axis]
    }

    /// The `t` at which the ray crosses a face with outward direction +axis.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn at_upper(&self, axis: usize, face: T) -> T {
        (face - self.origin[axis] + self.margin) * self.inverse[axis]
    }
}
