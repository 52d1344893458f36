//! Lanes in the registers of AVX2 with FMA: two for sixteen singles, four for sixteen doubles.
//!
//! Methods must only be reached inside a kernel that runs on this path: see `dispatch`. That is what every SAFETY line
//! here leans on.
#![allow(unsafe_code)]

use super::portable::{append_one_by_one, bounds_one_by_one, gather_indices_one_by_one};
use super::{LANE_COUNT, Lanes, Mask};
use crate::math::Vector3;
use std::arch::x86_64::*;

/// Sixteen `f32`.
#[derive(Clone, Copy)]
pub struct SinglesAvx2([__m256; 2]);

/// Sixteen `f64`.
#[derive(Clone, Copy)]
pub struct DoublesAvx2([__m256d; 4]);

/// All operations but the permutation, register by register.
macro_rules! register_by_register {
    (
        $scalar:ty, [$($i:literal),*], $width:literal, $splat:ident, $load:ident, $store:ident, $add:ident, $sub:ident,
        $mul:ident, $div:ident, $sqrt:ident, $mul_add:ident, $xor:ident, $min:ident, $max:ident, $compare:ident,
        $blend:ident, $bits:ident
    ) => {
        #[cfg_attr(not(debug_assertions), inline(always))]
        fn splat(value: $scalar) -> Self {
            // SAFETY: the kernel that runs this checked for AVX2.
            let all = unsafe { $splat(value) };
            Self([$({ let _ = $i; all }),*])
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn load(from: &[$scalar; LANE_COUNT]) -> Self {
            // SAFETY: as above; sixteen numbers may be read.
            unsafe { Self([$($load(from[$i * $width..].as_ptr())),*]) }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn store(self, to: &mut [$scalar; LANE_COUNT]) {
            // SAFETY: as above; sixteen numbers may be written.
            unsafe { $($store(to[$i * $width..].as_mut_ptr(), self.0[$i]);)* }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn add(self, other: Self) -> Self {
            // SAFETY: the kernel that runs this checked for AVX2.
            unsafe { Self([$($add(self.0[$i], other.0[$i])),*]) }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn sub(self, other: Self) -> Self {
            // SAFETY: the kernel that runs this checked for AVX2.
            unsafe { Self([$($sub(self.0[$i], other.0[$i])),*]) }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn mul(self, other: Self) -> Self {
            // SAFETY: the kernel that runs this checked for AVX2.
            unsafe { Self([$($mul(self.0[$i], other.0[$i])),*]) }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn div(self, other: Self) -> Self {
            // SAFETY: the kernel that runs this checked for AVX2.
            unsafe { Self([$($div(self.0[$i], other.0[$i])),*]) }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn sqrt(self) -> Self {
            // SAFETY: the kernel that runs this checked for AVX2.
            unsafe { Self([$($sqrt(self.0[$i])),*]) }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn mul_add(self, factor: Self, term: Self) -> Self {
            // SAFETY: the kernel that runs this checked for FMA.
            unsafe { Self([$($mul_add(self.0[$i], factor.0[$i], term.0[$i])),*]) }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn times_add(self, factor: Self, term: Self) -> Self {
            self.mul_add(factor, term)
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn negate(self) -> Self {
            // SAFETY: the kernel that runs this checked for AVX2.
            unsafe { Self([$($xor(self.0[$i], $splat(-0.0))),*]) }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn smaller(self, other: Self) -> Self {
            // SAFETY: the kernel that runs this checked for AVX2.
            unsafe { Self([$($min(self.0[$i], other.0[$i])),*]) }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn larger(self, other: Self) -> Self {
            // SAFETY: the kernel that runs this checked for AVX2.
            unsafe { Self([$($max(self.0[$i], other.0[$i])),*]) }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn is_less(self, other: Self) -> Mask {
            // SAFETY: the kernel that runs this checked for AVX2.
            unsafe { 0 $(| ($bits($compare::<_CMP_LT_OQ>(self.0[$i], other.0[$i])) as Mask) << ($i * $width))* }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn is_at_most(self, other: Self) -> Mask {
            // SAFETY: the kernel that runs this checked for AVX2.
            unsafe { 0 $(| ($bits($compare::<_CMP_LE_OQ>(self.0[$i], other.0[$i])) as Mask) << ($i * $width))* }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn if_less(a: Self, b: Self, this: Self, other: Self) -> Self {
            // SAFETY: the kernel that runs this checked for AVX2.
            unsafe {
                Self([$($blend(other.0[$i], this.0[$i], $compare::<_CMP_LT_OQ>(a.0[$i], b.0[$i]))),*])
            }
        }
    };
}

impl Lanes<f32> for SinglesAvx2 {
    register_by_register!(
        f32,
        [0, 1],
        8,
        _mm256_set1_ps,
        _mm256_loadu_ps,
        _mm256_storeu_ps,
        _mm256_add_ps,
        _mm256_sub_ps,
        _mm256_mul_ps,
        _mm256_div_ps,
        _mm256_sqrt_ps,
        _mm256_fmadd_ps,
        _mm256_xor_ps,
        _mm256_min_ps,
        _mm256_max_ps,
        _mm256_cmp_ps,
        _mm256_blendv_ps,
        _mm256_movemask_ps
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
        let mut signs = [1.0; LANE_COUNT];
        for (i, sign) in signs.iter_mut().enumerate() {
            *sign = if bits >> i & 1 == 1 { -1.0 } else { 1.0 };
        }
        Self::if_less(Self::load(&signs), Self::splat(0.0), this, other)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn gather(points: &[Vector3<f32>], indices: &[u32; LANE_COUNT]) -> [Self; 3] {
        let [mut x, mut y, mut z] = [[0.0; LANE_COUNT]; 3];
        for i in 0..LANE_COUNT {
            let point = &points[indices[i] as usize];
            (x[i], y[i], z[i]) = (point.x, point.y, point.z);
        }
        [Self::load(&x), Self::load(&y), Self::load(&z)]
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn bounds(points: &[Vector3<f32>], indices: &[u32; LANE_COUNT]) -> (Vector3<f32>, Vector3<f32>) {
        singles_bounds(points, indices)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn gather_indices(list: &[u32], indices: &[u32; LANE_COUNT]) -> [u32; LANE_COUNT] {
        gather_indices_one_by_one(list, indices)
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

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn append(list: &mut [u32], count: usize, first: u32, bits: Mask) -> usize {
        append_one_by_one(list, count, first, bits)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn equal(indices: &[u32; LANE_COUNT], index: u32) -> Mask {
        equal(indices, index)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn holding(sets: &[Mask; LANE_COUNT], bits: Mask) -> Mask {
        holding(sets, bits)
    }
}

impl SinglesAvx2 {
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
    register_by_register!(
        f64,
        [0, 1, 2, 3],
        4,
        _mm256_set1_pd,
        _mm256_loadu_pd,
        _mm256_storeu_pd,
        _mm256_add_pd,
        _mm256_sub_pd,
        _mm256_mul_pd,
        _mm256_div_pd,
        _mm256_sqrt_pd,
        _mm256_fmadd_pd,
        _mm256_xor_pd,
        _mm256_min_pd,
        _mm256_max_pd,
        _mm256_cmp_pd,
        _mm256_blendv_pd,
        _mm256_movemask_pd
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
        let mut signs = [1.0; LANE_COUNT];
        for (i, sign) in signs.iter_mut().enumerate() {
            *sign = if bits >> i & 1 == 1 { -1.0 } else { 1.0 };
        }
        Self::if_less(Self::load(&signs), Self::splat(0.0), this, other)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn gather(points: &[Vector3<f64>], indices: &[u32; LANE_COUNT]) -> [Self; 3] {
        let [mut x, mut y, mut z] = [[0.0; LANE_COUNT]; 3];
        for i in 0..LANE_COUNT {
            let point = &points[indices[i] as usize];
            (x[i], y[i], z[i]) = (point.x, point.y, point.z);
        }
        [Self::load(&x), Self::load(&y), Self::load(&z)]
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn bounds(points: &[Vector3<f64>], indices: &[u32; LANE_COUNT]) -> (Vector3<f64>, Vector3<f64>) {
        doubles_bounds(points, indices)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn gather_indices(list: &[u32], indices: &[u32; LANE_COUNT]) -> [u32; LANE_COUNT] {
        gather_indices_one_by_one(list, indices)
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

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn append(list: &mut [u32], count: usize, first: u32, bits: Mask) -> usize {
        append_one_by_one(list, count, first, bits)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn equal(indices: &[u32; LANE_COUNT], index: u32) -> Mask {
        equal(indices, index)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn holding(sets: &[Mask; LANE_COUNT], bits: Mask) -> Mask {
        holding(sets, bits)
    }
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn equal(indices: &[u32; LANE_COUNT], index: u32) -> Mask {
    // SAFETY: the kernel that runs this checked for AVX2; sixteen indices may be read.
    unsafe {
        let index = _mm256_set1_epi32(index as i32);
        let low = _mm256_cmpeq_epi32(_mm256_loadu_si256(indices.as_ptr().cast()), index);
        let high = _mm256_cmpeq_epi32(_mm256_loadu_si256(indices[8..].as_ptr().cast()), index);
        let low = _mm256_movemask_ps(_mm256_castsi256_ps(low)) as Mask;
        let high = _mm256_movemask_ps(_mm256_castsi256_ps(high)) as Mask;
        low | high << 8
    }
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn holding(sets: &[Mask; LANE_COUNT], bits: Mask) -> Mask {
    // SAFETY: the kernel that runs this checked for AVX2; sixteen sets may be read.
    unsafe {
        let bits = _mm256_set1_epi16(bits as i16);
        let shared = _mm256_and_si256(_mm256_loadu_si256(sets.as_ptr().cast()), bits);
        let holding = _mm256_cmpeq_epi16(shared, bits);
        // All ones and all zeros survive the narrowing.
        let narrow = _mm_packs_epi16(_mm256_castsi256_si128(holding), _mm256_extracti128_si256::<1>(holding));
        _mm_movemask_epi8(narrow) as Mask
    }
}

/// Whether all sixteen indices are below the limit.
#[cfg_attr(not(debug_assertions), inline(always))]
fn all_below(indices: &[u32; LANE_COUNT], limit: u32) -> bool {
    // SAFETY: the kernel that runs this checked for AVX2; sixteen indices may be read.
    unsafe {
        let limit = _mm256_set1_epi32(limit as i32);
        let low = _mm256_loadu_si256(indices.as_ptr().cast());
        let high = _mm256_loadu_si256(indices[8..].as_ptr().cast());
        let greatest = _mm256_max_epu32(low, high);
        let at_least = _mm256_cmpeq_epi32(_mm256_max_epu32(greatest, limit), greatest);
        _mm256_testz_si256(at_least, at_least) == 1
    }
}

/// [`Lanes::bounds`] with a point to a register, and what follows the point in memory beside it.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn singles_bounds(points: &[Vector3<f32>], indices: &[u32; LANE_COUNT]) -> (Vector3<f32>, Vector3<f32>) {
    // Behind the last point there is nothing that may be read.
    if points.is_empty() || !all_below(indices, points.len() as u32 - 1) {
        return bounds_one_by_one(points, indices);
    }
    let [mut lower, mut upper] = [[0.0; 4]; 2];
    // SAFETY: the kernel that runs this checked for AVX2; behind each of these points there is another.
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

/// [`Lanes::bounds`] with a point to a register, and what follows the point in memory beside it.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn doubles_bounds(points: &[Vector3<f64>], indices: &[u32; LANE_COUNT]) -> (Vector3<f64>, Vector3<f64>) {
    // Behind the last point there is nothing that may be read.
    if points.is_empty() || !all_below(indices, points.len() as u32 - 1) {
        return bounds_one_by_one(points, indices);
    }
    let [mut lower, mut upper] = [[0.0; 4]; 2];
    // SAFETY: the kernel that runs this checked for AVX2; behind each of these points there is another.
    unsafe {
        let first = _mm256_loadu_pd(points.as_ptr().add(indices[0] as usize).cast());
        let (mut smallest, mut greatest) = (first, first);
        for &index in &indices[1..] {
            let point = _mm256_loadu_pd(points.as_ptr().add(index as usize).cast());
            (smallest, greatest) = (_mm256_min_pd(point, smallest), _mm256_max_pd(point, greatest));
        }
        _mm256_storeu_pd(lower.as_mut_ptr(), smallest);
        _mm256_storeu_pd(upper.as_mut_ptr(), greatest);
    }
    (Vector3::new(lower[0], lower[1], lower[2]), Vector3::new(upper[0], upper[1], upper[2]))
}
