//! Contacts between surfaces: Algorithm 1 of the paper, and what goes beyond it.

mod cast;
mod chunks;
mod cutter;
mod direction;
mod distance;
mod edges;
mod escape;
mod found;
mod list;
mod load;
mod memory;
mod pair;
mod past_folds;
mod push;
mod samples;
mod self_contact;
mod starts_outside;
#[cfg(test)]
mod test_contact;
mod tolerance;
mod workspace;

pub use distance::ContactLaw;
pub use list::{Contact, ContactKind, ContactList, Statistics, SurfacePoint};
pub use memory::{PairMemory, Record};
pub use pair::{DetectionOptions, detect_pair, query_pair};
pub(crate) use pair::{detect_pair_among, reach_region};
pub use push::EscapePush;
pub use samples::Sampling;
pub(crate) use self_contact::{SelfMemory, detect_self};
pub use self_contact::{query_self, query_self_with_all_rays};
