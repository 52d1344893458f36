use crate::math::{Scalar, Vector3};
use crate::mesh::Mesh;

/// Cubic cells in flat arrays, without a pointer in any node.
#[derive(Clone, Debug)]
pub(crate) struct PaperOctree<T: Scalar> {
    /// The lower corner of the root cell, a cube, and of the mesh's box. Cells are measured from here: far from the world's
    /// origin their planes would be rounded more coarsely than any margin allows for.
    pub(super) corner: Vector3<T>,
    /// The root cell's side.
    pub(super) side: T,
    /// Breadth first: the children of a node are neighbours, and come after it.
    pub(super) nodes: Vec<Node>,
    /// The triangles of all nodes, each node's together.
    pub(super) entries: Vec<Entry>,
    pub(super) scratch: Vec<Entry>,
}

/// A cell that holds triangles, itself or in a cell below.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Node {
    pub(super) first_entry: u32,
    /// The node's own entries come first and end here, those of the cells below follow.
    pub(super) own_end: u32,
    pub(super) subtree_end: u32,
    pub(super) first_child: u32,
    /// Bit i: there is a child in octant i (bit 0 of i: upper half along x, bit 1: y, bit 2: z).
    pub(super) children: u8,
    pub(super) level: u8,
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

/// A triangle in one cell.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Entry {
    /// The octants on the way down to the cell, three bits each, the last one lowest.
    pub(super) path: u64,
    pub(super) triangle: u32,
    pub(super) level: u8,
}
