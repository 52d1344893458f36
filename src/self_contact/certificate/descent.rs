use crate::bvh::{Bvh, CHILD_COUNT, Node};
use crate::math::{Aabb, Scalar};
use crate::memory::Room;

/// The descent into all pairs of boxes that are near each other.
pub(crate) struct Descent<'a, T: Scalar> {
    pub(crate) tree: &'a Bvh<T>,
    pub(crate) distance: T,
    pub(crate) tile_pairs: &'a mut Vec<[u32; 2]>,
    /// The descent ends once there are more pairs.
    pub(crate) most_pairs: usize,
}

/// What lies under a box.
#[derive(Clone, Copy)]
enum Child {
    Node(u32),
    Tile(u32),
}

/// A box of the octree and what lies under it.
#[derive(Clone, Copy)]
struct Boxed<T: Scalar> {
    aabb: Aabb<T>,
    child: Child,
}

impl<T: Scalar> Descent<'_, T> {
    pub(crate) fn within_all(&mut self) {
        self.within(Child::Node(0));
    }

    fn within(&mut self, child: Child) {
        let node = match child {
            Child::Node(node) => &self.tree.nodes[node as usize],
            Child::Tile(tile) => return self.tile_pairs.room_for(1).push([tile; 2]),
        };
        for place in 0..node.count as usize {
            let boxed = Boxed::of(node, place);
            self.within(boxed.child);
            let mut near = self.near(node, &boxed.aabb) & (!0 << (place + 1));
            while near != 0 {
                self.between(boxed, Boxed::of(node, near.trailing_zeros() as usize));
                near &= near - 1;
            }
        }
    }

    fn between(&mut self, first: Boxed<T>, second: Boxed<T>) {
        if self.tile_pairs.len() > self.most_pairs {
            return;
        }
        match (first.child, second.child) {
            (Child::Tile(first), Child::Tile(second)) => self.tile_pairs.room_for(1).push([first, second]),
            (Child::Node(node), _) => self.descend(node, second),
            (_, Child::Node(node)) => self.descend(node, first),
        }
    }

    fn descend(&mut self, node: u32, other: Boxed<T>) {
        let node = &self.tree.nodes[node as usize];
        let mut near = self.near(node, &other.aabb);
        while near != 0 {
            // The other may be a node too, and is then descended into next.
            self.between(other, Boxed::of(node, near.trailing_zeros() as usize));
            near &= near - 1;
        }
    }

    /// Which children's boxes are near `other`.
    fn near(&self, node: &Node<T>, other: &Aabb<T>) -> u32 {
        let mut near = [true; CHILD_COUNT];
        for axis in 0..3 {
            let (lower, upper) = (&node.lower[axis], &node.upper[axis]);
            let (to, from) = (other.upper[axis] + self.distance, other.lower[axis] - self.distance);
            for child in 0..CHILD_COUNT {
                near[child] &= (lower[child] <= to) & (upper[child] >= from);
            }
        }
        (0..CHILD_COUNT).fold(0, |mask, child| mask | u32::from(near[child]) << child)
    }
}

impl<T: Scalar> Boxed<T> {
    fn of(node: &Node<T>, place: usize) -> Self {
        let child = node.first + place as u32;
        Self { aabb: node.child_box(place), child: if node.is_leaf { Child::Tile(child) } else { Child::Node(child) } }
    }
}
