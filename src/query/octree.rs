//! The search structure over one mesh's triangles, in two layouts that give the same hits to the bit.
//!
//! Everything is relative to the mesh's own box: there is no world size, no smallest triangle, no absolute tolerance.

use crate::bvh::Bvh;
use crate::math::{Aabb, Pose, Scalar};
use crate::memory;
use crate::mesh::{Mesh, Topology};
use crate::paper_octree::PaperOctree;
use crate::query::patch_levels::{PatchLevels, PatchesOfGroups};
use std::fmt;
use std::sync::Arc;

/// An octree over the triangles of one mesh, for the positions it was last updated to.
#[derive(Clone, Debug)]
pub struct Octree<T: Scalar> {
    pub(crate) topology: Arc<Topology>,
    pub(crate) stamp: u64,
    pub(crate) tree: Tree<T>,
    /// Shared by clones, which have the same groups.
    pub(crate) patches: Arc<PatchLevels<PatchesOfGroups>>,
}

/// With less than one ray for this many tiles, loading all tiles would take longer than tracing without: a ray passes only a few.
const RAYS_TO_LOAD: usize = 4;

/// How an octree keeps its triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layout {
    /// Tiles of neighbouring triangles under tight boxes, sixteen side by side: grouped once for the mesh, refitted to
    /// new positions. The fast one.
    #[default]
    Bvh,
    /// The paper's: cubic cells, each triangle at the deepest level whose cells are at least as large as its box;
    /// built anew for new positions.
    PaperOctree,
}

#[derive(Clone, Debug)]
pub(crate) enum Tree<T: Scalar> {
    Bvh(Bvh<T>),
    PaperOctree(PaperOctree<T>),
}

/// Why an octree cannot be used with a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OctreeError {
    /// The mesh has been given new positions since the octree was built.
    Stale,
    /// The octree was built for a mesh with other triangles.
    OtherMesh,
}

impl fmt::Display for OctreeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stale => {
                write!(f, "the octree is older than its mesh's positions; update it after setting positions")
            }
            Self::OtherMesh => write!(f, "the octree was built for another mesh; use each octree with its own mesh"),
        }
    }
}

impl std::error::Error for OctreeError {}

impl<T: Scalar> Octree<T> {
    /// Builds the octree of `mesh` at its present positions, in the default layout.
    pub fn new(mesh: &Mesh<T>) -> Self {
        Self::with_layout(mesh, Layout::default())
    }

    /// Builds the octree of `mesh` at its present positions.
    pub fn with_layout(mesh: &Mesh<T>, layout: Layout) -> Self {
        let tree = match layout {
            Layout::Bvh => Tree::Bvh(Bvh::new(mesh)),
            Layout::PaperOctree => Tree::PaperOctree(PaperOctree::new(mesh)),
        };
        let patches = memory::shared(PatchLevels::default());
        Self { topology: mesh.shared_topology().clone(), stamp: mesh.stamp(), tree, patches }
    }

    /// Follows the mesh to its present positions; memory is reused.
    ///
    /// # Errors
    /// [`OctreeError::OtherMesh`]; the octree is then as before.
    pub fn update(&mut self, mesh: &Mesh<T>) -> Result<(), OctreeError> {
        if !mesh.shares_topology_with(&self.topology) {
            return Err(OctreeError::OtherMesh);
        }
        let is_new = self.stamp != mesh.stamp();
        match &mut self.tree {
            Tree::Bvh(tree) => {
                if is_new || !tree.is_tight {
                    tree.refit(mesh, None);
                }
                tree.load(mesh, None, true);
            }
            Tree::PaperOctree(tree) if is_new => tree.build(mesh),
            Tree::PaperOctree(_) => {}
        }
        self.stamp = mesh.stamp();
        Ok(())
    }

    /// [`update`](Self::update) for rays that mostly stay in some regions: what lies beside them is not prepared, and rays
    /// there take longer. `ray_count`: about how many rays are expected; tiles are loaded only for enough of them.
    /// `for_distances`: distances are asked for too. `tiles` is scratch memory.
    pub(crate) fn update_in(
        &mut self,
        mesh: &mut Mesh<T>,
        regions: &[Aabb<T>],
        ray_count: usize,
        for_distances: bool,
        tiles: &mut Vec<u32>,
    ) -> Result<(), OctreeError> {
        match &mut self.tree {
            Tree::Bvh(tree) if mesh.shares_topology_with(&self.topology) => {
                if mesh.pose().is_some() {
                    tree.place_in(mesh, regions, self.stamp != mesh.stamp());
                } else if self.stamp != mesh.stamp() {
                    tree.refit(mesh, Some(regions));
                } else if !tree.is_tight {
                    // The regions may be others than last time. A body at rest has tight boxes from its second step on.
                    tree.refit(mesh, None);
                }
                self.stamp = mesh.stamp();
            }
            _ => self.update(mesh)?,
        }
        if let Tree::Bvh(tree) = &mut self.tree
            && ray_count > tree.tile_count() as usize / RAYS_TO_LOAD
        {
            for region in regions {
                tree.tiles_in(region, tiles);
                tree.load(mesh, Some(tiles), for_distances);
            }
        }
        Ok(())
    }

    /// Whether an update would change nothing.
    pub(crate) fn is_settled(&self, mesh: &Mesh<T>) -> bool {
        let is_tight = match &self.tree {
            Tree::Bvh(tree) => tree.is_tight,
            Tree::PaperOctree(_) => true,
        };
        is_tight && self.stamp == mesh.stamp()
    }

    /// Whether [`moved_box`](Self::moved_box) gives a box.
    pub(crate) fn may_move(&mut self, mesh: &Mesh<T>, pose: &Pose) -> bool {
        match &mut self.tree {
            Tree::Bvh(tree) => tree.may_move(mesh, pose),
            Tree::PaperOctree(_) => false,
        }
    }

    /// The smallest box around the mesh's surface, its reference positions moved by a pose; `None` where coordinates may
    /// be beyond the precision. The first call takes as long as a few updates, later ones next to nothing.
    pub(crate) fn moved_box(&mut self, mesh: &Mesh<T>, pose: &Pose) -> Option<Aabb<T>> {
        match &mut self.tree {
            Tree::Bvh(tree) => tree.moved_box(mesh, pose),
            Tree::PaperOctree(_) => None,
        }
    }

    /// Checks every promise of the structure against the mesh: all triangles are there, as often as they should be;
    /// cells and boxes hold what lies under them. For tests and for hunting faults; takes the time of several builds.
    ///
    /// # Errors
    /// What is wrong, and where.
    pub fn validate(&self, mesh: &Mesh<T>) -> Result<(), String> {
        self.tracer(mesh).map_err(|error| error.to_string())?;
        match &self.tree {
            Tree::Bvh(tree) => tree.validate(mesh),
            Tree::PaperOctree(tree) => tree.validate(mesh),
        }
    }
}
