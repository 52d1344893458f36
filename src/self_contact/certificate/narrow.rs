use crate::math::margins::NARROW_BOX;
use crate::math::{Aabb, Scalar};
use crate::mesh::Mesh;

/// A box in narrow numbers: its lower coordinates and the negatives of its upper ones, within [`Narrow`]'s box, in units of its
/// longest side, rounded outward. Along an axis two boxes are as far apart as the larger sum of one's lower side and the other's
/// upper side. What lies outside [`Narrow`]'s box is moved to its border, which moves no two boxes farther apart.
pub(crate) type Sides = [f32; 6];

/// This many vertices tell where most of a mesh is.
const LOOKED_AT: usize = 32;
/// The narrow box reaches this many times the size of most of the mesh beyond it: a few vertices may be anywhere.
const FAR: f64 = 1024.0;

/// What narrow numbers are in units of.
#[derive(Clone, Copy)]
pub(crate) struct Narrow<T: Scalar> {
    within: Aabb<T>,
    pub(crate) inverse: T,
}

impl<T: Scalar> Narrow<T> {
    pub(crate) fn new(mesh: &Mesh<T>) -> Self {
        let vertices = mesh.topology().surface_vertices();
        let mut most = *mesh.aabb();
        for axis in 0..3 {
            let along = |i: usize| mesh.position(vertices[i * vertices.len() / LOOKED_AT])[axis];
            let mut places: [T; LOOKED_AT] = std::array::from_fn(along);
            places.sort_unstable_by(|a, b| a.partial_cmp(b).expect("positions are finite"));
            (most.lower[axis], most.upper[axis]) = (places[LOOKED_AT / 4], places[LOOKED_AT * 3 / 4]);
        }
        let far = most.longest_side() * T::of(FAR);
        let within = if far > T::zero() { mesh.aabb().intersection(&most.grown(far)) } else { *mesh.aabb() };
        let inverse = T::one() / within.longest_side();
        // A mesh without extent: all is near.
        Self { within, inverse: if inverse.is_finite() { inverse } else { T::zero() } }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn lower(&self, axis: usize, value: T) -> f32 {
        self.number(axis, value) - NARROW_BOX
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn upper(&self, axis: usize, value: T) -> f32 {
        -self.number(axis, value) - NARROW_BOX
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn number(&self, axis: usize, value: T) -> f32 {
        let inside = value.max(self.within.lower[axis]).min(self.within.upper[axis]);
        ((inside - self.within.lower[axis]) * self.inverse).to_f64() as f32
    }

    /// At most the largest finite number, since places without a triangle are infinitely far.
    pub(crate) fn distance(&self, distance: T) -> f32 {
        ((distance * self.inverse).to_f64() as f32 + NARROW_BOX).min(f32::MAX)
    }
}
