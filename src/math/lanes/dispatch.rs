//! Chooses, while the program runs, the widest instructions this processor has. The arithmetic is the same on every
//! path, operation by operation, and so are the results, to the bit.

use super::{HasLanes, Lanes};

/// What is worth compiling once for each kind of processor. Everything that `run` calls should be inlined into it.
pub(crate) trait Kernel<T> {
    /// What it gives.
    type Output;

    fn run<L: Lanes<T>>(self) -> Self::Output;
}

/// Runs the kernel on the widest lanes.
#[cfg(not(target_arch = "x86_64"))]
pub(crate) fn dispatch<T: HasLanes, K: Kernel<T>>(kernel: K) -> K::Output {
    kernel.run::<T::Portable>()
}

#[cfg(target_arch = "x86_64")]
pub(crate) use x86_64::dispatch;

#[cfg(target_arch = "x86_64")]
mod x86_64 {
    use super::{HasLanes, Kernel};
    use std::is_x86_feature_detected as has;
    use std::sync::OnceLock;

    #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    enum Path {
        Baseline,
        Avx2,
        Avx512,
    }

    /// Runs the kernel on the best path, or on the one that the environment variable `RAYCONTACT_SIMD` names
    /// (`baseline`, `avx2`, `avx512`) if the processor has it. The variable is read once.
    #[allow(unsafe_code)] // calling code for processors that may not be this one
    pub(crate) fn dispatch<T: HasLanes, K: Kernel<T>>(kernel: K) -> K::Output {
        static PATH: OnceLock<Path> = OnceLock::new();
        match PATH.get_or_init(choose) {
            // SAFETY: `choose` found what the function was compiled for.
            Path::Avx512 => unsafe { run_avx512::<T, K>(kernel) },
            // SAFETY: `choose` found what the function was compiled for.
            Path::Avx2 => unsafe { run_avx2::<T, K>(kernel) },
            Path::Baseline => kernel.run::<T::Portable>(),
        }
    }

    fn choose() -> Path {
        let avx2 = has!("avx2") && has!("fma") && has!("bmi1") && has!("bmi2") && has!("popcnt");
        let avx512 = avx2 && has!("avx512f") && has!("avx512bw") && has!("avx512dq") && has!("avx512vl");
        let best = match (avx512, avx2) {
            (true, _) => Path::Avx512,
            (false, true) => Path::Avx2,
            (false, false) => Path::Baseline,
        };
        let asked = std::env::var("RAYCONTACT_SIMD").ok();
        match asked.as_deref() {
            Some("baseline") => Path::Baseline,
            Some("avx2") => best.min(Path::Avx2),
            _ => best,
        }
    }

    #[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
    fn run_avx2<T: HasLanes, K: Kernel<T>>(kernel: K) -> K::Output {
        kernel.run::<T::Avx2>()
    }

    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,popcnt")]
    fn run_avx512<T: HasLanes, K: Kernel<T>>(kernel: K) -> K::Output {
        kernel.run::<T::Avx512>()
    }
}
