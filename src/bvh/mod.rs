//! The fast octree: tiles of neighbouring triangles as leaves, and above them nodes with up to sixteen tight boxes
//! side by side, so that one step tests all of them. Which triangles share a tile, and which tiles a node, is settled once
//! for a mesh; new positions only renew boxes, from the tiles upward.

mod hierarchy;
mod nearest;
mod node;
mod outside;
mod posed;
mod rays;
mod refit;
mod region;
mod sought;
mod tile;
mod tile_cylinder;
mod validate;
mod vertex_runs;

pub(crate) use node::{CHILD_COUNT, Node};
pub(crate) use outside::{MayMeet, SidesScratch, TilesNotOutside};
pub(crate) use rays::packet::PacketHits;
pub(crate) use rays::packet::candidates::Candidates;
pub(crate) use rays::slabs::Slabs;
pub(crate) use sought::{All, Beyond, Nearest, Sought};
pub(crate) use tile::{Outline, TILE_SIZE};

use crate::bvh::posed::Posed;
use crate::bvh::rays::single::{FEW_NODES, FEW_WAITING, NearestOfRay};
use crate::bvh::rays::trace::STACK_SIZE;
use crate::bvh::tile::Tile;
use crate::bvh::tile_cylinder::{TileCylinder, TileCylinders};
use crate::bvh::vertex_runs::VertexRuns;
use crate::math::{Aabb, Scalar};
use crate::memory;
use crate::mesh::Mesh;
use crate::simd::Lanes;
use crate::triangle::{Hit, PointPacket, PreparedRay, QueryPoint, Ray};

/// Tiles and the nodes above them, in flat arrays.
#[derive(Clone, Debug)]
pub(crate) struct Bvh<T: Scalar> {
    /// In the order in which the nodes lead to them.
    pub(crate) tiles: Vec<Tile<T>>,
    /// Of each tile.
    pub(crate) outlines: Vec<Outline<T>>,
    /// Of each tile the places of its triangles' corners in ascending order of the vertices' numbers, for distances.
    pub(crate) ascending: Vec<[[u8; TILE_SIZE]; 3]>,
    /// Children come after their parent; the first is the root.
    pub(crate) nodes: Vec<Node<T>>,
    pub(crate) cylinders: TileCylinders<T>,
    pub(crate) runs: VertexRuns<T>,
    /// Where the mesh has been moved by a pose.
    pub(crate) posed: Option<Box<[Posed<T>; 1]>>,
    /// Whether all boxes are the tightest.
    pub(crate) is_tight: bool,
    /// Counts the changes of positions: tiles loaded before are out of date.
    pub(crate) loading: u64,
}

impl<T: Scalar> Bvh<T> {
    pub(crate) fn new(mesh: &Mesh<T>) -> Self {
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
    pub(crate) fn refit(&mut self, mesh: &Mesh<T>, regions: Option<&[Aabb<T>]>) {
        self.loading += 1;
        self.cylinders.forget();
        self.leave_pose();
        crate::simd::dispatch::<T, _>(refit::Refit { cells: self, mesh, regions });
    }

    pub(crate) fn is_tight(&self) -> bool {
        self.is_tight
    }

    /// Loads these tiles, or all, so that rays need not do it each for itself; for distances, their cylinders too.
    pub(crate) fn load(&mut self, mesh: &Mesh<T>, tiles: Option<&[u32]>, for_distances: bool) {
        crate::simd::dispatch::<T, _>(refit::Load { cells: self, mesh, tiles, for_distances });
    }

    /// Offers every triangle that the ray may meet up to the `t` that `visitor` last returned.
    pub(crate) fn visit(
        &self,
        ray: &Ray<T>,
        prepared: &PreparedRay<T>,
        mesh: &Mesh<T>,
        visitor: &mut impl FnMut(u32) -> T,
    ) {
        crate::simd::dispatch::<T, _>(rays::trace::Walk::new(self, ray, prepared, mesh, visitor));
    }

    /// What `then` makes of where a ray first meets the mesh.
    pub(crate) fn nearest_of_ray<O>(
        &self,
        mesh: &Mesh<T>,
        ray: impl Into<Ray<T>>,
        then: impl FnOnce(Option<Hit<T>>) -> O,
    ) -> O {
        if self.nodes.len() <= FEW_NODES {
            crate::simd::dispatch::<T, _>(NearestOfRay::<T, _, _, FEW_WAITING> { cells: self, mesh, ray, then })
        } else {
            crate::simd::dispatch::<T, _>(NearestOfRay::<T, _, _, STACK_SIZE> { cells: self, mesh, ray, then })
        }
    }

    /// Where a ray first meets the mesh, on some lanes.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn nearest_of_ray_on<L: Lanes<T>>(&self, mesh: &Mesh<T>, ray: Ray<T>) -> Option<Hit<T>> {
        let then = |hit| hit;
        if self.nodes.len() <= FEW_NODES {
            L::outlined(NearestOfRay::<T, _, _, FEW_WAITING> { cells: self, mesh, ray, then })
        } else {
            L::outlined(NearestOfRay::<T, _, _, STACK_SIZE> { cells: self, mesh, ray, then })
        }
    }

    /// Finds the triangle nearest to the point.
    pub(crate) fn find_closest(
        &self,
        mesh: &Mesh<T>,
        query: &QueryPoint<T>,
        sought: impl Sought,
        nearest: &mut Nearest<T>,
    ) {
        crate::simd::dispatch::<T, _>(nearest::Closest { cells: self, mesh, query, nearest, sought });
    }

    /// The same on some lanes.
    #[cfg(all(test, target_arch = "x86_64"))]
    pub(crate) fn find_closest_with<L: Lanes<T>>(
        &self,
        mesh: &Mesh<T>,
        query: &QueryPoint<T>,
        nearest: &mut Nearest<T>,
    ) {
        L::outlined(nearest::Closest { cells: self, mesh, query, nearest, sought: All });
    }

    /// Finds the nearest triangles of a packet's points.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn find_closest_of_packet<L: Lanes<T>>(
        &self,
        mesh: &Mesh<T>,
        sought: impl Sought,
        packet: &mut PointPacket<T>,
    ) {
        L::outlined(nearest::ClosestOfPacket { cells: self, mesh, packet, sought });
    }
}
