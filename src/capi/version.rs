use super::failure::rayc_status;
use super::guard::guard_value;
use libc::c_char;
use std::ffi::CStr;

/// Major version of this header. The ABI stays compatible within one major version (within one minor version of 0): a
/// program runs with any library of that version that is no older than the program's header.
pub const RAYC_VERSION_MAJOR: u32 = 0;
/// Minor version of this header.
pub const RAYC_VERSION_MINOR: u32 = 2;
/// Patch version of this header.
pub const RAYC_VERSION_PATCH: u32 = 0;

/// The ABI of this header: major · 100, and the minor version while the major is 0. The C++ headers compare it with
/// rayc_abi_version() before they make anything.
pub const RAYC_ABI_VERSION: u32 = 2;

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

// A test holds this list against the header's enum.
macro_rules! status_names {
    ($($name:ident)*) => {
        fn status_name(status: u32) -> &'static CStr {
            $(if status == rayc_status::$name as u32 {
                const NAME: &CStr = match CStr::from_bytes_with_nul(concat!(stringify!($name), "\0").as_bytes()) {
                    Ok(name) => name,
                    Err(_) => panic!("the name ends in its only zero byte"),
                };
                return NAME;
            })*
            c"unknown status"
        }
    };
}

status_names! {
    RAYC_STATUS_OK
    RAYC_STATUS_NULL_POINTER
    RAYC_STATUS_INVALID_STRUCT_SIZE
    RAYC_STATUS_UNKNOWN_ENUM
    RAYC_STATUS_INVALID_OPTION
    RAYC_STATUS_WRONG_COUNT
    RAYC_STATUS_INVALID_STRIDE
    RAYC_STATUS_UNKNOWN_BODY
    RAYC_STATUS_NOT_FINITE
    RAYC_STATUS_OTHER_ABI
    RAYC_STATUS_INVALID_HANDLE
    RAYC_STATUS_BUSY
    RAYC_STATUS_KEY_TAKEN
    RAYC_STATUS_MESH_EMPTY
    RAYC_STATUS_MESH_INDEX_OUT_OF_RANGE
    RAYC_STATUS_MESH_DEGENERATE_TRIANGLE
    RAYC_STATUS_MESH_OPEN
    RAYC_STATUS_MESH_INCONSISTENT_ORIENTATION
    RAYC_STATUS_MESH_NON_MANIFOLD
    RAYC_STATUS_MESH_INWARD
    RAYC_STATUS_MESH_TOO_LARGE
    RAYC_STATUS_MESH_FLAT
    RAYC_STATUS_MESH_BEYOND_RANGE
    RAYC_STATUS_OCTREE_STALE
    RAYC_STATUS_OCTREE_OF_OTHER_MESH
    RAYC_STATUS_PRECISION_MISMATCH
    RAYC_STATUS_FILE_NOT_READABLE
    RAYC_STATUS_FILE_BROKEN
    RAYC_STATUS_SAVED_STATE_BROKEN
    RAYC_STATUS_SAVED_STATE_OTHER_VERSION
    RAYC_STATUS_THREADS_NOT_STARTED
    RAYC_STATUS_OUT_OF_MEMORY
    RAYC_STATUS_OUT_OF_ORDER
    RAYC_STATUS_BODY_TWICE
    RAYC_STATUS_INVALID_WEIGHTS
    RAYC_STATUS_INVALID_MASS
    RAYC_STATUS_INVALID_INERTIA
    RAYC_STATUS_INVALID_MATERIAL
    RAYC_STATUS_INVALID_DIRECTION
    RAYC_STATUS_INVALID_STEP
    RAYC_STATUS_RIGID_ELIMINATED
    RAYC_STATUS_TOO_STIFF
    RAYC_STATUS_RANKS_DISAGREE
    RAYC_STATUS_BODY_ON_TWO_RANKS
    RAYC_STATUS_UNKNOWN_RANK
    RAYC_STATUS_OTHER_MESH
    RAYC_STATUS_INVALID_COMMUNICATOR
    RAYC_STATUS_MPI_FAILED
    RAYC_STATUS_PANIC
}

/// The name of a status, e.g. "RAYC_STATUS_OK"; "unknown status" for other numbers. Never NULL, never freed.
#[unsafe(no_mangle)]
pub extern "C" fn rayc_status_name(status: u32) -> *const c_char {
    guard_value(c"".as_ptr(), || status_name(status).as_ptr())
}
