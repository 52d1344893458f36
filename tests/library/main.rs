//! What the library promises to callers in Rust, in one program: each of its own would compile the kernels anew.

#[path = "../common/mod.rs"]
mod common;
#[path = "../../examples/support/mod.rs"]
mod support;

mod algorithm;
mod bad_geometry;
mod beyond_the_paper;
mod body_numbers;
mod closest_points;
mod coarse_sampling;
mod completeness;
mod contact_lists;
mod contact_system;
mod counts;
mod crowds;
mod escape_push;
mod faults;
mod figures;
mod metamorphic;
mod number_range;
mod numbering;
mod obj_files;
mod octree;
mod open_meshes;
mod orientation;
mod pair_memory;
mod poses;
mod pressure;
mod rays;
mod refused_numbers;
mod response;
mod self_and_others;
mod self_collision;
mod shared_bodies;
mod sharing;
mod steps;
mod tolerance;
mod winding;
