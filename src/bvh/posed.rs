//! The tree of a mesh that is moved by a pose: boxes of the reference positions, moved where rays or regions reach them.
//!
//! Rounded products and sums rise with each factor and term. So the box around a box's moved corners holds every moved vertex
//! to the bit, without a margin, and the extent of the body is found from few of its tiles.

use crate::bvh::node::{CHILD_COUNT, Node};
use crate::bvh::tile::{Outline, Tile};
use crate::bvh::tile_cylinder::TileCylinder;
use crate::bvh::walk::Children;
use crate::math::{Aabb, Pose, Scalar, Vector3};
use crate::memory;
use crate::simd::{Kernel, Lanes, Vectors};

/// The boxes of one node's children, lower and upper corners axis by axis.
type Boxes<T> = [[[T; CHILD_COUNT]; 3]; 2];

/// What is kept of a tree whose mesh has been moved by a pose.
#[derive(Clone, Debug)]
pub(crate) struct Posed<T: Scalar> {
    /// The boxes of each node's children at the reference positions.
    pub(crate) boxes: Vec<Boxes<T>>,
    /// Each tile's cylinder at the reference positions; it bounds a tilted tile more tightly than its box.
    pub(crate) cylinders: Vec<TileCylinder<T>>,
    /// The largest size of each coordinate of any vertex at its reference position.
    pub(crate) largest: Vector3<f64>,
    /// The vertices farthest out at the last pose, both ways along each axis: the next extent starts from them.
    pub(crate) outermost: [u32; 6],
    /// The pose that the tree follows; `None` where it follows positions.
    pub(crate) pose: Option<Pose>,
    /// The nodes whose boxes are those at the pose.
    pub(crate) placed: Vec<u32>,
    /// Scratch memory for the nodes visited, and which children of each were visited next.
    pub(crate) visited: Vec<(u32, Children)>,
}

impl<T: Scalar> Posed<T> {
    pub(crate) fn new(
        nodes: &[Node<T>],
        outlines: &[Outline<T>],
        cylinders: Vec<TileCylinder<T>>,
        reference: &[Vector3<T>],
    ) -> Self {
        let mut at_rest = memory::listed(nodes.iter().cloned());
        for index in (0..nodes.len()).rev() {
            for place in 0..nodes[index].count as usize {
                let child = nodes[index].first as usize + place;
                let mut aabb = Aabb::empty();
                if nodes[index].is_leaf {
                    outlines[child].vertices.iter().for_each(|&vertex| aabb.include(&reference[vertex as usize]));
                } else {
                    aabb = at_rest[child].around_children();
                }
                at_rest[index].set_box(place, &aabb);
            }
        }
        let largest = reference.iter().fold(Vector3::zeros(), |largest, point| largest.sup(&point.abs()));
        Self {
            boxes: memory::listed(at_rest.iter().map(|node| [node.lower, node.upper])),
            cylinders,
            largest: largest.map(T::to_f64),
            outermost: [outlines[0].vertices[0]; 6],
            pose: None,
            placed: memory::with_room(nodes.len()),
            visited: memory::with_room(nodes.len()),
        }
    }

    /// A node's boxes moved by the pose: around all that moved vertices round to.
    #[inline(always)]
    pub(crate) fn move_boxes(&self, pose: &Pose, index: usize, node: &mut Node<T>) {
        let [lower, upper] = &self.boxes[index];
        for axis in 0..3 {
            let (row, position) = (&pose.rotation[axis], pose.position[axis]);
            farthest(row, position, [lower, upper], &mut node.upper[axis]);
            farthest(row, position, [upper, lower], &mut node.lower[axis]);
            node.lower[axis][node.count as usize..].fill(T::INFINITY);
            node.upper[axis][node.count as usize..].fill(-T::INFINITY);
        }
    }
}

/// How far along the row sixteen boxes reach, given their lower and upper corners; with the two exchanged, how far against it.
#[inline(always)]
pub(crate) fn farthest<T: Scalar>(
    row: &[f64; 3],
    position: f64,
    [lower, upper]: [&[[T; CHILD_COUNT]; 3]; 2],
    to: &mut [T; CHILD_COUNT],
) {
    let x = if row[0] < 0.0 { &lower[0] } else { &upper[0] };
    let y = if row[1] < 0.0 { &lower[1] } else { &upper[1] };
    let z = if row[2] < 0.0 { &lower[2] } else { &upper[2] };
    for lane in 0..CHILD_COUNT {
        let [x, y, z] = [x[lane].to_f64(), y[lane].to_f64(), z[lane].to_f64()];
        to[lane] = T::of(row[0] * x + row[1] * y + row[2] * z + position);
    }
}

/// Makes the cylinders of the reference positions.
pub(crate) struct CylindersAtRest<'a, T: Scalar> {
    pub(crate) tiles: &'a [Tile<T>],
    pub(crate) outlines: &'a [Outline<T>],
    pub(crate) reference: &'a [Vector3<T>],
}

impl<T: Scalar> Kernel<T> for CylindersAtRest<'_, T> {
    type Output = Vec<TileCylinder<T>>;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) -> Vec<TileCylinder<T>> {
        let mut cylinders = memory::with_room(self.tiles.len());
        for (tile, outline) in self.tiles.iter().zip(self.outlines) {
            let mut at_rest = tile.clone();
            Vectors::<T, L>::gather(self.reference, &outline.vertices).store(&mut at_rest.positions);
            cylinders.push(TileCylinder::around::<L>(&at_rest));
        }
        cylinders
    }
}
