//! A tree whose mesh is moved by a pose: how far it reaches then, and its nodes and vertices placed where regions are.

#[cfg(test)]
pub(crate) mod tests;

use crate::bvh::node::{BoxLanes, CHILD_COUNT, Node};
use crate::bvh::posed::{CylindersAtRest, Posed, farthest};
use crate::bvh::tile::Outline;
use crate::bvh::tree::Bvh;
use crate::bvh::walk::{Children, Visitor, Way, first_of};
use crate::math::{Aabb, Pose, Scalar, Vector3};
use crate::memory;
use crate::mesh::Mesh;
use crate::simd::{Kernel, Lanes, Mask};

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
            // The first guess is the vertex that was outermost last time. What cannot reach farther by its box is left out.
            let vertex = posed.outermost[side];
            let reach = along(&row, position, &reference[vertex as usize]);
            let mut farthest = Farthest { posed, nodes, outlines, reference, row, position, vertex, reach };
            Way::new([T::zero(); CHILD_COUNT]).walk::<T, L>(&mut farthest);
            let Farthest { vertex, reach, .. } = farthest;
            posed.outermost[side] = vertex;
            if side % 2 == 0 {
                aabb.lower[axis] = -reach;
            } else {
                aabb.upper[axis] = reach;
            }
        }
        aabb
    }
}

/// Finds the vertex that is farthest out along a row.
struct Farthest<'a, T: Scalar> {
    posed: &'a Posed<T>,
    nodes: &'a [Node<T>],
    outlines: &'a [Outline<T>],
    reference: &'a [Vector3<T>],
    row: [f64; 3],
    position: f64,
    /// The farthest vertex found so far, and how far it reaches.
    vertex: u32,
    reach: T,
}

impl<T: Scalar, L: Lanes<T>> Visitor<T, L> for Farthest<'_, T> {
    /// How far each child may reach.
    type Kept = [T; CHILD_COUNT];

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter(&mut self, index: u32, reaches: &mut Self::Kept) -> Children {
        let (node, [lower, upper]) = (&self.nodes[index as usize], &self.posed.boxes[index as usize]);
        farthest(&self.row, self.position, [lower, upper], reaches);
        let (first, mut left) = (node.first, node.present());
        if !node.is_leaf {
            return Children { first, left };
        }
        while let Some(place) = Visitor::<T, L>::next(self, reaches, &mut left) {
            let tile = (first + place) as usize;
            if self.posed.cylinders[tile].reach(&self.row) + self.position <= self.reach.to_f64() {
                continue;
            }
            for &other in &self.outlines[tile].vertices {
                let reach = along(&self.row, self.position, &self.reference[other as usize]);
                if reach > self.reach {
                    (self.reach, self.vertex) = (reach, other);
                }
            }
        }
        Children::NONE
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn next(&mut self, reaches: &Self::Kept, left: &mut Mask) -> Option<u32> {
        loop {
            let place = first_of(left)?;
            if reaches[place as usize % CHILD_COUNT] > self.reach {
                return Some(place);
            }
        }
    }
}

/// A coordinate of [`Pose::moved`].
#[inline(always)]
fn along<T: Scalar>(row: &[f64; 3], position: f64, point: &Vector3<T>) -> T {
    T::of(row[0] * point.x.to_f64() + row[1] * point.y.to_f64() + row[2] * point.z.to_f64() + position)
}

/// Places the nodes and vertices that meet some regions.
struct Place<'a, T: Scalar> {
    tree: &'a mut Bvh<T>,
    mesh: &'a mut Mesh<T>,
    regions: &'a [Aabb<T>],
}

impl<T: Scalar> Kernel<T> for Place<'_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let Self { tree, mesh, regions } = self;
        let Bvh { nodes, outlines, posed, .. } = tree;
        let Some([posed]) = posed.as_deref_mut() else { return };
        let Some(pose) = posed.pose else { return };
        let mut visited = std::mem::take(&mut posed.visited);
        visited.clear();
        let mut placing = Placing { nodes, outlines, posed, pose: &pose, mesh, regions, visited: &mut visited };
        Way::new(()).walk::<T, L>(&mut placing);
        // Backwards, since what lies under a node was visited after it.
        for &(node, Children { first, mut left }) in visited.iter().rev() {
            while let Some(place) = first_of(&mut left) {
                let aabb = nodes[(first + place) as usize].aabb::<L>();
                nodes[node as usize].set_box(place as usize, &aabb);
            }
        }
        posed.visited = visited;
    }
}

struct Placing<'a, T: Scalar> {
    nodes: &'a mut [Node<T>],
    outlines: &'a mut [Outline<T>],
    posed: &'a mut Posed<T>,
    pose: &'a Pose,
    mesh: &'a mut Mesh<T>,
    regions: &'a [Aabb<T>],
    visited: &'a mut Vec<(u32, Children)>,
}

impl<T: Scalar, L: Lanes<T>> Visitor<T, L> for Placing<'_, T> {
    type Kept = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter(&mut self, index: u32, (): &mut ()) -> Children {
        let node = &mut self.nodes[index as usize];
        if !node.is_placed {
            self.posed.move_boxes(self.pose, index as usize, node);
            node.is_placed = true;
            self.posed.placed.push(index);
        }
        let mut children = Children { first: node.first, left: 0 };
        for region in self.regions {
            children.left |= node.meets::<L>(&BoxLanes::new(region));
        }
        if !node.is_leaf {
            self.visited.push((index, children));
            return children;
        }
        while let Some(place) = first_of(&mut children.left) {
            let outline = &mut self.outlines[(node.first + place) as usize];
            if !outline.is_known() {
                self.mesh.place_vertices(&outline.vertices);
                let (lower, upper) = L::bounds(self.mesh.placed_positions(), &outline.vertices);
                outline.aabb = Aabb { lower, upper };
                node.set_box(place as usize, &outline.aabb);
            }
        }
        children
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

    /// Follows a mesh with a pose: places what meets some regions, and no more. `is_new`: the mesh has moved since the last call.
    pub(crate) fn place_in(&mut self, mesh: &mut Mesh<T>, regions: &[Aabb<T>], is_new: bool) {
        let Some(&pose) = mesh.pose() else { return };
        self.posed_of(mesh);
        let Self { nodes, outlines, cylinders, posed, is_tight, loading, .. } = self;
        let Some([posed]) = posed.as_deref_mut() else { return };
        let is_first = posed.pose.is_none();
        if is_first || is_new {
            *loading += 1;
            cylinders.forget();
            posed.pose = Some(pose);
        }
        if is_first {
            nodes.iter_mut().for_each(|node| node.is_placed = false);
            outlines.iter_mut().for_each(Outline::forget);
        } else if is_new {
            for index in posed.placed.drain(..) {
                let node = &mut nodes[index as usize];
                node.is_placed = false;
                if node.is_leaf {
                    outlines[node.tiles()].iter_mut().for_each(Outline::forget);
                }
            }
        }
        *is_tight = false;
        crate::simd::dispatch::<T, _>(Place { tree: self, mesh, regions });
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
}
