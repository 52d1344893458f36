//! Contacts between surfaces: Algorithm 1 of the paper.

mod list;
mod load;
mod pair;
mod samples;
mod workspace;

pub use list::{Contact, ContactList, Statistics, SurfacePoint};
pub use pair::{DetectionOptions, detect_pair, query_pair};
pub use samples::Sampling;
