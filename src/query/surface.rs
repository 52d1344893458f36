//! One body's surface: its triangles and the tree over them, as one thing that refits itself.

use crate::math::{Aabb, Pose, Scalar};
use crate::mesh::Mesh;
use crate::query::octree::Octree;
use crate::query::tracer::Tracer;

/// A mesh with its own tree, which follows it.
#[derive(Debug)]
pub(crate) struct Surface<T: Scalar> {
    mesh: Mesh<T>,
    octree: Octree<T>,
    /// Scratch memory for a list of the tree's tiles.
    tiles: Vec<u32>,
}

impl<T: Scalar> Surface<T> {
    pub(crate) fn new(mesh: Mesh<T>) -> Self {
        let octree = Octree::new(&mesh);
        Self { mesh, octree, tiles: Vec::new() }
    }

    pub(crate) fn mesh(&self) -> &Mesh<T> {
        &self.mesh
    }

    /// The mesh, to renew its positions; the tree follows at the next refit.
    pub(crate) fn mesh_mut(&mut self) -> &mut Mesh<T> {
        &mut self.mesh
    }

    pub(crate) fn into_mesh(self) -> Mesh<T> {
        self.mesh
    }

    /// The tree, as it was refitted last.
    pub(crate) fn octree(&self) -> &Octree<T> {
        &self.octree
    }

    /// Whether the tree is up to date.
    pub(crate) fn is_settled(&self) -> bool {
        self.octree.is_settled(&self.mesh)
    }

    /// Makes the tree follow the mesh everywhere.
    pub(crate) fn refit(&mut self) {
        self.octree.update(&self.mesh).expect("the tree was built for this mesh");
    }

    /// The same for rays that mostly stay in some regions: see [`Octree::update_in`].
    pub(crate) fn refit_in(&mut self, regions: &[Aabb<T>], ray_count: usize, for_distances: bool) {
        let Self { mesh, octree, tiles } = self;
        let refitted = octree.update_in(mesh, regions, ray_count, for_distances, tiles);
        refitted.expect("the tree was built for this mesh");
    }

    /// What rays are traced in; the tree must have been refitted since the mesh has moved.
    pub(crate) fn tracer(&self) -> Tracer<'_, T> {
        self.octree.tracer(&self.mesh).expect("surfaces that meet others are refitted first")
    }

    /// Whether [`set_pose`](Self::set_pose) will succeed.
    pub(crate) fn may_move(&mut self, pose: &Pose) -> bool {
        self.octree.may_move(&self.mesh, pose)
    }

    /// Moves the reference positions by a pose; false where they might be beyond the precision.
    pub(crate) fn set_pose(&mut self, pose: &Pose) -> bool {
        let Some(aabb) = self.octree.moved_box(&self.mesh, pose) else { return false };
        self.mesh.follow(pose, aabb);
        true
    }
}
