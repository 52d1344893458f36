//! Contacts of two bodies and of a body with itself.

mod algorithm;
mod coarse_sampling;
mod contact_lists;
mod counts;
mod open_meshes;
mod own_exits;
mod pressure;
mod self_and_others;
mod self_collision;
mod tangled_pairs;
mod tolerance;
