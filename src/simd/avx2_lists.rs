//! Lists of indices, and points given by their indices, with AVX2.
//!
//! As in `avx2`, only kernels that run on this path may call these functions. Every SAFETY line relies on that.
#![allow(unsafe_code)]

use crate::simd::lane::{LANE_COUNT, Mask};
use crate::simd::lanes::Lists;
use crate::simd::one_by_one::{bounds_one_by_one, gather_one_by_one};
use crate::simd::sse2_lists::with_corner;
use nalgebra::Vector3;
use std::arch::x86_64::*;

/// The places of the bits that are set in each byte, in order; zeros follow.
static PLACES: [[u8; 8]; 256] = places();

const fn places() -> [[u8; 8]; 256] {
    let mut all = [[0; 8]; 256];
    let mut byte = 0;
    while byte < 256 {
        let (mut bit, mut count) = (0, 0);
        while bit < 8 {
            if byte >> bit & 1 == 1 {
                all[byte][count] = bit;
                count += 1;
            }
            bit += 1;
        }
        byte += 1;
    }
    all
}

pub(crate) struct Avx2Lists;

impl Lists for Avx2Lists {
    /// Without a branch.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn append(list: &mut [u32], count: usize, first: u32, bits: Mask) -> usize {
        let behind: &mut [u32; LANE_COUNT] = (&mut list[count..count + LANE_COUNT]).try_into().expect("sixteen places");
        let [low, high] = bits.to_le_bytes();
        let low_count = low.count_ones() as usize;
        // SAFETY: the kernel that runs this checked for AVX2; eight places may be written from the start and from any of the
        // first nine.
        unsafe {
            let low = _mm256_cvtepu8_epi32(_mm_loadl_epi64(PLACES[usize::from(low)].as_ptr().cast()));
            let high = _mm256_cvtepu8_epi32(_mm_loadl_epi64(PLACES[usize::from(high)].as_ptr().cast()));
            let low = _mm256_add_epi32(low, _mm256_set1_epi32(first as i32));
            let high = _mm256_add_epi32(high, _mm256_set1_epi32(first as i32 + 8));
            _mm256_storeu_si256(behind.as_mut_ptr().cast(), low);
            _mm256_storeu_si256(behind[low_count..].as_mut_ptr().cast(), high);
        }
        count + bits.count_ones() as usize
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

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn with_corner(corners: &[[u8; LANE_COUNT]; 3], place: u8) -> Mask {
        with_corner(corners, place)
    }
}

/// Whether each of these points has another behind it in memory, so that four numbers may be read where a point is.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn have_next(indices: &[u32; LANE_COUNT], count: usize) -> bool {
    // SAFETY: the kernel that runs this checked for AVX2; sixteen indices may be read.
    unsafe {
        let last = _mm256_set1_epi32(count.saturating_sub(1) as i32);
        let low = _mm256_loadu_si256(indices.as_ptr().cast());
        let high = _mm256_loadu_si256(indices[8..].as_ptr().cast());
        let greatest = _mm256_max_epu32(low, high);
        let at_least = _mm256_cmpeq_epi32(_mm256_max_epu32(greatest, last), greatest);
        _mm256_testz_si256(at_least, at_least) == 1
    }
}

/// [`Lanes::bounds`](crate::simd::Lanes::bounds) with a point to a register, and what follows the point in memory beside it.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn doubles_bounds(points: &[Vector3<f64>], indices: &[u32; LANE_COUNT]) -> (Vector3<f64>, Vector3<f64>) {
    if !have_next(indices, points.len()) {
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

/// [`Lanes::gather`](crate::simd::Lanes::gather), each point read with what follows it in memory.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn singles_gather(points: &[Vector3<f32>], indices: &[u32; LANE_COUNT]) -> [[__m256; 2]; 3] {
    if !have_next(indices, points.len()) {
        let coordinates = gather_one_by_one(points, indices);
        // SAFETY: the kernel that runs this checked for AVX2; sixteen numbers may be read.
        return coordinates.map(|all| unsafe { [_mm256_loadu_ps(all.as_ptr()), _mm256_loadu_ps(all[8..].as_ptr())] });
    }
    // SAFETY: the kernel that runs this checked for AVX2; behind each of these points there is another.
    unsafe {
        let [mut x, mut y, mut z] = [[_mm256_setzero_ps(); 2]; 3];
        for half in 0..2 {
            let mut rows = [_mm256_setzero_ps(); 4];
            for i in 0..4 {
                let low = points.as_ptr().add(indices[8 * half + i] as usize);
                let high = points.as_ptr().add(indices[8 * half + 4 + i] as usize);
                rows[i] = _mm256_set_m128(_mm_loadu_ps(high.cast()), _mm_loadu_ps(low.cast()));
            }
            let (xy_first, xy_second) = (_mm256_unpacklo_ps(rows[0], rows[1]), _mm256_unpacklo_ps(rows[2], rows[3]));
            let (z_first, z_second) = (_mm256_unpackhi_ps(rows[0], rows[1]), _mm256_unpackhi_ps(rows[2], rows[3]));
            x[half] = _mm256_shuffle_ps::<0b01_00_01_00>(xy_first, xy_second);
            y[half] = _mm256_shuffle_ps::<0b11_10_11_10>(xy_first, xy_second);
            z[half] = _mm256_shuffle_ps::<0b01_00_01_00>(z_first, z_second);
        }
        [x, y, z]
    }
}

/// [`Lanes::gather`](crate::simd::Lanes::gather), each point read with what follows it in memory.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn doubles_gather(points: &[Vector3<f64>], indices: &[u32; LANE_COUNT]) -> [[__m256d; 4]; 3] {
    if !have_next(indices, points.len()) {
        let coordinates = gather_one_by_one(points, indices);
        // SAFETY: the kernel that runs this checked for AVX2; sixteen numbers may be read.
        return coordinates.map(|all| unsafe { [0, 4, 8, 12].map(|place| _mm256_loadu_pd(all[place..].as_ptr())) });
    }
    // SAFETY: the kernel that runs this checked for AVX2; behind each of these points there is another.
    unsafe {
        let [mut x, mut y, mut z] = [[_mm256_setzero_pd(); 4]; 3];
        for quarter in 0..4 {
            let mut rows = [_mm256_setzero_pd(); 4];
            for i in 0..4 {
                rows[i] = _mm256_loadu_pd(points.as_ptr().add(indices[4 * quarter + i] as usize).cast());
            }
            let (xz_first, xz_second) = (_mm256_unpacklo_pd(rows[0], rows[1]), _mm256_unpacklo_pd(rows[2], rows[3]));
            let (y_first, y_second) = (_mm256_unpackhi_pd(rows[0], rows[1]), _mm256_unpackhi_pd(rows[2], rows[3]));
            x[quarter] = _mm256_permute2f128_pd::<0x20>(xz_first, xz_second);
            y[quarter] = _mm256_permute2f128_pd::<0x20>(y_first, y_second);
            z[quarter] = _mm256_permute2f128_pd::<0x31>(xz_first, xz_second);
        }
        [x, y, z]
    }
}
