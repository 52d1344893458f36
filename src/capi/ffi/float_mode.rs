//! The floating-point mode in which the library computes, whatever mode its caller is in.

#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
use std::arch::asm;

/// While this lives, the thread rounds to nearest, keeps subnormal numbers and masks all exceptions. When it is dropped, also by
/// a panic, mode and exception flags are again what they were.
pub(in crate::capi) struct DefaultMode {
    before: Mode,
}

impl DefaultMode {
    pub(in crate::capi) fn enter() -> Self {
        let before = Mode::now();
        // Writing takes longer than reading, and hardly any caller has another mode.
        if !before.is_default() {
            Mode::DEFAULT.set();
        }
        Self { before }
    }
}

impl Drop for DefaultMode {
    fn drop(&mut self) {
        if Mode::now() != self.before {
            self.before.set();
        }
    }
}

/// MXCSR: mode and flags in one register.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::capi) struct Mode(u32);

#[cfg(target_arch = "x86_64")]
impl Mode {
    /// All exceptions masked; no flag is set.
    const DEFAULT: Self = Self(0x1f80);
    const FLAGS: u32 = 0x3f;
    /// Rounds to zero without subnormal numbers, traps what is invalid, infinite or overflows; one flag is set.
    #[cfg(test)]
    pub(in crate::capi) const OTHER: Self = Self(0xf960);

    pub(in crate::capi) fn is_default(self) -> bool {
        self.0 & !Self::FLAGS == Self::DEFAULT.0
    }

    pub(in crate::capi) fn now() -> Self {
        let mut register = 0;
        // SAFETY: the instruction writes these four bytes alone.
        unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut register, options(nostack, preserves_flags)) };
        Self(register)
    }

    pub(in crate::capi) fn set(self) {
        // SAFETY: the instruction reads these four bytes alone; a constant or a value of the register has no reserved bit set.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const self.0, options(nostack)) };
    }
}

/// FPCR, the mode, and FPSR, the flags.
#[cfg(target_arch = "aarch64")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::capi) struct Mode(u64, u64);

#[cfg(target_arch = "aarch64")]
impl Mode {
    const DEFAULT: Self = Self(0, 0);
    /// Rounds to zero without subnormal numbers; one flag is set.
    #[cfg(test)]
    pub(in crate::capi) const OTHER: Self = Self(0x1c0_0000, 0x10);

    pub(in crate::capi) fn is_default(self) -> bool {
        self.0 == Self::DEFAULT.0
    }

    pub(in crate::capi) fn now() -> Self {
        let (mode, flags);
        // SAFETY: it reads two registers.
        unsafe {
            asm!("mrs {}, fpcr", "mrs {}, fpsr", out(reg) mode, out(reg) flags, options(nostack, preserves_flags));
        }
        Self(mode, flags)
    }

    pub(in crate::capi) fn set(self) {
        let Self(mode, flags) = self;
        // SAFETY: the values are constants or were read from the registers.
        unsafe { asm!("msr fpcr, {}", "msr fpsr, {}", in(reg) mode, in(reg) flags, options(nostack)) };
    }
}

/// Of other processors nothing is known here: the caller's mode stays.
#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::capi) struct Mode;

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
impl Mode {
    const DEFAULT: Self = Self;
    #[cfg(test)]
    pub(in crate::capi) const OTHER: Self = Self;

    pub(in crate::capi) fn is_default(self) -> bool {
        true
    }

    pub(in crate::capi) fn now() -> Self {
        Self
    }

    pub(in crate::capi) fn set(self) {}
}
