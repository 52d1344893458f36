//! Contacts between surfaces: Algorithm 1 of the paper, and what goes beyond it.

mod cast;
mod chunks;
mod cutter;
mod direction;
mod edges;
mod escape;
mod list;
mod load;
mod memory;
mod pair;
mod push;
mod samples;
mod workspace;

pub use list::{Contact, ContactKind, ContactList, Statistics, SurfacePoint};
pub use memory::{PairMemory, Record};
pub(crate) use pair::overlap_region;
pub use pair::{DetectionOptions, detect_pair, query_pair};
pub use push::EscapePush;
pub use samples::Sampling;
