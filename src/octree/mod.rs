//! The search structure over one mesh's triangles.
//!
//! The paper's rule: a triangle lives at the deepest level whose cell is at least as large as the triangle's box, in
//! the at most eight cells its box touches there. Everything is relative to the mesh's own box, so there is no world
//! size and no smallest triangle.

mod build;
mod trace;
mod validate;

pub use trace::Tracer;

use crate::math::{Aabb, Scalar};
use crate::mesh::{Mesh, Topology};
use std::fmt;
use std::sync::Arc;

/// An octree over the triangles of one mesh, for the positions it was last built from.
#[derive(Clone, Debug)]
pub struct Octree<T: Scalar> {
    topology: Arc<Topology>,
    stamp: u64,
    /// The root cell: a cube whose lower corner is that of the mesh's box.
    root: Aabb<T>,
    /// Breadth first: the children of a node are neighbours, and come after it.
    nodes: Vec<Node>,
    /// The triangles of all nodes, each node's together.
    entries: Vec<build::Entry>,
    scratch: Vec<build::Entry>,
}

/// A cell that holds triangles, itself or in a cell below.
#[derive(Clone, Copy, Debug, Default)]
struct Node {
    first_entry: u32,
    /// Own entries come first, those of the cells below follow.
    own_end: u32,
    subtree_end: u32,
    first_child: u32,
    /// Bit i: there is a child in octant i (bit 0 of i: upper half along x, bit 1: y, bit 2: z).
    children: u8,
    level: u8,
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
    /// Builds the octree of `mesh` at its present positions.
    pub fn new(mesh: &Mesh<T>) -> Self {
        let mut octree = Self {
            topology: Arc::clone(mesh.shared_topology()),
            stamp: mesh.stamp(),
            root: Aabb::empty(),
            nodes: Vec::new(),
            entries: Vec::new(),
            scratch: Vec::new(),
        };
        octree.build(mesh);
        octree
    }

    /// Builds it anew for the mesh's present positions; memory is reused.
    ///
    /// # Errors
    /// [`OctreeError::OtherMesh`]; the octree is then as before.
    pub fn update(&mut self, mesh: &Mesh<T>) -> Result<(), OctreeError> {
        if !mesh.shares_topology_with(&self.topology) {
            return Err(OctreeError::OtherMesh);
        }
        if self.stamp != mesh.stamp() {
            self.build(mesh);
            self.stamp = mesh.stamp();
        }
        Ok(())
    }

    /// Joins octree and mesh for tracing.
    ///
    /// # Errors
    /// [`OctreeError`], where the two do not belong together or the octree is stale.
    pub fn tracer<'a>(&'a self, mesh: &'a Mesh<T>) -> Result<Tracer<'a, T>, OctreeError> {
        if !mesh.shares_topology_with(&self.topology) {
            return Err(OctreeError::OtherMesh);
        }
        if self.stamp != mesh.stamp() {
            return Err(OctreeError::Stale);
        }
        Ok(Tracer::new(self, mesh))
    }
}
