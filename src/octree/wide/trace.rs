use super::{CHILD_COUNT, Node, Tile, Wide};
use crate::math::{Aabb, Kernel, LANE_COUNT, Lanes, Scalar};
use crate::octree::slabs::Slabs;
use crate::ray::{PreparedRay, Ray};

/// Nodes that can wait at once: seven for each level but the last, and 2³² tiles have no more than eleven levels; and
/// room behind them that may be overwritten.
pub(super) const STACK_SIZE: usize = 80 + LANE_COUNT;

/// One ray's way through the cells.
pub(super) struct Walk<'a, T: Scalar, V> {
    cells: &'a Wide<T>,
    slabs: Slabs<T>,
    prepared: &'a PreparedRay<T>,
    t_max: T,
    visitor: &'a mut V,
}

impl<'a, T: Scalar, V: FnMut(u32) -> T> Walk<'a, T, V> {
    pub(super) fn new(
        cells: &'a Wide<T>,
        ray: &Ray<T>,
        prepared: &'a PreparedRay<T>,
        mesh_box: &Aabb<T>,
        visitor: &'a mut V,
    ) -> Self {
        Self { cells, slabs: Slabs::new(ray, mesh_box), prepared, t_max: ray.t_max, visitor }
    }
}

impl<T: Scalar, V: FnMut(u32) -> T> Kernel<T> for Walk<'_, T, V> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(mut self) {
        let mut stack = [0u32; STACK_SIZE];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let node = &self.cells.nodes[stack[waiting] as usize];
            let entries = entries::<T, L>(&self.slabs, node);
            for (place, &entry) in entries.iter().enumerate().take(node.count as usize) {
                // NaN is left out. A hit found since may have shortened the ray.
                if entry <= self.t_max {
                    let child = node.first + place as u32;
                    if node.is_leaf {
                        self.offer::<L>(&self.cells.tiles[child as usize]);
                    } else {
                        stack[waiting] = child;
                        waiting += 1;
                    }
                }
            }
        }
    }
}

impl<T: Scalar, V: FnMut(u32) -> T> Walk<'_, T, V> {
    /// Offers the triangles of a tile that the ray may meet.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn offer<L: Lanes<T>>(&mut self, tile: &Tile<T>) {
        let mut met = match self.prepared {
            PreparedRay::Watertight(ray) => ray.may_meet::<L>(&tile.positions, &tile.corners) & tile.present,
            PreparedRay::MollerTrumbore(_) => tile.present,
        };
        while met != 0 {
            let place = met.trailing_zeros() as usize;
            met &= met - 1;
            self.t_max = (self.visitor)(tile.triangles[place]);
        }
    }
}

/// Where the ray enters each child's box; NaN, which no `t_max` reaches, for boxes that it does not meet ahead of its
/// origin.
#[cfg_attr(not(debug_assertions), inline(always))]
fn entries<T: Scalar, L: Lanes<T>>(slabs: &Slabs<T>, node: &Node<T>) -> [T; CHILD_COUNT] {
    let mut enters = [-T::INFINITY; CHILD_COUNT];
    let mut leaves = [T::INFINITY; CHILD_COUNT];
    let mut signs = [T::one(); LANE_COUNT];
    signs[CHILD_COUNT..].fill(-T::one());
    let signs = L::load(&signs);
    let margin = signs.mul(L::splat(slabs.margin));
    for axis in 0..3 {
        let mut at = [T::zero(); LANE_COUNT];
        let faces = L::load(&node.bounds[axis]).mul(signs);
        // The margin after the difference: far from the world's origin it would vanish in the face's own rounding.
        let from_origin = faces.sub(L::splat(slabs.origin[axis])).sub(margin);
        from_origin.mul(L::splat(slabs.inverse[axis])).store(&mut at);
        for child in 0..CHILD_COUNT {
            let (a, b) = (at[child], at[child + CHILD_COUNT]);
            let (from, to) = if a < b { (a, b) } else { (b, a) };
            enters[child] = if from > enters[child] { from } else { enters[child] };
            leaves[child] = if to < leaves[child] { to } else { leaves[child] };
        }
    }
    for child in 0..CHILD_COUNT {
        let met = (enters[child] <= leaves[child]) & (leaves[child] >= T::zero());
        enters[child] = if met { enters[child] } else { T::of(f64::NAN) };
    }
    enters
}
