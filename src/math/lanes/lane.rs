//! Single lanes of vectors side by side.

use super::LANE_COUNT;
use crate::math::{Scalar, Vector3};

#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn vector_in_lane<T: Scalar>([x, y, z]: &[[T; LANE_COUNT]; 3], lane: usize) -> Vector3<T> {
    Vector3::new(x[lane], y[lane], z[lane])
}

#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn set_lane<T: Scalar>([x, y, z]: &mut [[T; LANE_COUNT]; 3], lane: usize, vector: &Vector3<T>) {
    (x[lane], y[lane], z[lane]) = (vector.x, vector.y, vector.z);
}
