use super::dispatch::Kernel;
use super::{CHILD_COUNT, Child, Node, TILE_SIZE, Tile, Wide};
use crate::math::{Aabb, Scalar};
use crate::octree::slabs::Slabs;
use crate::ray::{PreparedRay, Ray};

/// Nodes that can wait at once: seven for each level but the last, and 2³² tiles have no more than eleven levels.
pub(super) const STACK_SIZE: usize = 80;

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

impl<T: Scalar, V: FnMut(u32) -> T> Kernel for Walk<'_, T, V> {
    #[inline(always)]
    fn run(&mut self) {
        let mut stack = [0u32; STACK_SIZE];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let node = &self.cells.nodes[stack[waiting] as usize];
            let entries = entries(&self.slabs, node);
            let mut met = at_most(&entries, self.t_max);
            while met != 0 {
                let place = met.trailing_zeros() as usize;
                met &= met - 1;
                match node.children[place] {
                    Child::Node(child) => {
                        stack[waiting] = child;
                        waiting += 1;
                    }
                    // A hit found since may have shortened the ray.
                    Child::Tile(tile) if entries[place] <= self.t_max => {
                        offer(&self.cells.tiles[tile as usize], self.prepared, &mut self.t_max, self.visitor);
                    }
                    Child::Tile(_) | Child::None => {}
                }
            }
        }
    }
}

/// Offers the triangles of a tile that the ray may meet; `t_max` becomes what `visitor` last returned.
#[inline(always)]
pub(super) fn offer<T: Scalar>(
    tile: &Tile<T>,
    prepared: &PreparedRay<T>,
    t_max: &mut T,
    visitor: &mut impl FnMut(u32) -> T,
) {
    match prepared {
        PreparedRay::Watertight(ray) => {
            let projected = ray.project_all(&tile.positions);
            let mut candidates = around_ray(tile, &projected);
            while candidates != 0 {
                let place = candidates.trailing_zeros() as usize;
                candidates &= candidates - 1;
                if may_meet(&tile.corners[place], &projected) {
                    *t_max = visitor(tile.triangles[place]);
                }
            }
        }
        PreparedRay::MollerTrumbore(_) => {
            for &triangle in &tile.triangles[..tile.triangle_count as usize] {
                *t_max = visitor(triangle);
            }
        }
    }
}

/// Where the ray enters each child's box; NaN, which no `t_max` reaches, for boxes that it does not meet ahead of its
/// origin.
#[inline(always)]
fn entries<T: Scalar>(slabs: &Slabs<T>, node: &Node<T>) -> [T; CHILD_COUNT] {
    let mut enters = [-T::INFINITY; CHILD_COUNT];
    let mut leaves = [T::INFINITY; CHILD_COUNT];
    for axis in 0..3 {
        let (lower, upper) = (&node.lower[axis], &node.upper[axis]);
        let mut at_lower = [T::zero(); CHILD_COUNT];
        let mut at_upper = [T::zero(); CHILD_COUNT];
        for child in 0..CHILD_COUNT {
            at_lower[child] = slabs.at_lower(axis, lower[child]);
            at_upper[child] = slabs.at_upper(axis, upper[child]);
        }
        for child in 0..CHILD_COUNT {
            let (a, b) = (at_lower[child], at_upper[child]);
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

/// Bit i: entry i is not beyond `t_max`.
#[inline(always)]
fn at_most<T: Scalar>(entries: &[T; CHILD_COUNT], t_max: T) -> u32 {
    let mut mask = 0;
    for (place, entry) in entries.iter().enumerate() {
        mask |= u32::from(*entry <= t_max) << place;
    }
    mask
}

/// Bit i: not all projected corners of triangle i lie strictly on one side of an axis through the ray. The edge
/// functions of [`ShearedRay::intersect`], exact in sign for the same projections, refuse the others too.
#[inline(always)]
fn around_ray<T: Scalar>(tile: &Tile<T>, [x, y]: &[[T; TILE_SIZE]; 2]) -> u32 {
    let zero = T::zero();
    let (mut right, mut left, mut above, mut below) = (0u16, 0u16, 0u16, 0u16);
    for place in 0..TILE_SIZE {
        right |= u16::from(x[place] > zero) << place;
        left |= u16::from(x[place] < zero) << place;
        above |= u16::from(y[place] > zero) << place;
        below |= u16::from(y[place] < zero) << place;
    }
    let mut mask = 0;
    for triangle in 0..TILE_SIZE {
        let all = tile.vertex_masks[triangle];
        let around = (all & !right != 0) & (all & !left != 0) & (all & !above != 0) & (all & !below != 0);
        mask |= u32::from(around) << triangle;
    }
    mask
}

/// Whether no two edge functions have opposite signs. A rounded edge function that is not zero has the exact one's
/// sign, so no triangle that [`ShearedRay::intersect`] accepts is left out.
#[inline(always)]
fn may_meet<T: Scalar>(corners: &[u8; 3], [x, y]: &[[T; TILE_SIZE]; 2]) -> bool {
    let [a, b, c] = corners.map(|place| place as usize % TILE_SIZE);
    let u = x[c] * y[b] - y[c] * x[b];
    let v = x[a] * y[c] - y[a] * x[c];
    let w = x[b] * y[a] - y[b] * x[a];
    let zero = T::zero();
    let any_right = (u > zero) | (v > zero) | (w > zero);
    let any_left = (u < zero) | (v < zero) | (w < zero);
    !(any_right & any_left)
}
