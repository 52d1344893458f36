//! Lanes in the registers of AVX-512: one for sixteen singles, two for sixteen doubles.
//!
//! Only kernels that run on this path may call these methods: see `dispatch`. Every SAFETY line relies on that.
#![allow(unsafe_code)]

use crate::simd::avx2_lists::{doubles_bounds, have_next};
use crate::simd::avx512_lists::{Avx512Lists, checked, thrice};
use crate::simd::dispatch::outlined_avx512;
use crate::simd::lane::{LANE_COUNT, Mask};
use crate::simd::lanes::{Kernel, Lanes};
use crate::simd::registers::arithmetic;
use crate::simd::sse2_lists::singles_bounds;
use nalgebra::Vector3;
use std::arch::x86_64::*;

/// Sixteen `f32`.
#[derive(Clone, Copy)]
pub struct SinglesAvx512([__m512; 1]);

/// Sixteen `f64`.
#[derive(Clone, Copy)]
pub struct DoublesAvx512([__m512d; 2]);

impl Lanes<f32> for SinglesAvx512 {
    type Lists = Avx512Lists;
    const FUSES: bool = true;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn outlined<K: Kernel<f32>>(kernel: K) -> K::Output {
        // SAFETY: the kernel that runs this checked for AVX-512.
        unsafe { outlined_avx512::<f32, Self, K>(kernel) }
    }

    arithmetic!(
        f32, [0], 16; _mm512_set1_ps, _mm512_loadu_ps, _mm512_storeu_ps, _mm512_add_ps, _mm512_sub_ps, _mm512_mul_ps,
        _mm512_div_ps, _mm512_sqrt_ps, _mm512_fmadd_ps, _mm512_xor_ps, _mm512_min_ps, _mm512_max_ps
    );

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_less(self, other: Self) -> Mask {
        // SAFETY: the kernel that runs this checked for AVX-512.
        unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0[0], other.0[0]) }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_at_most(self, other: Self) -> Mask {
        // SAFETY: the kernel that runs this checked for AVX-512.
        unsafe { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0[0], other.0[0]) }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn permute(self, places: &[u8; LANE_COUNT]) -> Self {
        // SAFETY: the kernel that runs this checked for AVX-512; sixteen bytes may be read.
        unsafe {
            let places = _mm512_cvtepu8_epi32(_mm_loadu_si128(places.as_ptr().cast()));
            Self([_mm512_permutexvar_ps(places, self.0[0])])
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn select(bits: Mask, this: Self, other: Self) -> Self {
        // SAFETY: the kernel that runs this checked for AVX-512.
        Self([unsafe { _mm512_mask_blend_ps(bits, other.0[0], this.0[0]) }])
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn gather(points: &[Vector3<f32>], indices: &[u32; LANE_COUNT]) -> [Self; 3] {
        let from = points.as_ptr().cast::<f32>();
        // SAFETY: the kernel that runs this checked for AVX-512; `checked` found all indices below the number of points, of three
        // contiguous numbers each.
        unsafe {
            let places = thrice(checked(indices, points.len()));
            [
                Self([_mm512_i32gather_ps::<4>(places, from)]),
                Self([_mm512_i32gather_ps::<4>(places, from.wrapping_add(1))]),
                Self([_mm512_i32gather_ps::<4>(places, from.wrapping_add(2))]),
            ]
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn bounds(points: &[Vector3<f32>], indices: &[u32; LANE_COUNT]) -> (Vector3<f32>, Vector3<f32>) {
        // SAFETY: `have_next` tells the truth.
        unsafe { singles_bounds(points, indices, have_next(indices, points.len())) }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn smallest(self) -> f32 {
        // SAFETY: the kernel that runs this checked for AVX-512.
        unsafe { _mm512_reduce_min_ps(self.0[0]) }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn greatest(self) -> f32 {
        // SAFETY: the kernel that runs this checked for AVX-512.
        unsafe { _mm512_reduce_max_ps(self.0[0]) }
    }
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn joined(low: __mmask8, high: __mmask8) -> Mask {
    Mask::from(low) | Mask::from(high) << 8
}

impl Lanes<f64> for DoublesAvx512 {
    type Lists = Avx512Lists;
    const FUSES: bool = true;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn outlined<K: Kernel<f64>>(kernel: K) -> K::Output {
        // SAFETY: the kernel that runs this checked for AVX-512.
        unsafe { outlined_avx512::<f64, Self, K>(kernel) }
    }

    arithmetic!(
        f64, [0, 1], 8; _mm512_set1_pd, _mm512_loadu_pd, _mm512_storeu_pd, _mm512_add_pd, _mm512_sub_pd, _mm512_mul_pd,
        _mm512_div_pd, _mm512_sqrt_pd, _mm512_fmadd_pd, _mm512_xor_pd, _mm512_min_pd, _mm512_max_pd
    );

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_less(self, other: Self) -> Mask {
        // SAFETY: the kernel that runs this checked for AVX-512.
        unsafe {
            joined(
                _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0[0], other.0[0]),
                _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0[1], other.0[1]),
            )
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_at_most(self, other: Self) -> Mask {
        // SAFETY: the kernel that runs this checked for AVX-512.
        unsafe {
            joined(
                _mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0[0], other.0[0]),
                _mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0[1], other.0[1]),
            )
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn permute(self, places: &[u8; LANE_COUNT]) -> Self {
        // SAFETY: the kernel that runs this checked for AVX-512; sixteen bytes may be read.
        unsafe {
            let places = _mm_loadu_si128(places.as_ptr().cast());
            let low = _mm512_cvtepu8_epi64(places);
            let high = _mm512_cvtepu8_epi64(_mm_unpackhi_epi64(places, places));
            Self([
                _mm512_permutex2var_pd(self.0[0], low, self.0[1]),
                _mm512_permutex2var_pd(self.0[0], high, self.0[1]),
            ])
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn select(bits: Mask, this: Self, other: Self) -> Self {
        let (low, high) = (bits as __mmask8, (bits >> 8) as __mmask8);
        // SAFETY: the kernel that runs this checked for AVX-512.
        unsafe {
            Self([_mm512_mask_blend_pd(low, other.0[0], this.0[0]), _mm512_mask_blend_pd(high, other.0[1], this.0[1])])
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn gather(points: &[Vector3<f64>], indices: &[u32; LANE_COUNT]) -> [Self; 3] {
        let from = points.as_ptr().cast::<f64>();
        // SAFETY: as for `f32`.
        unsafe {
            let places = thrice(checked(indices, points.len()));
            let (low, high) = (_mm512_castsi512_si256(places), _mm512_extracti64x4_epi64::<1>(places));
            let [x, y, z] = [from, from.wrapping_add(1), from.wrapping_add(2)];
            [
                Self([_mm512_i32gather_pd::<8>(low, x), _mm512_i32gather_pd::<8>(high, x)]),
                Self([_mm512_i32gather_pd::<8>(low, y), _mm512_i32gather_pd::<8>(high, y)]),
                Self([_mm512_i32gather_pd::<8>(low, z), _mm512_i32gather_pd::<8>(high, z)]),
            ]
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn bounds(points: &[Vector3<f64>], indices: &[u32; LANE_COUNT]) -> (Vector3<f64>, Vector3<f64>) {
        doubles_bounds(points, indices)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn smallest(self) -> f64 {
        // SAFETY: the kernel that runs this checked for AVX-512.
        unsafe { _mm512_reduce_min_pd(_mm512_min_pd(self.0[0], self.0[1])) }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn greatest(self) -> f64 {
        // SAFETY: the kernel that runs this checked for AVX-512.
        unsafe { _mm512_reduce_max_pd(_mm512_max_pd(self.0[0], self.0[1])) }
    }
}
