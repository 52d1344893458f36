//! The contacts of two bodies whose boxes overlap, and of a body with itself: Algorithm 1 of the paper, and what goes beyond
//! it. A pipeline: points of a surface are sampled, their rays traced, the hits classified, and contacts weighed.

mod cast;
mod chunks;
mod classify;
mod collect;
mod detect;
mod edge_contacts;
mod escape_push;
mod fixed_shares;
mod list;
mod options;
mod outline;
mod pair;
mod point_pair;
mod potential;
mod quadrature;
mod spread;
mod spread_loads;
mod statistics;
#[cfg(test)]
pub(crate) mod test_contact;
mod trace;
mod weigh;
mod with_itself;
mod workspace;

pub(crate) use detect::Outcome;
pub use escape_push::EscapePush;
pub use list::ContactList;
pub use options::{ContactLaw, DetectionOptions};
pub(crate) use pair::{Pair, overlap_region, reach_region};
pub use point_pair::{Contact, ContactKind, SpreadNumber, SurfacePoint};
pub(crate) use potential::Columns;
pub use quadrature::Sampling;
pub(crate) use quadrature::edges::for_each_inside_stretch;
pub(crate) use quadrature::refinement::sample_fraction;
pub(crate) use quadrature::{Purpose, Sample};
pub(crate) use spread::WeightedVertices;
pub use statistics::Statistics;
pub(crate) use statistics::with_counters;
pub(crate) use weigh::make_contact;
pub(crate) use with_itself::detect_self;
pub use with_itself::{query_self, query_self_with_all_rays};
pub(crate) use workspace::Workspace;
