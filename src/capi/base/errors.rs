use super::status::rayc_status;
use crate::capi::ffi::{guard_value, last_error_message};
use libc::c_char;
use std::ffi::CStr;

/// What was wrong with this thread's last call, where, and what to do; "" after a success. UTF-8.
///
/// The text belongs to the library and stays until this thread's next call. Never NULL.
#[unsafe(no_mangle)]
pub extern "C" fn rayc_last_error_message() -> *const c_char {
    guard_value(c"".as_ptr(), last_error_message)
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
    RAYC_STATUS_MATRIX_TOO_LARGE
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
