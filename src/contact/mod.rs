//! Contacts between surfaces: Algorithm 1 of the paper, and what goes beyond it.

mod border;
mod cast;
mod chunks;
mod contact_point;
mod cutter;
mod detect;
mod distance;
mod edge_contacts;
mod edges;
mod escape;
mod escape_push;
mod face_source;
mod found;
mod list;
mod load;
mod memory;
mod options;
mod pair;
mod part;
mod past_folds;
mod query;
mod rays;
mod recovery;
mod sampler;
mod samples;
mod self_contact;
mod starts_outside;
mod statistics;
#[cfg(test)]
mod test_contact;
mod tolerance;
mod workspace;

pub use contact_point::{Contact, ContactKind, SurfacePoint};
pub use distance::ContactLaw;
pub use escape_push::EscapePush;
pub use list::ContactList;
pub use memory::{PairMemory, Record};
pub use options::DetectionOptions;
pub(crate) use pair::reach_region;
pub(crate) use query::detect_pair_among;
pub use query::{detect_pair, query_pair};
pub use samples::Sampling;
pub(crate) use self_contact::{SelfMemory, detect_self};
pub use self_contact::{query_self, query_self_with_all_rays};
pub use statistics::Statistics;
