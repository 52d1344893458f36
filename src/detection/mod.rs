//! The contacts of two bodies whose boxes overlap, and of a body with itself: Algorithm 1 of the paper, and what goes beyond
//! it. A pipeline: points of a surface are sampled, their rays traced, the hits classified, and contacts weighed.

mod cast;
mod chunks;
mod classify;
mod contact;
mod detect;
mod edge_contacts;
mod escape_push;
mod fixed_shares;
mod list;
mod options;
mod own_exits;
mod pair;
mod sample;
mod self_contact;
mod self_search;
mod statistics;
#[cfg(test)]
pub(crate) mod test_contact;
mod tolerance;
mod trace;
mod weigh;
mod workspace;

pub(crate) use classify::winding::way_out_past_folds;
pub use contact::{Contact, ContactKind, SurfacePoint};
pub(crate) use detect::Outcome;
pub use escape_push::EscapePush;
pub use list::ContactList;
pub use options::{ContactLaw, DetectionOptions};
pub use own_exits::{OwnExit, OwnExits, OwnExitsError};
pub(crate) use pair::{Pair, overlap_region, reach_region};
pub use sample::Sampling;
pub(crate) use sample::{Sample, for_each_inside_stretch, part_of_rays};
pub(crate) use self_contact::detect_self;
pub use self_contact::{query_self, query_self_with_all_rays};
pub(crate) use self_search::SelfWarmStart;
pub use statistics::Statistics;
pub(crate) use statistics::with_counters;
pub(crate) use weigh::contact;
pub(crate) use workspace::Workspace;
