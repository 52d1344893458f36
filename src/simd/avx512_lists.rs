//! Lists of indices with AVX-512.
//!
//! As in `avx512`, only kernels that run on this path may call these functions. Every SAFETY line relies on that.
#![allow(unsafe_code)]

use crate::simd::lane::{LANE_COUNT, Mask};
use crate::simd::lanes::Lists;
use crate::simd::sse2_lists::with_corner;
use std::arch::x86_64::*;

pub(crate) struct Avx512Lists;

impl Lists for Avx512Lists {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn append(list: &mut [u32], count: usize, first: u32, bits: Mask) -> usize {
        let places: &mut [u32; LANE_COUNT] = (&mut list[count..count + LANE_COUNT]).try_into().expect("sixteen places");
        // SAFETY: the kernel that runs this checked for AVX-512; sixteen places may be written.
        unsafe {
            let all = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
            let all = _mm512_add_epi32(all, _mm512_set1_epi32(first as i32));
            _mm512_storeu_si512(places.as_mut_ptr().cast(), _mm512_maskz_compress_epi32(bits, all));
        }
        count + bits.count_ones() as usize
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn equal(indices: &[u32; LANE_COUNT], index: u32) -> Mask {
        // SAFETY: the kernel that runs this checked for AVX-512; sixteen indices may be read.
        unsafe { _mm512_cmpeq_epi32_mask(_mm512_loadu_si512(indices.as_ptr().cast()), _mm512_set1_epi32(index as i32)) }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn holding(sets: &[Mask; LANE_COUNT], bits: Mask) -> Mask {
        // SAFETY: the kernel that runs this checked for AVX-512; sixteen sets may be read.
        unsafe {
            let bits = _mm256_set1_epi16(bits as i16);
            let shared = _mm256_and_si256(_mm256_loadu_si256(sets.as_ptr().cast()), bits);
            _mm256_cmpeq_epi16_mask(shared, bits)
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn with_corner(corners: &[[u8; LANE_COUNT]; 3], place: u8) -> Mask {
        with_corner(corners, place)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn gather_indices(list: &[u32], indices: &[u32; LANE_COUNT]) -> [u32; LANE_COUNT] {
        let mut result = [0; LANE_COUNT];
        let indices = checked(indices, list.len());
        // SAFETY: the kernel that runs this checked for AVX-512; all indices were found to be within the list.
        unsafe {
            let found = _mm512_i32gather_epi32::<4>(indices, list.as_ptr().cast());
            _mm512_storeu_si512(result.as_mut_ptr().cast(), found);
        }
        result
    }
}

/// The indices, all of which are below `count`; three times `count` is within `i32`, as gathers take it.
///
/// # Panics
/// Where that is not so.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn checked(indices: &[u32; LANE_COUNT], count: usize) -> __m512i {
    assert!(count < i32::MAX as usize / 3, "too many points");
    // SAFETY: the kernel that runs this checked for AVX-512; sixteen indices may be read.
    let (indices, are_below) = unsafe {
        let indices = _mm512_loadu_si512(indices.as_ptr().cast());
        (indices, _mm512_cmplt_epu32_mask(indices, _mm512_set1_epi32(count as i32)))
    };
    assert!(are_below == Mask::MAX, "index out of range");
    indices
}

#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn thrice(indices: __m512i) -> __m512i {
    // SAFETY: the kernel that runs this checked for AVX-512.
    unsafe { _mm512_add_epi32(indices, _mm512_add_epi32(indices, indices)) }
}
