//! Where rays start: points on a body's surface, each with a normal and the area that it stands for.

pub(crate) mod corners;
pub(crate) mod edges;
pub(crate) mod element;
pub(crate) mod measurement;
pub(crate) mod moments;
pub(crate) mod packet;
pub(crate) mod refinement;
pub(crate) mod sample;
pub(crate) mod sampler;

pub(crate) use refinement::Purpose;
pub(crate) use sample::Sample;
pub use sample::Sampling;
