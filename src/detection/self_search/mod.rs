//! Where a body's surface may touch itself: which of its triangles come near each other, whether they are too many to tell
//! inside from outside, which samples need a ray, and which fold a point belongs to.

mod culling;
mod nearness;
mod own_side;
mod tangled;
mod touching;
mod union_find;
mod warm_start;
mod workspace;

pub(in crate::detection) use nearness::rounding;
pub(in crate::detection) use tangled::{is_collapsed, is_tangled_for_rays};
pub(crate) use warm_start::SelfWarmStart;
pub(in crate::detection) use workspace::SelfWorkspace;
