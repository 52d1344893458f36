use super::Tracer;
use crate::math::{Scalar, Vector3};
use crate::ray::{Hit, Ray};

impl<T: Scalar> Tracer<'_, T> {
    /// How often the surface winds around a point: 0 outside, 1 inside, more where it folds over itself, negative where it is
    /// inside out. `None` where the surface is open, so that it has no inside, and where the point is not finite. On the
    /// surface, or so near that rounding decides, it is the number of one of the sides. `crossings` is room for a list.
    pub fn winding_number(&self, point: &Vector3<T>, crossings: &mut Vec<Hit<T>>) -> Option<i32> {
        if self.mesh().is_open() || !point.iter().all(|x| x.is_finite()) {
            return None;
        }
        if !self.mesh().aabb().contains(point) {
            return Some(0);
        }
        // Any direction will do: edges and vertices on the way are counted as if the ray passed beside them.
        self.crossings(&Ray::new(*point, Vector3::z()), crossings);
        Some(crossings.iter().map(|crossing| if crossing.is_exit { 1 } else { -1 }).sum())
    }
}
