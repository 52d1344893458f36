//! What the library promises to callers in Rust, in one program: each of its own would be linked anew. The folders
//! are those of `src/`.

#[path = "../common/mod.rs"]
mod common;
#[path = "../../examples/support/mod.rs"]
mod support;

mod detection;
mod mesh;
mod octree;
mod ray;
mod recovery;
mod response;
mod scene;
mod system;
mod whole;
