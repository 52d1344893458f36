use crate::bvh::rays::slabs::Slabs;
use crate::bvh::{Bvh, CHILD_COUNT, Node};
use crate::math::Scalar;
use crate::mesh::Mesh;
use crate::simd::{Kernel, LANE_COUNT, Lanes, lanes_of};
use crate::triangle::{PreparedRay, Ray};

/// 2³² tiles have no more than so many levels of nodes.
pub(crate) const LEVEL_COUNT: usize = 8;

/// Nodes that can wait at once: fifteen for each level but the last; and room behind them that may be overwritten.
pub(crate) const STACK_SIZE: usize = 15 * LEVEL_COUNT + LANE_COUNT;

/// One ray's way through the cells.
pub(crate) struct Walk<'a, T: Scalar, V> {
    cells: &'a Bvh<T>,
    mesh: &'a Mesh<T>,
    slabs: Slabs<T>,
    prepared: &'a PreparedRay<T>,
    t_max: T,
    visitor: &'a mut V,
}

impl<'a, T: Scalar, V: FnMut(u32) -> T> Walk<'a, T, V> {
    pub(crate) fn new(
        cells: &'a Bvh<T>,
        ray: &Ray<T>,
        prepared: &'a PreparedRay<T>,
        mesh: &'a Mesh<T>,
        visitor: &'a mut V,
    ) -> Self {
        Self { cells, mesh, slabs: Slabs::new(ray, mesh.aabb()), prepared, t_max: ray.t_max, visitor }
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
            let mut room = None;
            let node = self.cells.node(stack[waiting] as usize, &mut room);
            let entries = entries::<T, L>(&self.slabs, node);
            for (place, &entry) in entries.iter().enumerate().take(node.count as usize) {
                // NaN is left out. A hit found since may have shortened the ray.
                if entry <= self.t_max {
                    let child = node.first + place as u32;
                    if node.is_leaf {
                        self.offer::<L>(child as usize);
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
    fn offer<L: Lanes<T>>(&mut self, index: usize) {
        let tile = &self.cells.tiles[index];
        let mut room = [[T::zero(); LANE_COUNT]; 3];
        let met = match self.prepared {
            PreparedRay::Watertight(ray) => {
                let positions = self.cells.positions_of::<L>(index, self.mesh, &mut room);
                ray.may_meet::<L>(positions, &tile.corners).0 & tile.present
            }
            PreparedRay::MollerTrumbore(_) => tile.present,
        };
        for place in lanes_of(met) {
            self.t_max = (self.visitor)(tile.triangles[place]);
        }
    }
}

/// Where the ray enters each child's box; NaN, which no `t_max` reaches, for boxes that it does not meet ahead of its
/// origin.
#[cfg_attr(not(debug_assertions), inline(always))]
fn entries<T: Scalar, L: Lanes<T>>(slabs: &Slabs<T>, node: &Node<T>) -> [T; CHILD_COUNT] {
    let margin = L::splat(slabs.margin);
    let (mut enters, mut leaves) = (L::splat(-T::INFINITY), L::splat(T::INFINITY));
    for axis in 0..3 {
        let (origin, inverse) = (L::splat(slabs.origin[axis]), L::splat(slabs.inverse[axis]));
        // The margin after the difference: far from the world's origin it would vanish in the face's own rounding.
        let at_lower = L::load(&node.lower[axis]).sub(origin).sub(margin).mul(inverse);
        let at_upper = L::load(&node.upper[axis]).sub(origin).add(margin).mul(inverse);
        enters = at_lower.smaller(at_upper).larger(enters);
        leaves = at_upper.larger(at_lower).smaller(leaves);
    }
    let met = enters.is_at_most(leaves) & L::splat(T::zero()).is_at_most(leaves);
    let mut entries = [T::zero(); CHILD_COUNT];
    L::select(met, enters, L::splat(T::of(f64::NAN))).store(&mut entries);
    entries
}
