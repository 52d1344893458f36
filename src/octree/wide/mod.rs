//! The fast octree: tiles of neighbouring triangles as leaves, and above them nodes with up to sixteen tight boxes
//! side by side, so that one step tests all of them. Which triangles share a tile, and which tiles a node, is settled once
//! for a mesh; new positions only renew boxes, from the tiles upward.

mod closest;
mod exit_culling;
mod hierarchy;
mod near_tiles;
mod node;
mod outside;
mod packet;
mod posed;
mod refit;
mod region;
mod single;
mod tile;
mod tile_cylinder;
mod trace;
mod validate;
mod vertex_runs;

use crate::closest::{PointPacket, QueryPoint};
use crate::math::{Aabb, Lanes, Scalar};
use crate::memory;
use crate::mesh::Mesh;
#[cfg(all(test, target_arch = "x86_64"))]
use crate::octree::closest::All;
use crate::octree::closest::{Nearest, Sought};
use crate::ray::{Hit, PreparedRay, Ray};
use node::{CHILD_COUNT, Node};
use posed::Posed;
use single::{FEW_NODES, FEW_WAITING, NearestOfRay};
use tile::{Outline, TILE_SIZE, Tile};
use tile_cylinder::{TileCylinder, TileCylinders};
use trace::STACK_SIZE;
use vertex_runs::VertexRuns;

pub(super) use near_tiles::NearTiles;
pub(crate) use outside::SidesScratch;
pub(super) use outside::{MayMeet, TilesNotOutside};
pub(crate) use packet::{Candidates, PacketHits};

/// Tiles and the nodes above them, in flat arrays.
#[derive(Clone, Debug)]
pub(super) struct Wide<T: Scalar> {
    /// In the order in which the nodes lead to them.
    tiles: Vec<Tile<T>>,
    /// Of each tile.
    outlines: Vec<Outline<T>>,
    /// Of each tile the places of its triangles' corners in ascending order of the vertices' numbers, for distances.
    ascending: Vec<[[u8; TILE_SIZE]; 3]>,
    /// Children come after their parent; the first is the root.
    nodes: Vec<Node<T>>,
    cylinders: TileCylinders<T>,
    runs: VertexRuns<T>,
    /// Where the mesh has been moved by a pose.
    posed: Option<Box<[Posed<T>; 1]>>,
    /// Whether all boxes are the tightest.
    is_tight: bool,
    /// Counts the changes of positions: tiles loaded before are out of date.
    loading: u64,
}

impl<T: Scalar> Wide<T> {
    pub(super) fn new(mesh: &Mesh<T>) -> Self {
        let topology = mesh.topology();
        let clusters = mesh.clusters();
        let nodes = hierarchy::nodes_above(clusters.len());
        let (mut tiles, mut outlines) = (memory::with_room(clusters.len()), memory::with_room(clusters.len()));
        let mut is_owned = memory::filled(false, topology.vertex_count());
        for cluster in clusters.iter() {
            let (mut tile, outline) = Tile::new(topology.triangles(), cluster);
            tile.own_vertices(&outline.vertices, &mut is_owned);
            tiles.push(tile);
            outlines.push(outline);
        }
        let ascending = memory::listed(tiles.iter().zip(&outlines).map(|(tile, outline)| tile.ascending(outline)));
        let runs = VertexRuns::new(mesh, &nodes, &outlines);
        let cylinders = TileCylinders::new(tiles.len());
        let (posed, is_tight, loading) = (None, false, 0);
        let mut wide = Self { tiles, outlines, ascending, nodes, cylinders, runs, posed, is_tight, loading };
        wide.refit(mesh, None);
        wide.load(mesh, None, true);
        wide
    }

    /// Follows the mesh to its present positions; no tile is loaded then.
    /// Where rays mostly stay in some regions, boxes far from those may be wider than they need be.
    pub(super) fn refit(&mut self, mesh: &Mesh<T>, regions: Option<&[Aabb<T>]>) {
        self.loading += 1;
        self.cylinders.forget();
        self.leave_pose();
        crate::math::dispatch::<T, _>(refit::Refit { cells: self, mesh, regions });
    }

    pub(super) fn is_tight(&self) -> bool {
        self.is_tight
    }

    /// Loads these tiles, or all, so that rays need not do it each for itself; for distances, their cylinders too.
    pub(super) fn load(&mut self, mesh: &Mesh<T>, tiles: Option<&[u32]>, for_distances: bool) {
        crate::math::dispatch::<T, _>(refit::Load { cells: self, mesh, tiles, for_distances });
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

    /// What `then` makes of where a ray first meets the mesh.
    pub(super) fn nearest_of_ray<O>(
        &self,
        mesh: &Mesh<T>,
        ray: impl Into<Ray<T>>,
        then: impl FnOnce(Option<Hit<T>>) -> O,
    ) -> O {
        if self.nodes.len() <= FEW_NODES {
            crate::math::dispatch::<T, _>(NearestOfRay::<T, _, _, FEW_WAITING> { cells: self, mesh, ray, then })
        } else {
            crate::math::dispatch::<T, _>(NearestOfRay::<T, _, _, STACK_SIZE> { cells: self, mesh, ray, then })
        }
    }

    /// Where a ray first meets the mesh, on some lanes.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn nearest_of_ray_on<L: Lanes<T>>(&self, mesh: &Mesh<T>, ray: Ray<T>) -> Option<Hit<T>> {
        let then = |hit| hit;
        if self.nodes.len() <= FEW_NODES {
            L::outlined(NearestOfRay::<T, _, _, FEW_WAITING> { cells: self, mesh, ray, then })
        } else {
            L::outlined(NearestOfRay::<T, _, _, STACK_SIZE> { cells: self, mesh, ray, then })
        }
    }

    /// Finds the triangle nearest to the point.
    pub(super) fn find_closest(
        &self,
        mesh: &Mesh<T>,
        query: &QueryPoint<T>,
        sought: impl Sought,
        nearest: &mut Nearest<T>,
    ) {
        crate::math::dispatch::<T, _>(closest::Closest { cells: self, mesh, query, nearest, sought });
    }

    /// The same on some lanes.
    #[cfg(all(test, target_arch = "x86_64"))]
    pub(super) fn find_closest_with<L: Lanes<T>>(
        &self,
        mesh: &Mesh<T>,
        query: &QueryPoint<T>,
        nearest: &mut Nearest<T>,
    ) {
        L::outlined(closest::Closest { cells: self, mesh, query, nearest, sought: All });
    }

    /// Finds the nearest triangles of a packet's points.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn find_closest_of_packet<L: Lanes<T>>(
        &self,
        mesh: &Mesh<T>,
        sought: impl Sought,
        packet: &mut PointPacket<T>,
    ) {
        L::outlined(closest::ClosestOfPacket { cells: self, mesh, packet, sought });
    }
}
