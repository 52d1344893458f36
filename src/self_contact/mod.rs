//! Where one surface comes near itself: which triangles touch, which parts need rays, and what is kept from step to step.

mod certificate;
mod culling;
mod fans;
mod near_triangles;
mod nearness;
mod own_side;
mod tangled;
mod touching;
mod union_find;
mod warm_start;
mod workspace;

pub(crate) use nearness::rounding;
pub(crate) use tangled::{is_collapsed, is_tangled_for_rays};
pub(crate) use warm_start::SelfWarmStart;
pub(crate) use workspace::SelfWorkspace;
