//! Contacts between surfaces: Algorithm 1 of the paper.

mod list;
mod pair;
mod samples;
mod workspace;

pub use list::{Contact, ContactList, Statistics, SurfacePoint};
pub use pair::{detect_pair, query_pair};
