//! Lanes in the registers of AVX2 with FMA: two for sixteen singles, four for sixteen doubles.
//!
//! Only kernels that run on this path may call these methods: see `dispatch`. Every SAFETY line relies on that.
#![allow(unsafe_code)]

use crate::simd::avx2_lists::{Avx2Lists, doubles_bounds, doubles_gather, have_next, singles_gather};
use crate::simd::dispatch::outlined_avx2;
use crate::simd::lane::{LANE_COUNT, Mask};
use crate::simd::lanes::{Kernel, Lanes};
use crate::simd::registers::{arithmetic, comparisons};
use crate::simd::sse2_lists::singles_bounds;
use nalgebra::Vector3;
use std::arch::x86_64::*;

/// Sixteen `f32`.
#[derive(Clone, Copy)]
pub struct SinglesAvx2([__m256; 2]);

/// Sixteen `f64`.
#[derive(Clone, Copy)]
pub struct DoublesAvx2([__m256d; 4]);

impl Lanes<f32> for SinglesAvx2 {
    type Lists = Avx2Lists;
    const FUSES: bool = true;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn outlined<K: Kernel<f32>>(kernel: K) -> K::Output {
        // SAFETY: the kernel that runs this checked for AVX2 and FMA.
        unsafe { outlined_avx2::<f32, Self, K>(kernel) }
    }

    arithmetic!(
        f32, [0, 1], 8; _mm256_set1_ps, _mm256_loadu_ps, _mm256_storeu_ps, _mm256_add_ps, _mm256_sub_ps, _mm256_mul_ps,
        _mm256_div_ps, _mm256_sqrt_ps, _mm256_fmadd_ps, _mm256_xor_ps, _mm256_min_ps, _mm256_max_ps
    );

    comparisons!(
        [0, 1], 8; _mm256_set1_ps, _mm256_sub_ps, _mm256_mul_ps, _mm256_min_ps, _mm256_max_ps,
        _mm256_cmp_ps::<_CMP_LT_OQ>, _mm256_cmp_ps::<_CMP_LE_OQ>, _mm256_blendv_ps, _mm256_movemask_ps
    );

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn permute(self, places: &[u8; LANE_COUNT]) -> Self {
        // SAFETY: the kernel that runs this checked for AVX2; sixteen bytes may be read.
        unsafe {
            let places = _mm_loadu_si128(places.as_ptr().cast());
            let low = _mm256_cvtepu8_epi32(places);
            let high = _mm256_cvtepu8_epi32(_mm_unpackhi_epi64(places, places));
            Self([self.eight_of_sixteen(low), self.eight_of_sixteen(high)])
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn select(bits: Mask, this: Self, other: Self) -> Self {
        // SAFETY: the kernel that runs this checked for AVX2.
        unsafe {
            // Each lane's bit becomes the sign that chooses.
            let bits = _mm256_set1_epi32(bits.into());
            let low = _mm256_sllv_epi32(bits, _mm256_setr_epi32(31, 30, 29, 28, 27, 26, 25, 24));
            let high = _mm256_sllv_epi32(bits, _mm256_setr_epi32(23, 22, 21, 20, 19, 18, 17, 16));
            Self([
                _mm256_blendv_ps(other.0[0], this.0[0], _mm256_castsi256_ps(low)),
                _mm256_blendv_ps(other.0[1], this.0[1], _mm256_castsi256_ps(high)),
            ])
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn gather(points: &[Vector3<f32>], indices: &[u32; LANE_COUNT]) -> [Self; 3] {
        let [x, y, z] = singles_gather(points, indices);
        [Self(x), Self(y), Self(z)]
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn bounds(points: &[Vector3<f32>], indices: &[u32; LANE_COUNT]) -> (Vector3<f32>, Vector3<f32>) {
        // SAFETY: `have_next` tells the truth.
        unsafe { singles_bounds(points, indices, have_next(indices, points.len())) }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn smallest(self) -> f32 {
        // SAFETY: the kernel that runs this checked for AVX2.
        unsafe {
            let both = _mm256_min_ps(self.0[0], self.0[1]);
            let four = _mm_min_ps(_mm256_castps256_ps128(both), _mm256_extractf128_ps::<1>(both));
            let two = _mm_min_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_min_ss(two, _mm_shuffle_ps::<1>(two, two)))
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn greatest(self) -> f32 {
        // SAFETY: the kernel that runs this checked for AVX2.
        unsafe {
            let both = _mm256_max_ps(self.0[0], self.0[1]);
            let four = _mm_max_ps(_mm256_castps256_ps128(both), _mm256_extractf128_ps::<1>(both));
            let two = _mm_max_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_max_ss(two, _mm_shuffle_ps::<1>(two, two)))
        }
    }
}

impl SinglesAvx2 {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn spread(points: [Self; 2]) -> [Self; 2] {
        points
    }

    /// The points at eight of the places.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn at([x, y]: &[Self; 2], places: &[u8; LANE_COUNT], i: usize) -> [__m256; 2] {
        // SAFETY: the kernel that runs this checked for AVX2; eight bytes may be read.
        unsafe {
            let places = _mm256_cvtepu8_epi32(_mm_loadl_epi64(places[8 * i..8 * i + 8].as_ptr().cast()));
            [x.eight_of_sixteen(places), y.eight_of_sixteen(places)]
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn eight_of_sixteen(self, places: __m256i) -> __m256 {
        // SAFETY: the kernel that runs this checked for AVX2.
        unsafe {
            let low = _mm256_permutevar8x32_ps(self.0[0], places);
            let high = _mm256_permutevar8x32_ps(self.0[1], places);
            // The bit for 8 becomes the sign that chooses.
            _mm256_blendv_ps(low, high, _mm256_castsi256_ps(_mm256_slli_epi32::<28>(places)))
        }
    }
}

impl Lanes<f64> for DoublesAvx2 {
    type Lists = Avx2Lists;
    const FUSES: bool = true;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn outlined<K: Kernel<f64>>(kernel: K) -> K::Output {
        // SAFETY: the kernel that runs this checked for AVX2 and FMA.
        unsafe { outlined_avx2::<f64, Self, K>(kernel) }
    }

    arithmetic!(
        f64, [0, 1, 2, 3], 4; _mm256_set1_pd, _mm256_loadu_pd, _mm256_storeu_pd, _mm256_add_pd, _mm256_sub_pd,
        _mm256_mul_pd, _mm256_div_pd, _mm256_sqrt_pd, _mm256_fmadd_pd, _mm256_xor_pd, _mm256_min_pd, _mm256_max_pd
    );

    comparisons!(
        [0, 1, 2, 3], 4; _mm256_set1_pd, _mm256_sub_pd, _mm256_mul_pd, _mm256_min_pd, _mm256_max_pd,
        _mm256_cmp_pd::<_CMP_LT_OQ>, _mm256_cmp_pd::<_CMP_LE_OQ>, _mm256_blendv_pd, _mm256_movemask_pd
    );

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn permute(self, places: &[u8; LANE_COUNT]) -> Self {
        // There is no permutation of so many: through memory.
        let mut all = [0.0; LANE_COUNT];
        self.store(&mut all);
        let mut result = [0.0; LANE_COUNT];
        for i in 0..LANE_COUNT {
            result[i] = all[usize::from(places[i]) % LANE_COUNT];
        }
        Self::load(&result)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn select(bits: Mask, this: Self, other: Self) -> Self {
        let mut result = other;
        for i in 0..4 {
            // SAFETY: the kernel that runs this checked for AVX2.
            unsafe {
                // Each lane's bit becomes the sign that chooses.
                let bits = _mm256_set1_epi64x((bits >> (4 * i)).into());
                let mask = _mm256_castsi256_pd(_mm256_sllv_epi64(bits, _mm256_setr_epi64x(63, 62, 61, 60)));
                result.0[i] = _mm256_blendv_pd(other.0[i], this.0[i], mask);
            }
        }
        result
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn gather(points: &[Vector3<f64>], indices: &[u32; LANE_COUNT]) -> [Self; 3] {
        let [x, y, z] = doubles_gather(points, indices);
        [Self(x), Self(y), Self(z)]
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn bounds(points: &[Vector3<f64>], indices: &[u32; LANE_COUNT]) -> (Vector3<f64>, Vector3<f64>) {
        doubles_bounds(points, indices)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn smallest(self) -> f64 {
        // SAFETY: the kernel that runs this checked for AVX2.
        unsafe {
            let first = _mm256_min_pd(self.0[0], self.0[1]);
            let both = _mm256_min_pd(first, _mm256_min_pd(self.0[2], self.0[3]));
            let two = _mm_min_pd(_mm256_castpd256_pd128(both), _mm256_extractf128_pd::<1>(both));
            _mm_cvtsd_f64(_mm_min_sd(two, _mm_unpackhi_pd(two, two)))
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn greatest(self) -> f64 {
        // SAFETY: the kernel that runs this checked for AVX2.
        unsafe {
            let first = _mm256_max_pd(self.0[0], self.0[1]);
            let both = _mm256_max_pd(first, _mm256_max_pd(self.0[2], self.0[3]));
            let two = _mm_max_pd(_mm256_castpd256_pd128(both), _mm256_extractf128_pd::<1>(both));
            _mm_cvtsd_f64(_mm_max_sd(two, _mm_unpackhi_pd(two, two)))
        }
    }
}

// A point's two coordinates beside each other in memory are read at once.
impl DoublesAvx2 {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn spread([x, y]: [Self; 2]) -> [[f64; 2]; LANE_COUNT] {
        let mut points = [[0.0; 2]; LANE_COUNT];
        for i in 0..4 {
            // SAFETY: the kernel that runs this checked for AVX2; two numbers may be written at each point.
            unsafe {
                let (low, high) = (_mm256_unpacklo_pd(x.0[i], y.0[i]), _mm256_unpackhi_pd(x.0[i], y.0[i]));
                _mm_storeu_pd(points[4 * i].as_mut_ptr(), _mm256_castpd256_pd128(low));
                _mm_storeu_pd(points[4 * i + 1].as_mut_ptr(), _mm256_castpd256_pd128(high));
                _mm_storeu_pd(points[4 * i + 2].as_mut_ptr(), _mm256_extractf128_pd::<1>(low));
                _mm_storeu_pd(points[4 * i + 3].as_mut_ptr(), _mm256_extractf128_pd::<1>(high));
            }
        }
        points
    }

    /// The points at four of the places.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn at(points: &[[f64; 2]; LANE_COUNT], places: &[u8; LANE_COUNT], i: usize) -> [__m256d; 2] {
        let mut four = [points.as_ptr(); 4];
        for lane in 0..4 {
            four[lane] = &points[usize::from(places[4 * i + lane]) % LANE_COUNT];
        }
        // SAFETY: the kernel that runs this checked for AVX2; two numbers may be read at each point.
        unsafe {
            let first = _mm256_set_m128d(_mm_loadu_pd(four[2].cast()), _mm_loadu_pd(four[0].cast()));
            let second = _mm256_set_m128d(_mm_loadu_pd(four[3].cast()), _mm_loadu_pd(four[1].cast()));
            [_mm256_unpacklo_pd(first, second), _mm256_unpackhi_pd(first, second)]
        }
    }
}
