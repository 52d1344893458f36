//! What all calls share: how they end and what they say of errors, arrays of the caller's, and versions.
//!
//! Every call that can fail returns a rayc_status; outputs come last. Some errors are not listed again at each call:
//! RAYC_STATUS_NULL_POINTER, RAYC_STATUS_INVALID_HANDLE, RAYC_STATUS_BUSY and RAYC_STATUS_PANIC. A call that takes a
//! struct_size or options may also return RAYC_STATUS_INVALID_STRUCT_SIZE, one that takes options RAYC_STATUS_UNKNOWN_ENUM and
//! RAYC_STATUS_INVALID_OPTION, and one that takes rayc_vectors RAYC_STATUS_INVALID_STRIDE and RAYC_STATUS_UNKNOWN_ENUM. Lengths
//! are in the caller's unit, metres in this text.
//!
//! The caller's threads may be in any floating-point mode: on x86-64 and AArch64 every call computes in the default mode
//! (rounding to nearest, with subnormal numbers, no exception trapped) and leaves the thread's mode and its exception flags as
//! they were. On other processors the caller's mode must be the default.
//!
//! Handles are freed by the caller, by the rayc_…_destroy() of their type, and must not be used after that: the library returns
//! RAYC_STATUS_INVALID_HANDLE where it can tell, but does not promise to. Arrays stay the caller's; the library copies what
//! it needs and keeps no pointer to them. A call with a const handle only reads it and may run beside others that do.
//!
//! Words of this text:
//!
//! - host: the program that calls the library
//! - body: a mesh in a scene, which has a number
//! - overlap box: where the bounding boxes of two bodies overlap
//! - the paper: Hermann, Faure, Raffin 2008, "Ray-traced collision detection for deformable bodies"
//! - contact: a point of one body's surface inside another body, or inside another part of its own, and the point where a ray
//!   from it along the inward normal leaves that body
//! - escape: a pair that contacts cannot part, such as one body inside the other, is pushed along one direction until it is apart
//! - ghost: a copy of a body that belongs to the scene of another process (raycontact/distributed.h)

mod errors;
mod status;
mod vectors;
mod version;

pub use errors::*;
pub use status::*;
pub use vectors::*;
pub use version::*;
