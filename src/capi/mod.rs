//! The C interface: handles, status codes, the panic guard. `include/raycontact.h` is generated from here and is the
//! manual; this is the only place, besides SIMD kernels, with `unsafe` code.

#![allow(unsafe_code, non_camel_case_types, clippy::missing_safety_doc)] // C names; safety stands in each function's text

mod body_arrays;
mod checks;
mod closest;
mod contact_system;
mod contact_system_ghosts;
mod contact_system_options;
mod contact_system_pairs;
mod contact_system_parts;
mod contact_system_step;
mod contacts;
mod escape_push;
mod failure;
#[cfg(test)]
mod faults;
mod float_mode;
mod guard;
mod handles;
mod host_positions;
mod host_threads;
mod mesh;
mod octree;
mod octree_options;
mod options;
mod own_exits;
mod packed_mesh;
mod pair_forces;
mod pair_memory;
mod pointers;
mod precision;
mod response;
mod scene;
mod sharing;
mod sized_structs;
mod statistics;
mod vectors;
mod version;

pub use closest::*;
pub use contact_system::*;
pub use contact_system_ghosts::*;
pub use contact_system_options::*;
pub use contact_system_pairs::*;
pub use contact_system_parts::*;
pub use contact_system_step::*;
pub use contacts::*;
pub use escape_push::*;
pub use failure::rayc_status;
pub use guard::{RAYC_STACK_SIZE, rayc_last_error_message};
pub use host_threads::{rayc_parallel_for, rayc_task};
pub use mesh::*;
pub use octree::*;
pub use octree_options::*;
pub use options::*;
pub use own_exits::*;
pub use packed_mesh::*;
pub use pair_forces::*;
pub use pair_memory::*;
pub use response::*;
pub use scene::*;
pub use sharing::*;
pub use statistics::*;
pub use vectors::{rayc_scalar, rayc_vectors, rayc_vectors_mut};
pub use version::*;
