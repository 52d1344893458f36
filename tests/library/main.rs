//! What the library promises to callers in Rust, in one program: each of its own would compile the kernels anew.

#[path = "../common/mod.rs"]
mod common;

mod algorithm;
mod bad_geometry;
mod beyond_the_paper;
mod coarse_sampling;
mod completeness;
mod contact_lists;
mod counts;
mod crowds;
mod escape_push;
mod faults;
mod figures;
mod metamorphic;
mod number_range;
mod octree;
mod open_meshes;
mod pair_memory;
mod rays;
mod response;
mod self_and_others;
mod self_collision;
mod tolerance;

mod winding;
