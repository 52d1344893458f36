//! What the library promises to callers in Rust, in one program: each of its own would be linked anew. The folders
//! are those of `src/`.

#[path = "../common/mod.rs"]
mod common;
#[path = "../../evaluation/programs/support/mod.rs"]
mod support;

#[path = "../../examples/two_octahedra.rs"]
mod two_octahedra;

mod contact;
mod distributed;
mod escape;
mod force;
mod mesh;
mod query;
mod scene;
mod system;
mod triangle;
mod whole;
