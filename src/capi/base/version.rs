use crate::capi::ffi::guard_value;

/// Major version of this header. The ABI stays compatible within one major version (within one minor version of 0): a
/// program runs with any library of that version that is no older than the program's header.
pub const RAYC_VERSION_MAJOR: u32 = 0;

/// Minor version of this header.
pub const RAYC_VERSION_MINOR: u32 = 3;

/// Patch version of this header.
pub const RAYC_VERSION_PATCH: u32 = 0;

/// The ABI of this header: major · 100, and the minor version while the major is 0. The C++ headers compare it with
/// rayc_abi_version() before they make anything.
pub const RAYC_ABI_VERSION: u32 = 3;

/// The version of the library that is linked: major · 10000 + minor · 100 + patch. Any thread may ask at any time.
#[unsafe(no_mangle)]
pub extern "C" fn rayc_version() -> u32 {
    guard_value(0, || RAYC_VERSION_MAJOR * 10_000 + RAYC_VERSION_MINOR * 100 + RAYC_VERSION_PATCH)
}

/// The ABI of the library that is linked. Where it is not the header's RAYC_ABI_VERSION, no other function may be called.
/// Any thread may ask at any time.
#[unsafe(no_mangle)]
pub extern "C" fn rayc_abi_version() -> u32 {
    guard_value(0, || RAYC_ABI_VERSION)
}

/// Bytes of free stack that a thread must have when it calls the library, or when it runs a task of a
/// rayc_parallel_for. 98 KB were measured; the rest is room to spare. Do not count what the system keeps at the end of
/// a stack. Threads of a scene's own pool have stacks that are large enough.
pub const RAYC_STACK_SIZE: usize = 131_072;
