//! Bodies in which everything touches everything: garbage positions of a simulation gone wrong. Pairs of triangles that
//! touch are then quadratically many, each ray crosses a part of the whole surface, and no inside is left to tell.

use super::nearness::{Nearness, nearness};
use crate::math::Scalar;
use crate::mesh::Mesh;
use crate::octree::is_merged;

/// Fewer triangles are looked at pair by pair, whatever they do: of so few a tenth may touch in a body that is only crumpled.
const FEWEST_TRIANGLES: usize = 512;
/// A body is tangled where its triangles touch so many others each, on average, by a few pairs.
const TOUCHING: usize = 24;
/// Or so many where they are close, in boxes that overlap, to as many as this: the long triangles of garbage. Long
/// triangles in order are close to as many, but do not touch.
const TOUCHING_OF_CLOSE: usize = 6;
const CLOSE: usize = 96;
/// So many pairs are tried for each triangle, and so many parts of that to see whether the body is in order.
const PAIRS_TRIED: usize = 2;
const FIRST_PART: usize = 4;
/// A body whose triangles are each close to fewer is in order.
const FEWEST_CLOSE: usize = 12;

/// Fewer folds than one in so many vertices are those of a body that is only crumpled here and there.
const VERTICES_OF_A_FOLD: usize = 64;
/// Beside more folds than that, this many pairs of triangles are close to each other, for each triangle: spikes and rags.
const CLOSE_BESIDE_FOLDS: usize = 8;
/// By all pairs, so many touch for each triangle, two triangles to a pair: a large part of the surface lies on the rest.
/// Flattened to a plane, a torus has seven; slivers that cross have two.
const MOST_TOUCHING: usize = 3;

/// What a body has at most that is not tangled; where there is more, the search for it can end.
#[derive(Clone, Copy, Debug)]
pub(in crate::detection) struct Limits {
    /// Vertices around which the surface folds over: where it does around more than every fourth, it has no side.
    pub(in crate::detection) folds: usize,
    /// Pairs of triangles that touch.
    pub(in crate::detection) touching: usize,
    /// Pairs of triangles whose boxes overlap, beside many folds.
    close: usize,
    /// So many folds are few.
    few_folds: usize,
}

impl Limits {
    pub(in crate::detection) const NONE: Self =
        Self { folds: usize::MAX, touching: usize::MAX, close: usize::MAX, few_folds: usize::MAX };

    pub(in crate::detection) fn of<T: Scalar>(mesh: &Mesh<T>) -> Self {
        let topology = mesh.topology();
        let (triangles, vertices) = (topology.triangles().len(), topology.surface_vertices().len());
        if triangles < FEWEST_TRIANGLES {
            return Self::NONE;
        }
        let (touching, close) = (triangles * MOST_TOUCHING, triangles * CLOSE_BESIDE_FOLDS);
        Self { folds: vertices / 4, touching, close, few_folds: vertices / VERTICES_OF_A_FOLD }
    }

    /// How many pairs may be close in a body with so many folds.
    pub(in crate::detection) fn close(&self, folds: usize) -> usize {
        if folds > self.few_folds { self.close } else { usize::MAX }
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self::NONE
    }
}

/// Whether a body is tangled, by pairs of its triangles thrown together; it depends on nothing but the mesh and its numbering. A body in
/// order takes a pair for every two triangles, one that is all tangled few pairs in all.
pub(in crate::detection) fn is_tangled<T: Scalar>(mesh: &Mesh<T>) -> bool {
    let count = mesh.topology().triangles().len();
    if count < FEWEST_TRIANGLES {
        return false;
    }
    let most_tried = count * PAIRS_TRIED;
    let (mut close, mut touching) = (0, 0);
    let mut state = 0u64;
    for tried in 0..most_tried {
        if tried == most_tried / FIRST_PART && close * FIRST_PART < FEWEST_CLOSE * PAIRS_TRIED {
            return false;
        }
        // Every second, those between, and so on, and any other: Knuth's linear congruential generator.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let other = ((state >> 32) * count as u64) >> 32;
        let one = (2 * tried + 2 * tried / count) % count;
        let found = nearness(mesh, [one as u32, other as u32]);
        close += usize::from(found != Nearness::Apart);
        touching += usize::from(found == Nearness::Touching);
        let are_close = close >= CLOSE * PAIRS_TRIED && touching >= TOUCHING_OF_CLOSE * PAIRS_TRIED;
        if are_close || touching >= TOUCHING * PAIRS_TRIED {
            return true;
        }
    }
    false
}

/// Whether no triangle is left that casts a ray or is met by one.
pub(in crate::detection) fn is_collapsed<T: Scalar>(mesh: &Mesh<T>) -> bool {
    (0..mesh.topology().triangles().len() as u32).all(|triangle| is_merged(&mesh.corners(triangle)))
}

#[cfg(test)]
mod tests;
