//! What a scene is told of bodies that others know too: all that this room holds for `distributed`.

mod foreign;
mod sharing;

pub use sharing::{Sharing, finds_pair};
