//! Chooses, while the program runs, the widest instructions this processor has. The arithmetic is the same on every
//! path, operation by operation, and so are the results, to the bit.

use super::trace::Walk;
use crate::math::Scalar;

/// Runs the walk on the best path.
#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)] // calling code for processors that may not be this one
pub(super) fn run<T: Scalar, V: FnMut(u32) -> T>(mut walk: Walk<'_, T, V>) {
    if std::is_x86_feature_detected!("avx512f")
        && std::is_x86_feature_detected!("avx512bw")
        && std::is_x86_feature_detected!("avx512dq")
        && std::is_x86_feature_detected!("avx512vl")
    {
        // SAFETY: the processor has what the function was compiled for.
        unsafe { run_avx512(&mut walk) }
    } else if std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma") {
        // SAFETY: the processor has what the function was compiled for.
        unsafe { run_avx2(&mut walk) }
    } else {
        walk.run();
    }
}

/// Runs the walk.
#[cfg(not(target_arch = "x86_64"))]
pub(super) fn run<T: Scalar, V: FnMut(u32) -> T>(mut walk: Walk<'_, T, V>) {
    walk.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
fn run_avx2<T: Scalar, V: FnMut(u32) -> T>(walk: &mut Walk<'_, T, V>) {
    walk.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,popcnt")]
fn run_avx512<T: Scalar, V: FnMut(u32) -> T>(walk: &mut Walk<'_, T, V>) {
    walk.run();
}
