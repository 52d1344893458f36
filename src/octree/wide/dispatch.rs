//! Chooses, while the program runs, the widest instructions this processor has. The arithmetic is the same on every
//! path, operation by operation, and so are the results, to the bit.

/// What is worth compiling once for each kind of processor. Everything that `run` calls is inlined into it.
pub(super) trait Kernel {
    fn run(&mut self);
}

/// Runs the kernel on the best path.
#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)] // calling code for processors that may not be this one
pub(super) fn dispatch(mut kernel: impl Kernel) {
    use std::is_x86_feature_detected as has;
    let wide = has!("avx2") && has!("fma") && has!("bmi1") && has!("bmi2") && has!("popcnt");
    if wide && has!("avx512f") && has!("avx512bw") && has!("avx512dq") && has!("avx512vl") {
        // SAFETY: the processor has what the function was compiled for.
        unsafe { run_avx512(&mut kernel) }
    } else if wide {
        // SAFETY: the processor has what the function was compiled for.
        unsafe { run_avx2(&mut kernel) }
    } else {
        kernel.run();
    }
}

/// Runs the kernel.
#[cfg(not(target_arch = "x86_64"))]
pub(super) fn dispatch(mut kernel: impl Kernel) {
    kernel.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
fn run_avx2(kernel: &mut impl Kernel) {
    kernel.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,popcnt")]
fn run_avx512(kernel: &mut impl Kernel) {
    kernel.run();
}
