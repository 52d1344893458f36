//! Sixteen numbers at once, whatever the processor: what the hot loops are written in.
//!
//! Every operation is that of IEEE 754 on each lane by itself, so that all paths, and the same arithmetic on single
//! numbers, give the same bits.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx2_lists;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "x86_64")]
mod avx512_lists;
mod dispatch;
mod lane;
mod lanes;
mod one_by_one;
#[cfg(any(test, not(target_arch = "x86_64")))]
mod portable;
#[cfg(target_arch = "x86_64")]
mod registers;
#[cfg(target_arch = "x86_64")]
mod sse2;
#[cfg(target_arch = "x86_64")]
mod sse2_lists;
#[cfg(all(test, target_arch = "x86_64"))]
mod tests;
mod vectors;

pub(crate) use dispatch::dispatch;
#[cfg(all(test, target_arch = "x86_64"))]
pub(crate) use dispatch::on_every_path;
pub(crate) use lane::{LANE_COUNT, Mask, lanes_of, set_lane, vector_in_lane};
pub use lanes::HasLanes;
pub(crate) use lanes::{Kernel, Lanes, Lists};
pub(crate) use vectors::Vectors;

macro_rules! has_lanes {
    ($scalar:ty, $sse2:ident, $avx2:ident, $avx512:ident) => {
        impl HasLanes for $scalar {
            #[cfg(target_arch = "x86_64")]
            type Baseline = sse2::$sse2;
            #[cfg(target_arch = "x86_64")]
            type Avx2 = avx2::$avx2;
            #[cfg(target_arch = "x86_64")]
            type Avx512 = avx512::$avx512;
            #[cfg(not(target_arch = "x86_64"))]
            type Baseline = portable::Portable<$scalar>;
            #[cfg(not(target_arch = "x86_64"))]
            type Avx2 = portable::Portable<$scalar>;
            #[cfg(not(target_arch = "x86_64"))]
            type Avx512 = portable::Portable<$scalar>;
        }
    };
}

has_lanes!(f32, SinglesSse2, SinglesAvx2, SinglesAvx512);
has_lanes!(f64, DoublesSse2, DoublesAvx2, DoublesAvx512);
