//! The tree of a mesh that is moved by a pose: boxes of the reference positions, moved where rays or regions reach them.
//!
//! Rounded products and sums rise with each factor and term, so the box of a moved box, corner by corner, holds every moved
//! vertex to the bit, without a margin; and the extent of the body is found by looking at few of its tiles.

// Lanes side by side read best, and are best made into SIMD, as plain loops over their index.
#![allow(clippy::needless_range_loop)]

#[cfg(test)]
pub(crate) mod tests;

use crate::bvh::Bvh;
use crate::bvh::node::{BoxLanes, CHILD_COUNT, Node};
use crate::bvh::rays::trace::STACK_SIZE;
use crate::bvh::tile::{Outline, Tile};
use crate::bvh::tile_cylinder::TileCylinder;
use crate::math::{Aabb, Pose, Scalar, Vector3};
use crate::memory;
use crate::mesh::Mesh;
use crate::simd::{Kernel, Lanes, Vectors};

/// The boxes of one node's children, lower and upper corners axis by axis.
type Boxes<T> = [[[T; CHILD_COUNT]; 3]; 2];

/// What is kept of a tree whose mesh has been moved by a pose.
#[derive(Clone, Debug)]
pub(crate) struct Posed<T: Scalar> {
    /// The boxes of each node's children at the reference positions.
    boxes: Vec<Boxes<T>>,
    /// Each tile's cylinder at the reference positions; it bounds a tilted tile more tightly than its box.
    cylinders: Vec<TileCylinder<T>>,
    /// The largest coordinates of any vertex at its reference position.
    largest: Vector3<f64>,
    /// The vertices farthest out at the last pose, both ways along each axis: the next extent starts from them.
    outermost: [u32; 6],
    /// What the tree follows; `None` where it follows positions, as they were last.
    pose: Option<Pose>,
    /// The nodes whose boxes are those at the pose.
    placed: Vec<u32>,
    /// Scratch memory for the nodes to visit, each with its parent and its place there.
    visited: Vec<[u32; 3]>,
}

impl<T: Scalar> Posed<T> {
    fn new(
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
                    (0..nodes[child].count as usize).for_each(|grandchild| {
                        let Aabb { lower, upper } = at_rest[child].child_box(grandchild);
                        aabb = Aabb { lower: aabb.lower.inf(&lower), upper: aabb.upper.sup(&upper) };
                    });
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
    fn move_boxes(&self, pose: &Pose, index: usize, node: &mut Node<T>) {
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

/// How far along the row sixteen boxes reach, for lower and upper corners; the other way round, for upper and lower ones.
#[inline(always)]
fn farthest<T: Scalar>(
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
struct CylindersAtRest<'a, T: Scalar> {
    tiles: &'a [Tile<T>],
    outlines: &'a [Outline<T>],
    reference: &'a [Vector3<T>],
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

/// Finds the box around the moved surface.
struct Extent<'a, T: Scalar> {
    posed: &'a mut Posed<T>,
    nodes: &'a [Node<T>],
    outlines: &'a [Outline<T>],
    reference: &'a [Vector3<T>],
    pose: &'a Pose,
}

impl<T: Scalar> Kernel<T> for Extent<'_, T> {
    type Output = Aabb<T>;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) -> Aabb<T> {
        let Self { posed, nodes, outlines, reference, pose } = self;
        let mut aabb = Aabb::empty();
        for side in 0..6 {
            let (axis, sign) = (side / 2, if side % 2 == 0 { -1.0 } else { 1.0 });
            let row = pose.rotation[axis].map(|entry| sign * entry);
            let position = sign * pose.position[axis];
            // As far as one vertex; what its box does not let reach farther is left out.
            let mut vertex = posed.outermost[side];
            let mut best = along(&row, position, &reference[vertex as usize]);
            let mut stack = [(0_u32, T::INFINITY); STACK_SIZE];
            let mut waiting = 1;
            while waiting > 0 {
                waiting -= 1;
                let (index, reach) = stack[waiting];
                if reach <= best {
                    continue;
                }
                let node = &nodes[index as usize];
                let [lower, upper] = &posed.boxes[index as usize];
                let mut reaches = [T::zero(); CHILD_COUNT];
                farthest(&row, position, [lower, upper], &mut reaches);
                for place in 0..node.count as usize {
                    if reaches[place] <= best {
                        continue;
                    }
                    let child = node.first + place as u32;
                    if !node.is_leaf {
                        stack[waiting] = (child, reaches[place]);
                        waiting += 1;
                        continue;
                    }
                    if posed.cylinders[child as usize].reach(&row) + position <= best.to_f64() {
                        continue;
                    }
                    for &other in &outlines[child as usize].vertices {
                        let reach = along(&row, position, &reference[other as usize]);
                        if reach > best {
                            (best, vertex) = (reach, other);
                        }
                    }
                }
            }
            posed.outermost[side] = vertex;
            if side % 2 == 0 {
                aabb.lower[axis] = -best;
            } else {
                aabb.upper[axis] = best;
            }
        }
        aabb
    }
}

/// A coordinate of [`Pose::moved`].
#[inline(always)]
fn along<T: Scalar>(row: &[f64; 3], position: f64, point: &Vector3<T>) -> T {
    T::of(row[0] * point.x.to_f64() + row[1] * point.y.to_f64() + row[2] * point.z.to_f64() + position)
}

/// Places what meets some regions, nodes and vertices.
struct Place<'a, T: Scalar> {
    cells: &'a mut Bvh<T>,
    mesh: &'a mut Mesh<T>,
    regions: &'a [Aabb<T>],
}

impl<T: Scalar> Kernel<T> for Place<'_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let Self { cells, mesh, regions } = self;
        let Bvh { nodes, outlines, posed, .. } = cells;
        let Some([posed]) = posed.as_deref_mut() else { return };
        let Some(pose) = posed.pose else { return };
        let mut visited = std::mem::take(&mut posed.visited);
        visited.clear();
        visited.push([0; 3]);
        let mut next = 0;
        while next < visited.len() {
            let [index, ..] = visited[next];
            next += 1;
            let node = &mut nodes[index as usize];
            if !node.is_placed {
                posed.move_boxes(&pose, index as usize, node);
                node.is_placed = true;
                posed.placed.push(index);
            }
            let mut met = 0;
            for region in regions {
                met |= node.meets::<L>(&BoxLanes::new(region));
            }
            while met != 0 {
                let place = met.trailing_zeros();
                met &= met - 1;
                let child = node.first + place;
                if !node.is_leaf {
                    visited.push([child, index, place]);
                    continue;
                }
                let outline = &mut outlines[child as usize];
                if !outline.is_known() {
                    mesh.place_vertices(&outline.vertices);
                    let (lower, upper) = L::bounds(mesh.placed_positions(), &outline.vertices);
                    outline.aabb = Aabb { lower, upper };
                    node.set_box(place as usize, &outline.aabb);
                }
            }
        }
        // Children come after their parents.
        for &[index, parent, place] in visited[1..].iter().rev() {
            let aabb = nodes[index as usize].aabb::<L>();
            nodes[parent as usize].set_box(place as usize, &aabb);
        }
        posed.visited = visited;
    }
}

impl<T: Scalar> Bvh<T> {
    /// What is kept for poses, made when it is first asked for.
    fn posed_of(&mut self, mesh: &Mesh<T>) -> &mut Posed<T> {
        let Self { nodes, outlines, posed, tiles, .. } = self;
        let [posed] = &mut **posed.get_or_insert_with(|| {
            let reference = mesh.reference_positions();
            let cylinders = crate::simd::dispatch::<T, _>(CylindersAtRest { tiles, outlines, reference });
            memory::boxed(Posed::new(nodes, outlines, cylinders, reference))
        });
        posed
    }

    /// Whether a pose leaves all coordinates within the precision for certain.
    pub(crate) fn may_move(&mut self, mesh: &Mesh<T>, pose: &Pose) -> bool {
        let posed = self.posed_of(mesh);
        let reach = |axis: usize| {
            let row = &pose.rotation[axis];
            (0..3).fold(pose.position[axis].abs(), |sum, k| sum + row[k].abs() * posed.largest[k])
        };
        (0..3).all(|axis| reach(axis) <= T::LARGEST.to_f64())
    }

    /// The smallest box around the mesh's surface, its reference positions moved by a pose; `None` where coordinates may
    /// be beyond the precision.
    pub(crate) fn moved_box(&mut self, mesh: &Mesh<T>, pose: &Pose) -> Option<Aabb<T>> {
        if !self.may_move(mesh, pose) {
            return None;
        }
        let Self { nodes, outlines, posed, .. } = self;
        let reference = mesh.reference_positions();
        let [posed] = posed.as_deref_mut()?;
        Some(crate::simd::dispatch::<T, _>(Extent { posed, nodes, outlines, reference, pose }))
    }

    /// Follows a mesh with a pose: places what meets some regions, and no more. `is_new`: it has moved since.
    pub(crate) fn place_in(&mut self, mesh: &mut Mesh<T>, regions: &[Aabb<T>], is_new: bool) {
        let Some(&pose) = mesh.pose() else { return };
        self.posed_of(mesh);
        let Self { nodes, outlines, cylinders, posed, is_tight, loading, .. } = self;
        let Some([posed]) = posed.as_deref_mut() else { return };
        if posed.pose.is_none() || is_new {
            *loading += 1;
            cylinders.forget();
        }
        if posed.pose.is_none() {
            nodes.iter_mut().for_each(|node| node.is_placed = false);
            outlines.iter_mut().for_each(Outline::forget);
            posed.pose = Some(pose);
        } else if is_new {
            for index in posed.placed.drain(..) {
                let node = &mut nodes[index as usize];
                node.is_placed = false;
                if node.is_leaf {
                    outlines[node.tiles()].iter_mut().for_each(Outline::forget);
                }
            }
            posed.pose = Some(pose);
        }
        *is_tight = false;
        crate::simd::dispatch::<T, _>(Place { cells: self, mesh, regions });
    }

    /// The tree follows positions again: all boxes are about to be renewed.
    pub(crate) fn leave_pose(&mut self) {
        let Some([posed]) = self.posed.as_deref_mut() else { return };
        if posed.pose.take().is_some() {
            posed.placed.clear();
            for node in &mut self.nodes {
                (node.is_placed, node.is_far) = (true, false);
            }
        }
    }

    /// A node with its boxes where they are now; `room` is for one that no region has reached.
    #[inline(always)]
    pub(crate) fn node<'a>(&'a self, index: usize, room: &'a mut Option<Node<T>>) -> &'a Node<T> {
        let node = &self.nodes[index];
        if node.is_placed { node } else { room.insert(self.moved(index)) }
    }

    /// The box of a node's child where it is now.
    #[inline(always)]
    pub(crate) fn child_box(&self, index: usize, place: usize) -> Aabb<T> {
        let node = &self.nodes[index];
        if node.is_placed { node.child_box(place) } else { self.moved(index).child_box(place) }
    }

    #[cold]
    fn moved(&self, index: usize) -> Node<T> {
        let mut node = self.nodes[index].clone();
        if let Some([posed]) = self.posed.as_deref()
            && let Some(pose) = &posed.pose
        {
            posed.move_boxes(pose, index, &mut node);
        }
        node
    }
}
