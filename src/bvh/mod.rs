//! The default tree, a bounding volume hierarchy. Its leaves hold tiles of neighbouring triangles. Its nodes have up to sixteen
//! boxes side by side, so that one step tests all of them. Which triangles share a tile, and which tiles a node, is settled
//! once for a mesh; new positions only renew boxes, from the tiles upward.

mod hierarchy;
mod nearest;
mod node;
mod outside;
mod placing;
mod posed;
mod rays;
mod refit;
mod region;
mod sought;
mod tile;
mod tile_cylinder;
mod tree;
mod validate;
mod vertex_runs;
mod walk;

pub(crate) use node::{CHILD_COUNT, Node};
pub(crate) use outside::{MayMeet, SidesScratch, TilesNotOutside};
pub(crate) use rays::packet::candidates::Candidates;
pub(crate) use rays::packet::hits::PacketHits;
pub(crate) use sought::{All, Beyond, Nearest, Sought};
pub(crate) use tile::{Outline, TILE_SIZE};
pub(crate) use tree::Bvh;
