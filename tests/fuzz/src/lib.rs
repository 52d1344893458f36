//! What each target does with its bytes, and what has to hold.

mod bytes;
#[path = "../../common/cuboid.rs"]
mod cuboid;
pub mod differential;
pub mod host;
pub mod obj_file;
pub mod options;
pub mod surface;

pub use bytes::Bytes;
