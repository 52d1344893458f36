use super::{CHILD_COUNT, Child, Node, TILE_SIZE, Tile, Wide};
use crate::math::{Aabb, Scalar};
use crate::octree::slabs::Slabs;
use crate::ray::{PreparedRay, Ray, ShearedRay};

impl<T: Scalar> Wide<T> {
    /// Offers every triangle that the ray may meet up to the `t` that `visitor` last returned.
    pub(in crate::octree) fn visit(
        &self,
        ray: &Ray<T>,
        prepared: &PreparedRay<T>,
        mesh_box: &Aabb<T>,
        visitor: &mut impl FnMut(u32) -> T,
    ) {
        let slabs = Slabs::new(ray, mesh_box);
        let mut walk = Walk { cells: self, slabs, prepared, t_max: ray.t_max, visitor };
        walk.descend(0);
    }
}

struct Walk<'a, T: Scalar, V> {
    cells: &'a Wide<T>,
    slabs: Slabs<T>,
    prepared: &'a PreparedRay<T>,
    t_max: T,
    visitor: &'a mut V,
}

impl<T: Scalar, V: FnMut(u32) -> T> Walk<'_, T, V> {
    fn descend(&mut self, node: u32) {
        let node = &self.cells.nodes[node as usize];
        let entries = self.entries(node);
        for (child, entry) in node.children.iter().zip(entries) {
            // Tested one by one, since a hit in an earlier child may have shortened the ray.
            if entry <= self.t_max {
                match *child {
                    Child::Node(node) => self.descend(node),
                    Child::Tile(tile) => self.offer(&self.cells.tiles[tile as usize]),
                    Child::None => {}
                }
            }
        }
    }

    /// Where the ray enters each child's box; NaN for boxes that it does not meet ahead of its origin.
    fn entries(&self, node: &Node<T>) -> [T; CHILD_COUNT] {
        let mut enters = [-T::INFINITY; CHILD_COUNT];
        let mut leaves = [T::INFINITY; CHILD_COUNT];
        for axis in 0..3 {
            let (lower, upper) = (&node.lower[axis], &node.upper[axis]);
            let at_lower: [T; CHILD_COUNT] = std::array::from_fn(|child| self.slabs.at_lower(axis, lower[child]));
            let at_upper: [T; CHILD_COUNT] = std::array::from_fn(|child| self.slabs.at_upper(axis, upper[child]));
            let mirrored = self.slabs.is_mirrored(axis);
            let (from, to) = if mirrored { (&at_upper, &at_lower) } else { (&at_lower, &at_upper) };
            for child in 0..CHILD_COUNT {
                enters[child] = larger(enters[child], from[child]);
                leaves[child] = smaller(leaves[child], to[child]);
            }
        }
        let nan = T::INFINITY - T::INFINITY;
        std::array::from_fn(|child| {
            let met = (enters[child] <= leaves[child]) & (leaves[child] >= T::zero());
            if met { enters[child] } else { nan }
        })
    }

    fn offer(&mut self, tile: &Tile<T>) {
        let mut candidates = match self.prepared {
            PreparedRay::Watertight(ray) => tile.candidates(ray),
            PreparedRay::MollerTrumbore(_) => u16::MAX,
        };
        candidates &= u16::MAX >> (TILE_SIZE - tile.triangle_count as usize);
        while candidates != 0 {
            let place = candidates.trailing_zeros();
            candidates &= candidates - 1;
            self.t_max = (self.visitor)(tile.triangles[place as usize]);
        }
    }
}

impl<T: Scalar> Tile<T> {
    /// Bit i: the ray's line may meet triangle i. Those are left out whose projected corners all lie strictly on one
    /// side of an axis through the ray: the edge functions of [`ShearedRay::intersect`], exact in sign for the same
    /// projections, refuse them too.
    fn candidates(&self, ray: &ShearedRay<T>) -> u16 {
        let [x, y] = ray.project_all(&self.positions);
        let zero = T::zero();
        let sides = [
            vertex_mask(&x, |x| x > zero),
            vertex_mask(&x, |x| x < zero),
            vertex_mask(&y, |y| y > zero),
            vertex_mask(&y, |y| y < zero),
        ];
        let mut candidates = [0u16; TILE_SIZE];
        for triangle in 0..TILE_SIZE {
            let outside = sides.map(|side| !side & self.vertex_masks[triangle]);
            let keep = outside.iter().fold(true, |keep, &left_over| keep & (left_over != 0));
            candidates[triangle] = if keep { 1 << triangle } else { 0 };
        }
        candidates.iter().fold(0, |mask, bit| mask | bit)
    }
}

fn vertex_mask<T: Scalar>(values: &[T; TILE_SIZE], is_in: impl Fn(T) -> bool) -> u16 {
    let bits: [u16; TILE_SIZE] = std::array::from_fn(|place| if is_in(values[place]) { 1 << place } else { 0 });
    bits.iter().fold(0, |mask, bit| mask | bit)
}

fn larger<T: Scalar>(a: T, b: T) -> T {
    if b > a { b } else { a }
}

fn smaller<T: Scalar>(a: T, b: T) -> T {
    if b < a { b } else { a }
}
