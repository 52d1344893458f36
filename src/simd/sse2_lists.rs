//! Lists of indices, and points given by their indices, with what every x86-64 processor has.
#![allow(unsafe_code)]

use crate::simd::lane::{LANE_COUNT, Mask};
use crate::simd::lanes::Lists;
use crate::simd::one_by_one::bounds_one_by_one;
use nalgebra::Vector3;
use std::arch::x86_64::*;

pub(crate) struct Sse2Lists;

impl Lists for Sse2Lists {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn equal(indices: &[u32; LANE_COUNT], index: u32) -> Mask {
        let mut mask = 0;
        for i in 0..4 {
            // SAFETY: every x86-64 processor has SSE2; four indices may be read.
            let same = unsafe {
                let same =
                    _mm_cmpeq_epi32(_mm_loadu_si128(indices[4 * i..].as_ptr().cast()), _mm_set1_epi32(index as i32));
                _mm_movemask_ps(_mm_castsi128_ps(same))
            };
            mask |= (same as Mask) << (4 * i);
        }
        mask
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn holding(sets: &[Mask; LANE_COUNT], bits: Mask) -> Mask {
        // SAFETY: every x86-64 processor has SSE2; sixteen sets may be read.
        unsafe {
            let bits = _mm_set1_epi16(bits as i16);
            let low = _mm_and_si128(_mm_loadu_si128(sets.as_ptr().cast()), bits);
            let high = _mm_and_si128(_mm_loadu_si128(sets[8..].as_ptr().cast()), bits);
            // All ones and all zeros survive the narrowing.
            _mm_movemask_epi8(_mm_packs_epi16(_mm_cmpeq_epi16(low, bits), _mm_cmpeq_epi16(high, bits))) as Mask
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn with_corner(corners: &[[u8; LANE_COUNT]; 3], place: u8) -> Mask {
        with_corner(corners, place)
    }
}

/// [`Lists::with_corner`]; wider registers would be no use.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn with_corner(corners: &[[u8; LANE_COUNT]; 3], place: u8) -> Mask {
    // SAFETY: every x86-64 processor has SSE2; sixteen places may be read of each.
    unsafe {
        let place = _mm_set1_epi8(place as i8);
        let [a, b, c] = corners.each_ref().map(|of_all| _mm_cmpeq_epi8(_mm_loadu_si128(of_all.as_ptr().cast()), place));
        _mm_movemask_epi8(_mm_or_si128(_mm_or_si128(a, b), c)) as Mask
    }
}

/// Whether each of these points has another behind it in memory, so that four numbers may be read where a point is.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn have_next(indices: &[u32; LANE_COUNT], count: usize) -> bool {
    // SAFETY: every x86-64 processor has SSE2; four indices may be read.
    unsafe {
        // SSE2 compares only signed numbers: the highest bit is turned.
        let turned = _mm_set1_epi32(i32::MIN);
        let last = _mm_xor_si128(_mm_set1_epi32(count.saturating_sub(1) as i32), turned);
        let mut below = _mm_set1_epi32(-1);
        for i in 0..4 {
            let four = _mm_xor_si128(_mm_loadu_si128(indices[4 * i..].as_ptr().cast()), turned);
            below = _mm_and_si128(below, _mm_cmplt_epi32(four, last));
        }
        _mm_movemask_epi8(below) == 0xffff
    }
}

/// [`Lanes::bounds`](crate::simd::Lanes::bounds) with a point to a register, and what follows the point in memory beside it.
/// `have_next` must be true of the indices.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) unsafe fn singles_bounds(
    points: &[Vector3<f32>],
    indices: &[u32; LANE_COUNT],
    have_next: bool,
) -> (Vector3<f32>, Vector3<f32>) {
    if !have_next {
        return bounds_one_by_one(points, indices);
    }
    let [mut lower, mut upper] = [[0.0; 4]; 2];
    // SAFETY: every x86-64 processor has SSE2; behind each of these points there is another.
    unsafe {
        let first = _mm_loadu_ps(points.as_ptr().add(indices[0] as usize).cast());
        let (mut smallest, mut greatest) = (first, first);
        for &index in &indices[1..] {
            let point = _mm_loadu_ps(points.as_ptr().add(index as usize).cast());
            (smallest, greatest) = (_mm_min_ps(point, smallest), _mm_max_ps(point, greatest));
        }
        _mm_storeu_ps(lower.as_mut_ptr(), smallest);
        _mm_storeu_ps(upper.as_mut_ptr(), greatest);
    }
    (Vector3::new(lower[0], lower[1], lower[2]), Vector3::new(upper[0], upper[1], upper[2]))
}
