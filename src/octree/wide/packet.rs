use super::dispatch::Kernel;
use super::trace::{STACK_SIZE, offer};
use super::{CHILD_COUNT, Child, Node, Wide};
use crate::math::{Aabb, Scalar};
use crate::octree::slabs::Slabs;
use crate::ray::{PreparedRay, Ray};

/// How many rays travel together.
pub(in crate::octree) const PACKET_SIZE: usize = 16;

/// The way of up to 16 neighbouring rays through the cells: the box around all of them chooses the tiles, then each
/// tile's box chooses among the rays.
pub(super) struct PacketWalk<'a, T: Scalar, V> {
    cells: &'a Wide<T>,
    prepared: &'a [PreparedRay<T>],
    around: Aabb<T>,
    origin: [[T; PACKET_SIZE]; 3],
    inverse: [[T; PACKET_SIZE]; 3],
    margin: [T; PACKET_SIZE],
    /// Minus infinity where there is no ray, and where a ray needs no more.
    t_max: [T; PACKET_SIZE],
    visitor: &'a mut V,
}

impl<'a, T: Scalar, V: FnMut(usize, u32) -> T> PacketWalk<'a, T, V> {
    #[inline(always)]
    pub(super) fn new(
        cells: &'a Wide<T>,
        rays: &[Ray<T>],
        prepared: &'a [PreparedRay<T>],
        mesh_box: &Aabb<T>,
        visitor: &'a mut V,
    ) -> Self {
        let mut walk = Self {
            cells,
            prepared,
            around: Aabb::empty(),
            origin: [[T::zero(); PACKET_SIZE]; 3],
            inverse: [[T::zero(); PACKET_SIZE]; 3],
            margin: [T::zero(); PACKET_SIZE],
            t_max: [-T::INFINITY; PACKET_SIZE],
            visitor,
        };
        for (place, ray) in rays.iter().enumerate() {
            let slabs = Slabs::new(ray, mesh_box);
            for axis in 0..3 {
                walk.origin[axis][place] = slabs.origin[axis];
                walk.inverse[axis][place] = slabs.inverse[axis];
            }
            walk.margin[place] = slabs.margin;
            walk.t_max[place] = ray.t_max;
            let around = slabs.box_around(ray, mesh_box);
            walk.around.lower = walk.around.lower.inf(&around.lower);
            walk.around.upper = walk.around.upper.sup(&around.upper);
        }
        walk
    }
}

impl<T: Scalar, V: FnMut(usize, u32) -> T> Kernel for PacketWalk<'_, T, V> {
    #[inline(always)]
    fn run(&mut self) {
        let mut stack = [0u32; STACK_SIZE];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let node = &self.cells.nodes[stack[waiting] as usize];
            let mut near = self.near(node);
            while near != 0 {
                let place = near.trailing_zeros() as usize;
                near &= near - 1;
                match node.children[place] {
                    Child::Node(child) => {
                        stack[waiting] = child;
                        waiting += 1;
                    }
                    Child::Tile(tile) => self.visit_tile(node, place, tile),
                    Child::None => {}
                }
            }
        }
    }
}

impl<T: Scalar, V: FnMut(usize, u32) -> T> PacketWalk<'_, T, V> {
    #[inline(always)]
    fn visit_tile(&mut self, node: &Node<T>, place: usize, tile: u32) {
        let tile = &self.cells.tiles[tile as usize];
        let mut meeting = self.meeting(node, place);
        while meeting != 0 {
            let ray = meeting.trailing_zeros() as usize;
            meeting &= meeting - 1;
            let visitor = &mut *self.visitor;
            offer(tile, &self.prepared[ray], &mut self.t_max[ray], &mut |triangle| visitor(ray, triangle));
        }
    }

    /// Bit i: child i's box meets the box around the packet.
    #[inline(always)]
    fn near(&self, node: &Node<T>) -> u32 {
        let mut overlapping = [true; CHILD_COUNT];
        for axis in 0..3 {
            let (from, to) = (self.around.lower[axis], self.around.upper[axis]);
            for child in 0..CHILD_COUNT {
                overlapping[child] &= (node.lower[axis][child] <= to) & (node.upper[axis][child] >= from);
            }
        }
        let mut mask = 0;
        for child in 0..CHILD_COUNT {
            mask |= u32::from(overlapping[child]) << child;
        }
        mask
    }

    /// Bit i: ray i meets this box, not beyond its `t_max`.
    #[inline(always)]
    fn meeting(&self, node: &Node<T>, place: usize) -> u32 {
        let mut enters = [-T::INFINITY; PACKET_SIZE];
        let mut leaves = self.t_max;
        for axis in 0..3 {
            let (lower, upper) = (node.lower[axis][place], node.upper[axis][place]);
            let (origin, inverse) = (&self.origin[axis], &self.inverse[axis]);
            for ray in 0..PACKET_SIZE {
                let at_lower = (lower - origin[ray] - self.margin[ray]) * inverse[ray];
                let at_upper = (upper - origin[ray] + self.margin[ray]) * inverse[ray];
                let (from, to) = if at_lower < at_upper { (at_lower, at_upper) } else { (at_upper, at_lower) };
                enters[ray] = if from > enters[ray] { from } else { enters[ray] };
                leaves[ray] = if to < leaves[ray] { to } else { leaves[ray] };
            }
        }
        let mut mask = 0;
        for ray in 0..PACKET_SIZE {
            mask |= u32::from((enters[ray] <= leaves[ray]) & (leaves[ray] >= T::zero())) << ray;
        }
        mask
    }
}
