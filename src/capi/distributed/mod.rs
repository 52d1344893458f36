//! What several processes need that simulate one world together: keys that order bodies alike everywhere, ghosts, bodies and
//! memories packed to be sent, and forces summed pair by pair. raycontact/mpi.hpp is made of it. raycontact.h leaves it out.

mod bodies;
mod packed_mesh;
mod pair_forces;
mod system_ghosts;
mod system_memories;
mod system_parts;

pub use bodies::*;
pub use packed_mesh::*;
pub use pair_forces::*;
pub use system_ghosts::*;
pub use system_memories::*;
pub use system_parts::*;

use crate::system::Surface;

/// The number of a body, and 0; or of a half-space, and 1.
fn numbers_of(surface: Surface) -> (u32, u32) {
    match surface {
        Surface::Body(number) => (number, 0),
        Surface::HalfSpace(number) => (number, 1),
    }
}
