//! Single lanes, one after the other.

use nalgebra::{RealField, Vector3};

/// How many numbers go side by side.
pub(crate) const LANE_COUNT: usize = 16;

/// One bit for each lane; bit i is lane i's.
pub(crate) type Mask = u16;

#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn vector_in_lane<T: RealField + Copy>([x, y, z]: &[[T; LANE_COUNT]; 3], lane: usize) -> Vector3<T> {
    Vector3::new(x[lane], y[lane], z[lane])
}

#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn set_lane<T: RealField + Copy>([x, y, z]: &mut [[T; LANE_COUNT]; 3], lane: usize, vector: &Vector3<T>) {
    (x[lane], y[lane], z[lane]) = (vector.x, vector.y, vector.z);
}

/// The lanes whose bits are set, in ascending order.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn lanes_of(bits: Mask) -> impl Iterator<Item = usize> {
    LanesOf(bits)
}

/// See [`lanes_of`].
struct LanesOf(Mask);

impl Iterator for LanesOf {
    type Item = usize;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn next(&mut self) -> Option<usize> {
        let lane = (self.0 != 0).then(|| self.0.trailing_zeros() as usize);
        self.0 &= self.0.wrapping_sub(1);
        lane
    }
}
