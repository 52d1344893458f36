//! Lanes in the registers that every x86-64 processor has: four for sixteen singles, eight for sixteen doubles.
#![allow(unsafe_code)]

use crate::simd::lane::{LANE_COUNT, Mask};
use crate::simd::lanes::Lanes;
use crate::simd::one_by_one::gather_one_by_one;
use crate::simd::registers::{arithmetic, comparisons};
use crate::simd::sse2_lists::{Sse2Lists, have_next, singles_bounds};
use nalgebra::Vector3;
use std::arch::x86_64::*;

/// Sixteen `f32`.
#[derive(Clone, Copy)]
pub struct SinglesSse2([__m128; 4]);

/// Sixteen `f64`.
#[derive(Clone, Copy)]
pub struct DoublesSse2([__m128d; 8]);

impl Lanes<f32> for SinglesSse2 {
    type Lists = Sse2Lists;
    const PACKETS_PAY: bool = false;

    arithmetic!(
        f32, [0, 1, 2, 3], 4; _mm_set1_ps, _mm_loadu_ps, _mm_storeu_ps, _mm_add_ps, _mm_sub_ps, _mm_mul_ps, _mm_div_ps,
        _mm_sqrt_ps, mul_add_ps, _mm_xor_ps, _mm_min_ps, _mm_max_ps
    );

    comparisons!(
        [0, 1, 2, 3], 4; _mm_set1_ps, _mm_sub_ps, _mm_mul_ps, _mm_min_ps, _mm_max_ps, _mm_cmplt_ps, _mm_cmple_ps,
        blend_ps, _mm_movemask_ps
    );

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn permute(self, places: &[u8; LANE_COUNT]) -> Self {
        // There is no permutation of so many: through memory.
        let mut all = [0.0; LANE_COUNT];
        self.store(&mut all);
        let mut result = self;
        for i in 0..4 {
            let [a, b, c, d] = [0, 1, 2, 3].map(|lane| all[usize::from(places[4 * i + lane]) % LANE_COUNT]);
            // SAFETY: every x86-64 processor has SSE2.
            result.0[i] = unsafe { _mm_setr_ps(a, b, c, d) };
        }
        result
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn select(bits: Mask, this: Self, other: Self) -> Self {
        let mut result = other;
        for i in 0..4 {
            // SAFETY: every x86-64 processor has SSE2.
            unsafe {
                let bits = _mm_set1_epi32((bits >> (4 * i)).into());
                let lanes = _mm_setr_epi32(1, 2, 4, 8);
                let mask = _mm_castsi128_ps(_mm_cmpeq_epi32(_mm_and_si128(bits, lanes), lanes));
                result.0[i] = blend_ps(other.0[i], this.0[i], mask);
            }
        }
        result
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn gather(points: &[Vector3<f32>], indices: &[u32; LANE_COUNT]) -> [Self; 3] {
        if !have_next(indices, points.len()) {
            let [x, y, z] = gather_one_by_one(points, indices);
            return [Self::load(&x), Self::load(&y), Self::load(&z)];
        }
        let [mut x, mut y, mut z] = [Self::splat(0.0); 3];
        for i in 0..4 {
            // SAFETY: every x86-64 processor has SSE2; behind each of these points there is another.
            unsafe {
                let a = _mm_loadu_ps(points.as_ptr().add(indices[4 * i] as usize).cast());
                let b = _mm_loadu_ps(points.as_ptr().add(indices[4 * i + 1] as usize).cast());
                let c = _mm_loadu_ps(points.as_ptr().add(indices[4 * i + 2] as usize).cast());
                let d = _mm_loadu_ps(points.as_ptr().add(indices[4 * i + 3] as usize).cast());
                let (xy_first, xy_second) = (_mm_unpacklo_ps(a, b), _mm_unpacklo_ps(c, d));
                x.0[i] = _mm_movelh_ps(xy_first, xy_second);
                y.0[i] = _mm_movehl_ps(xy_second, xy_first);
                z.0[i] = _mm_movelh_ps(_mm_unpackhi_ps(a, b), _mm_unpackhi_ps(c, d));
            }
        }
        [x, y, z]
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn bounds(points: &[Vector3<f32>], indices: &[u32; LANE_COUNT]) -> (Vector3<f32>, Vector3<f32>) {
        // SAFETY: `have_next` tells the truth.
        unsafe { singles_bounds(points, indices, have_next(indices, points.len())) }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn smallest(self) -> f32 {
        // SAFETY: every x86-64 processor has SSE2.
        unsafe {
            let [a, b, c, d] = self.0;
            let four = _mm_min_ps(_mm_min_ps(a, b), _mm_min_ps(c, d));
            let two = _mm_min_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_min_ss(two, _mm_shuffle_ps::<1>(two, two)))
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn greatest(self) -> f32 {
        // SAFETY: every x86-64 processor has SSE2.
        unsafe {
            let [a, b, c, d] = self.0;
            let four = _mm_max_ps(_mm_max_ps(a, b), _mm_max_ps(c, d));
            let two = _mm_max_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_max_ss(two, _mm_shuffle_ps::<1>(two, two)))
        }
    }
}

// A point's two coordinates beside each other in memory are read at once.
impl SinglesSse2 {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn spread([x, y]: [Self; 2]) -> [f64; LANE_COUNT] {
        let mut points = [0.0; LANE_COUNT];
        for i in 0..4 {
            // SAFETY: every x86-64 processor has SSE2; two pairs may be written.
            unsafe {
                let low = _mm_castps_pd(_mm_unpacklo_ps(x.0[i], y.0[i]));
                let high = _mm_castps_pd(_mm_unpackhi_ps(x.0[i], y.0[i]));
                _mm_storeu_pd(points[4 * i..4 * i + 2].as_mut_ptr(), low);
                _mm_storeu_pd(points[4 * i + 2..4 * i + 4].as_mut_ptr(), high);
            }
        }
        points
    }

    /// The points at four of the places.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn at(points: &[f64; LANE_COUNT], places: &[u8; LANE_COUNT], i: usize) -> [__m128; 2] {
        let [a, b] =
            [points[usize::from(places[4 * i]) % LANE_COUNT], points[usize::from(places[4 * i + 1]) % LANE_COUNT]];
        let [c, d] =
            [points[usize::from(places[4 * i + 2]) % LANE_COUNT], points[usize::from(places[4 * i + 3]) % LANE_COUNT]];
        // SAFETY: every x86-64 processor has SSE2.
        unsafe {
            let (low, high) = (_mm_castpd_ps(_mm_setr_pd(a, b)), _mm_castpd_ps(_mm_setr_pd(c, d)));
            [_mm_shuffle_ps::<0b10_00_10_00>(low, high), _mm_shuffle_ps::<0b11_01_11_01>(low, high)]
        }
    }
}

impl Lanes<f64> for DoublesSse2 {
    type Lists = Sse2Lists;
    const PACKETS_PAY: bool = false;

    arithmetic!(
        f64, [0, 1, 2, 3, 4, 5, 6, 7], 2; _mm_set1_pd, _mm_loadu_pd, _mm_storeu_pd, _mm_add_pd, _mm_sub_pd, _mm_mul_pd,
        _mm_div_pd, _mm_sqrt_pd, mul_add_pd, _mm_xor_pd, _mm_min_pd, _mm_max_pd
    );

    comparisons!(
        [0, 1, 2, 3, 4, 5, 6, 7], 2; _mm_set1_pd, _mm_sub_pd, _mm_mul_pd, _mm_min_pd, _mm_max_pd, _mm_cmplt_pd,
        _mm_cmple_pd, blend_pd, _mm_movemask_pd
    );

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn permute(self, places: &[u8; LANE_COUNT]) -> Self {
        // There is no permutation of so many: through memory.
        let mut all = [0.0; LANE_COUNT];
        self.store(&mut all);
        let mut result = self;
        for i in 0..8 {
            let [a, b] = [0, 1].map(|lane| all[usize::from(places[2 * i + lane]) % LANE_COUNT]);
            // SAFETY: every x86-64 processor has SSE2.
            result.0[i] = unsafe { _mm_setr_pd(a, b) };
        }
        result
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn select(bits: Mask, this: Self, other: Self) -> Self {
        let mut result = other;
        for i in 0..8 {
            // SAFETY: every x86-64 processor has SSE2.
            unsafe {
                let bits = _mm_set1_epi32((bits >> (2 * i)).into());
                let lanes = _mm_setr_epi32(1, 1, 2, 2);
                let mask = _mm_castsi128_pd(_mm_cmpeq_epi32(_mm_and_si128(bits, lanes), lanes));
                result.0[i] = blend_pd(other.0[i], this.0[i], mask);
            }
        }
        result
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn gather(points: &[Vector3<f64>], indices: &[u32; LANE_COUNT]) -> [Self; 3] {
        let [mut x, mut y, mut z] = [Self::splat(0.0); 3];
        for i in 0..8 {
            let (a, b) = (&points[indices[2 * i] as usize], &points[indices[2 * i + 1] as usize]);
            // SAFETY: every x86-64 processor has SSE2; two numbers may be read from the start of a point.
            unsafe {
                let (xy_first, xy_second) = (_mm_loadu_pd(a.as_ptr()), _mm_loadu_pd(b.as_ptr()));
                x.0[i] = _mm_unpacklo_pd(xy_first, xy_second);
                y.0[i] = _mm_unpackhi_pd(xy_first, xy_second);
                z.0[i] = _mm_setr_pd(a.z, b.z);
            }
        }
        [x, y, z]
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn smallest(self) -> f64 {
        // SAFETY: every x86-64 processor has SSE2.
        unsafe {
            let mut two = self.0[0];
            for i in 1..8 {
                two = _mm_min_pd(two, self.0[i]);
            }
            _mm_cvtsd_f64(_mm_min_sd(two, _mm_unpackhi_pd(two, two)))
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn greatest(self) -> f64 {
        // SAFETY: every x86-64 processor has SSE2.
        unsafe {
            let mut two = self.0[0];
            for i in 1..8 {
                two = _mm_max_pd(two, self.0[i]);
            }
            _mm_cvtsd_f64(_mm_max_sd(two, _mm_unpackhi_pd(two, two)))
        }
    }
}

impl DoublesSse2 {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn spread([x, y]: [Self; 2]) -> [[f64; 2]; LANE_COUNT] {
        let mut points = [[0.0; 2]; LANE_COUNT];
        for i in 0..8 {
            // SAFETY: every x86-64 processor has SSE2; two numbers may be written at each point.
            unsafe {
                _mm_storeu_pd(points[2 * i].as_mut_ptr(), _mm_unpacklo_pd(x.0[i], y.0[i]));
                _mm_storeu_pd(points[2 * i + 1].as_mut_ptr(), _mm_unpackhi_pd(x.0[i], y.0[i]));
            }
        }
        points
    }

    /// The points at two of the places.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn at(points: &[[f64; 2]; LANE_COUNT], places: &[u8; LANE_COUNT], i: usize) -> [__m128d; 2] {
        let (a, b) =
            (points[usize::from(places[2 * i]) % LANE_COUNT], points[usize::from(places[2 * i + 1]) % LANE_COUNT]);
        // SAFETY: every x86-64 processor has SSE2; two numbers may be read at each point.
        unsafe {
            let (a, b) = (_mm_loadu_pd(a.as_ptr()), _mm_loadu_pd(b.as_ptr()));
            [_mm_unpacklo_pd(a, b), _mm_unpackhi_pd(a, b)]
        }
    }
}

/// The lanes of `this` where the mask has all bits set, else those of `other`.
#[cfg_attr(not(debug_assertions), inline(always))]
unsafe fn blend_ps(other: __m128, this: __m128, mask: __m128) -> __m128 {
    // SAFETY: every x86-64 processor has SSE2.
    unsafe { _mm_or_ps(_mm_and_ps(mask, this), _mm_andnot_ps(mask, other)) }
}

#[cfg_attr(not(debug_assertions), inline(always))]
unsafe fn blend_pd(other: __m128d, this: __m128d, mask: __m128d) -> __m128d {
    // SAFETY: every x86-64 processor has SSE2.
    unsafe { _mm_or_pd(_mm_and_pd(mask, this), _mm_andnot_pd(mask, other)) }
}

/// SSE2 has no fused multiply-add. In doubles the product is exact, and the sum is rounded to odd; rounded once more, to
/// singles, it is what one rounding gives (Boldo and Melquiond 2008, "Emulation of a FMA and correctly rounded sums").
#[cfg_attr(not(debug_assertions), inline(always))]
unsafe fn mul_add_ps(this: __m128, factor: __m128, term: __m128) -> __m128 {
    // SAFETY: every x86-64 processor has SSE2.
    unsafe {
        let low = odd_product_and_sum(_mm_cvtps_pd(this), _mm_cvtps_pd(factor), _mm_cvtps_pd(term));
        let [this, factor, term] =
            [_mm_movehl_ps(this, this), _mm_movehl_ps(factor, factor), _mm_movehl_ps(term, term)];
        let high = odd_product_and_sum(_mm_cvtps_pd(this), _mm_cvtps_pd(factor), _mm_cvtps_pd(term));
        _mm_movelh_ps(_mm_cvtpd_ps(low), _mm_cvtpd_ps(high))
    }
}

/// a · b + c of numbers that are singles, rounded to odd: where it is inexact, of the two doubles around it the one whose last
/// bit is set.
#[cfg_attr(not(debug_assertions), inline(always))]
unsafe fn odd_product_and_sum(a: __m128d, b: __m128d, c: __m128d) -> __m128d {
    // SAFETY: every x86-64 processor has SSE2.
    unsafe {
        let product = _mm_mul_pd(a, b);
        let sum = _mm_add_pd(product, c);
        // What the sum lacks, exactly (Knuth); NaN where it is not finite.
        let of_term = _mm_sub_pd(sum, product);
        let missing = _mm_add_pd(_mm_sub_pd(product, _mm_sub_pd(sum, of_term)), _mm_sub_pd(c, of_term));
        let zero = _mm_setzero_pd();
        let is_inexact = _mm_or_pd(_mm_cmplt_pd(missing, zero), _mm_cmplt_pd(zero, missing));
        let bits = _mm_castpd_si128(sum);
        let is_even = _mm_andnot_si128(bits, _mm_set1_epi64x(1));
        let step = _mm_and_si128(is_even, _mm_castpd_si128(is_inexact));
        // Away from zero where what is missing has the sum's sign, else toward it.
        let is_toward = _mm_srli_epi64::<63>(_mm_xor_si128(bits, _mm_castpd_si128(missing)));
        let back = _mm_slli_epi64::<1>(_mm_and_si128(step, is_toward));
        _mm_castsi128_pd(_mm_sub_epi64(_mm_add_epi64(bits, step), back))
    }
}

/// Number by number.
#[cfg_attr(not(debug_assertions), inline(always))]
unsafe fn mul_add_pd(this: __m128d, factor: __m128d, term: __m128d) -> __m128d {
    let [mut a, mut b, mut c] = [[0.0; 2]; 3];
    // SAFETY: every x86-64 processor has SSE2; two numbers may be read and written.
    unsafe {
        _mm_storeu_pd(a.as_mut_ptr(), this);
        _mm_storeu_pd(b.as_mut_ptr(), factor);
        _mm_storeu_pd(c.as_mut_ptr(), term);
        for i in 0..2 {
            a[i] = f64::mul_add(a[i], b[i], c[i]);
        }
        _mm_loadu_pd(a.as_ptr())
    }
}
