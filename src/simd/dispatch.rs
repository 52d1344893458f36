//! Chooses, while the program runs, the widest instructions that this processor has.

#[cfg(not(target_arch = "x86_64"))]
use crate::simd::lanes::{HasLanes, Kernel};

/// Runs the kernel on the widest lanes.
#[cfg(not(target_arch = "x86_64"))]
pub(crate) fn dispatch<T: HasLanes, K: Kernel<T>>(kernel: K) -> K::Output {
    kernel.run::<T::Baseline>()
}

#[cfg(target_arch = "x86_64")]
pub(crate) use x86_64::{dispatch, outlined_avx2, outlined_avx512};
#[cfg(all(test, target_arch = "x86_64"))]
pub(crate) use x86_64::{on_every_path, paths, run_on};

#[cfg(target_arch = "x86_64")]
mod x86_64 {
    use crate::simd::lanes::{HasLanes, Kernel, Lanes};
    use std::is_x86_feature_detected as has;
    use std::sync::OnceLock;

    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
    pub(crate) enum Path {
        Baseline,
        Avx2,
        Avx512,
    }

    // A build for one kind of processor, as with `-C target-cpu=native`, leaves out the paths below it.
    const HAS_AVX2: bool = !cfg!(target_feature = "avx512bw");
    const HAS_BASELINE: bool = HAS_AVX2 && !cfg!(all(target_feature = "avx2", target_feature = "fma"));
    const LEAST: Path = match (HAS_BASELINE, HAS_AVX2) {
        (true, _) => Path::Baseline,
        (false, true) => Path::Avx2,
        (false, false) => Path::Avx512,
    };

    /// Runs the kernel on the best path, or on the one that the environment variable `RAYCONTACT_SIMD` names
    /// (`baseline`, `avx2`, `avx512`) if the build and the processor have it. The variable is read once.
    #[allow(unsafe_code)] // calling code for processors that may not be this one
    pub(crate) fn dispatch<T: HasLanes, K: Kernel<T>>(kernel: K) -> K::Output {
        static PATH: OnceLock<Path> = OnceLock::new();
        // SAFETY: the path lies between the least that was compiled and the best of this processor.
        unsafe { run_on(*PATH.get_or_init(|| choose().min(best()).max(LEAST)), kernel) }
    }

    /// Runs the kernel on a path that this processor and this build must have.
    #[inline(always)]
    #[allow(unsafe_code)] // calling code for processors that may not be this one
    pub(crate) unsafe fn run_on<T: HasLanes, K: Kernel<T>>(path: Path, kernel: K) -> K::Output {
        match path {
            // SAFETY: the caller knows that the processor has what the function was compiled for.
            Path::Avx2 if HAS_AVX2 => unsafe { outlined_avx2::<T, T::Avx2, K>(kernel) },
            Path::Baseline if HAS_BASELINE => T::Baseline::outlined(kernel),
            // SAFETY: the caller knows that the processor has what the function was compiled for.
            _ => unsafe { outlined_avx512::<T, T::Avx512, K>(kernel) },
        }
    }

    fn choose() -> Path {
        match std::env::var("RAYCONTACT_SIMD").ok().as_deref() {
            Some("baseline") => Path::Baseline,
            Some("avx2") => Path::Avx2,
            _ => Path::Avx512,
        }
    }

    /// What the kernel gives on plain loops and on each path that this processor and this build have.
    #[cfg(test)]
    #[allow(unsafe_code)] // calling code for processors that may not be this one
    pub(crate) fn on_every_path<T: HasLanes, K: Kernel<T> + Copy>(kernel: K) -> Vec<K::Output> {
        let portable = crate::simd::portable::Portable::<T>::outlined(kernel);
        // SAFETY: this processor and this build have the path.
        [portable].into_iter().chain(paths().map(|path| unsafe { run_on(path, kernel) })).collect()
    }

    /// The paths that this processor and this build have.
    #[cfg(test)]
    pub(crate) fn paths() -> impl Iterator<Item = Path> {
        [Path::Baseline, Path::Avx2, Path::Avx512].into_iter().filter(|path| (LEAST..=best()).contains(path))
    }

    /// The best path that this processor has.
    fn best() -> Path {
        let avx2 = has!("avx2") && has!("fma") && has!("bmi1") && has!("bmi2") && has!("popcnt");
        let avx512 = avx2 && has!("avx512f") && has!("avx512bw") && has!("avx512dq") && has!("avx512vl");
        match (avx512, avx2) {
            (true, _) => Path::Avx512,
            (false, true) => Path::Avx2,
            (false, false) => Path::Baseline,
        }
    }

    /// Runs the kernel on a processor that has AVX2. Never inlined, so that it is compiled with this library and not again
    /// with every program that uses it.
    #[inline(never)]
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
    pub(crate) fn outlined_avx2<T: HasLanes, L: Lanes<T>, K: Kernel<T>>(kernel: K) -> K::Output {
        kernel.run::<L>()
    }

    /// Runs the kernel on a processor that has AVX-512.
    #[inline(never)]
    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,popcnt")]
    pub(crate) fn outlined_avx512<T: HasLanes, L: Lanes<T>, K: Kernel<T>>(kernel: K) -> K::Output {
        kernel.run::<L>()
    }
}
