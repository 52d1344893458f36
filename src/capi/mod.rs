//! The C interface: handles, status codes, the panic guard. `include/raycontact/` is generated from here, a header from each
//! module but `ffi`, and is the manual; this is the only place, besides SIMD kernels, with `unsafe` code.

#![allow(unsafe_code, non_camel_case_types, clippy::missing_safety_doc)]
// C names; safety stands in each function's text
// All that an unsafe function does, but for those of `ffi`, rests on that text: its pointers are the caller's, as documented.
#![allow(unsafe_op_in_unsafe_fn)]

mod base;
mod contact_system;
mod contacts;
mod distributed;
#[cfg(test)]
mod faults;
mod ffi;
mod mesh;
mod queries;
mod scene;
mod state;

pub use base::*;
pub use contact_system::*;
pub use contacts::*;
pub use distributed::*;
pub use mesh::*;
pub use queries::*;
pub use scene::*;
pub use state::*;
