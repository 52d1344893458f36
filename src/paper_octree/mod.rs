//! The paper's octree: a triangle lives at the deepest level whose cell is at least as large as the triangle's box, in
//! the at most eight cells its box touches there.

mod build;
mod nearest;
mod trace;
mod validate;

use crate::math::{Scalar, Vector3};
use crate::mesh::Mesh;

/// Cubic cells in flat arrays, without a pointer in any node.
#[derive(Clone, Debug)]
pub(crate) struct PaperOctree<T: Scalar> {
    /// The lower corner of the root cell, a cube: that of the mesh's box. Cells are measured from here, since far from
    /// the world's origin their planes would be rounded more coarsely than any margin allows for.
    corner: Vector3<T>,
    /// The root cell's side.
    side: T,
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

impl<T: Scalar> PaperOctree<T> {
    pub(crate) fn new(mesh: &Mesh<T>) -> Self {
        let mut cells = Self {
            corner: Vector3::zeros(),
            side: T::zero(),
            nodes: Vec::new(),
            entries: Vec::new(),
            scratch: Vec::new(),
        };
        cells.build(mesh);
        cells
    }
}
