//! The paper's octree: a triangle lives at the deepest level whose cell is at least as large as the triangle's box, in
//! the at most eight cells its box touches there.

mod build;
mod nearest;
mod slabs;
mod trace;
mod tree;
mod validate;

pub(crate) use tree::PaperOctree;
