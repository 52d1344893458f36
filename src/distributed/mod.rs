//! Scenes and contact systems of several processes that simulate one world together.
//!
//! Each scene has some bodies of its own, and **ghosts**: copies of other scenes' bodies that meet its own, which it
//! [shares](Sharing) with those scenes. The contacts of an own body and a ghost are found by one of the two scenes. The host's
//! keys ([`Scene::add_with_key`](crate::scene::Scene::add_with_key)) order bodies alike everywhere. What a pair does is summed by
//! itself, as [forces](ForcesByPair) or as the [`Parts`] of a contact system's rows. So sums in the order of the pairs have the
//! same bits, whichever process found which. Meshes, and what pairs remember, are packed to be sent.
//!
//! The rooms below know of this only what `scene/hooks.rs` and `system/hooks.rs` say: a body may be foreign, and foreign bodies
//! may join a step. There a ghost is called foreign.

mod looks;
mod packed_memory;
mod packed_mesh;
mod pair_forces;
mod part_matrix;
mod parts;

pub use crate::bytes::BytesError;
pub use crate::scene::hooks::{Sharing, finds_pair};
pub use looks::{detect_among, look_again, look_ahead};
pub use packed_memory::{pack_memory, packed_memory_length, put_memory};
pub(crate) use packed_mesh::packed_number_size;
pub use packed_mesh::{PackedMeshError, pack_mesh, packed_mesh_length, unpack_mesh};
pub use pair_forces::{ForcesByPair, PairForces};
pub use part_matrix::PartBlock;
pub use parts::{Part, Parts, PartsOf, largest_coupling};
