//! What some processors have no instructions for.

use crate::simd::lane::LANE_COUNT;
use nalgebra::{RealField, Vector3};

/// [`Lanes::gather`](crate::simd::Lanes::gather) point by point.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn gather_one_by_one<T: RealField + Copy>(
    points: &[Vector3<T>],
    indices: &[u32; LANE_COUNT],
) -> [[T; LANE_COUNT]; 3] {
    let mut result = [[T::zero(); LANE_COUNT]; 3];
    for i in 0..LANE_COUNT {
        let point = &points[indices[i] as usize];
        (result[0][i], result[1][i], result[2][i]) = (point.x, point.y, point.z);
    }
    result
}

/// [`Lanes::bounds`](crate::simd::Lanes::bounds) point by point.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn bounds_one_by_one<T: RealField + Copy>(
    points: &[Vector3<T>],
    indices: &[u32; LANE_COUNT],
) -> (Vector3<T>, Vector3<T>) {
    let first = points[indices[0] as usize];
    let (mut lower, mut upper) = (first, first);
    for &index in &indices[1..] {
        let point = &points[index as usize];
        for axis in 0..3 {
            let value = point[axis];
            lower[axis] = if value < lower[axis] { value } else { lower[axis] };
            upper[axis] = if value > upper[axis] { value } else { upper[axis] };
        }
    }
    (lower, upper)
}
