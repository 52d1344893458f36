//! The fast octree: tiles of neighbouring triangles as leaves, and above them nodes with up to sixteen tight boxes
//! side by side, so that one step tests all of them. Which triangles share a tile, and which tiles a node, is settled once
//! for a mesh; new positions only renew boxes, from the tiles upward.

mod cluster;
mod group;
mod leaving;
mod near;
mod node;
mod packet;
mod refit;
mod region;
mod runs;
mod tile;
mod trace;
mod validate;

use crate::math::{Aabb, LANE_COUNT, Lanes, Mask, Scalar};
use crate::memory;
use crate::mesh::Mesh;
use crate::ray::{PreparedRay, Ray, RayPacket};
use node::{CHILD_COUNT, Node};
use runs::Runs;
use tile::{Outline, Tile};

pub(super) use near::NearTiles;
pub(crate) use packet::{Candidates, PacketHits};

/// Tiles and the nodes above them, in flat arrays.
#[derive(Clone, Debug)]
pub(super) struct Wide<T: Scalar> {
    /// In the order in which the nodes lead to them.
    tiles: Vec<Tile<T>>,
    /// Of each tile.
    outlines: Vec<Outline<T>>,
    /// Children come after their parent; the first is the root.
    nodes: Vec<Node<T>>,
    runs: Runs<T>,
    /// Whether all boxes are the tightest.
    is_tight: bool,
}

impl<T: Scalar> Wide<T> {
    pub(super) fn new(mesh: &Mesh<T>) -> Self {
        let topology = mesh.topology();
        let (nodes, groups) = group::group(mesh, cluster::cluster(mesh));
        let (mut tiles, mut outlines) = (memory::with_room(groups.len()), memory::with_room(groups.len()));
        let mut is_owned = memory::filled(false, topology.vertex_count());
        for group in &groups {
            let (mut tile, outline) = Tile::new(topology.triangles(), group);
            tile.own_vertices(&outline.vertices, &mut is_owned);
            tiles.push(tile);
            outlines.push(outline);
        }
        let runs = Runs::new(mesh, &nodes, &outlines);
        let mut wide = Self { tiles, outlines, nodes, runs, is_tight: false };
        wide.refit(mesh, None);
        wide.load(mesh, None);
        wide
    }

    /// Follows the mesh to its present positions; no tile is loaded then.
    /// Where rays mostly stay in some regions, boxes far from those may be wider than they need be.
    pub(super) fn refit(&mut self, mesh: &Mesh<T>, regions: Option<&[Aabb<T>]>) {
        crate::math::dispatch::<T, _>(refit::Refit { cells: self, mesh, regions });
    }

    pub(super) fn is_tight(&self) -> bool {
        self.is_tight
    }

    /// Loads these tiles, or all, so that rays need not do it each for itself.
    pub(super) fn load(&mut self, mesh: &Mesh<T>, tiles: Option<&[u32]>) {
        crate::math::dispatch::<T, _>(refit::Load { cells: self, mesh, tiles });
    }

    /// Offers every triangle that the ray may meet up to the `t` that `visitor` last returned.
    pub(super) fn visit(
        &self,
        ray: &Ray<T>,
        prepared: &PreparedRay<T>,
        mesh: &Mesh<T>,
        visitor: &mut impl FnMut(u32) -> T,
    ) {
        crate::math::dispatch::<T, _>(trace::Walk::new(self, ray, prepared, mesh, visitor));
    }

    /// The nearest hit of each ray.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn nearest<L: Lanes<T>>(
        &self,
        mesh: &Mesh<T>,
        packet: &RayPacket<T>,
        list: &mut Candidates<T>,
        hits: &mut PacketHits<T>,
    ) {
        packet::nearest::<T, L>(self, mesh, packet, list, hits);
    }

    /// Which of the rays in `asked` leave the mesh strictly before `end`, through other triangles than those that have all
    /// their ray's `touched` vertices.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn hidden<L: Lanes<T>>(
        &self,
        mesh: &Mesh<T>,
        packet: &RayPacket<T>,
        asked: Mask,
        end: &[T; LANE_COUNT],
        touched: &[[u32; 3]; LANE_COUNT],
        list: &mut Candidates<T>,
    ) -> Mask {
        packet::hidden::<T, L>(self, mesh, packet, asked, end, touched, list)
    }
}
