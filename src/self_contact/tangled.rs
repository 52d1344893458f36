//! Bodies in which everything touches everything: garbage positions of a simulation gone wrong. The number of pairs of triangles
//! that touch then grows with the square of the triangles, and no inside is left to tell.
//!
//! A body is tangled by any of four signs: random pairs touch too often ([`is_tangled`]); it folds around too many vertices
//! ([`Limits::folds`]); too many pairs of triangles touch, or are close beside folds ([`Limits`]); or too many pairs of tiles are
//! near each other ([`MOST_PAIRS_OF_TILES`]). What chose the numbers: docs/architecture.md, under *Tuned constants*.

#[cfg(test)]
pub(crate) mod tests;

use crate::math::Scalar;
use crate::mesh::Mesh;
use crate::self_contact::fans::count_folds;
use crate::self_contact::near_triangles::is_merged;
use crate::self_contact::nearness::{Nearness, nearness};

/// A body with fewer triangles than this may be merely crumpled. It is tangled only by random pairs, if each of its triangles
/// touches at least one in [`OTHERS_OF_FEW`] of the others; of triangles thrown anywhere each touches more than one in four.
const FEWEST_TRIANGLES: usize = 512;
const OTHERS_OF_FEW: usize = 6;
/// A body with fewer triangles than this is never tangled: it is searched pair by pair.
const FEWEST_OF_ALL: usize = 128;
/// A body is tangled by random pairs if each triangle touches this many others on average.
const TOUCHING: usize = 24;
/// It is also tangled if each triangle touches only this many, but is close to [`CLOSE`] others: boxes overlap. Such are long
/// triangles all over one another. In a body in order, long triangles are close to as many others, but do not touch them.
const TOUCHING_OF_CLOSE: usize = 6;
const CLOSE: usize = 96;
/// How many random pairs are tried for each triangle.
const PAIRS_TRIED: usize = 2;
/// After one in this many of them a body in order is recognised: its triangles are close to fewer than [`FEWEST_CLOSE`] others.
const FIRST_PART: usize = 4;
const FEWEST_CLOSE: usize = 12;

/// For the rays of other bodies, a body is tangled if the square of the tiles on their way times the triangles that each touches
/// is this much, and if it folds over around many vertices. Parts that overlap reach thousands, but do not fold.
const SQUARE_OF_TILES_TIMES_TOUCHING: usize = 512;
/// How many random pairs are tried for each triangle then: more, since few touch where few triangles are large.
const PAIRS_TRIED_FOR_RAYS: usize = 16;
/// After one in this many of these pairs, or sooner if [`FEWEST_TOUCHING`] should touch by then, a body in order is recognised.
const FIRST_PART_FOR_RAYS: usize = 8;
/// At least this many pairs must touch: fewer may be chance in a body that passes through itself in one place.
const FEWEST_TOUCHING: usize = 12;

/// A body is tangled if it folds over around more than one vertex in this many: it has no side.
const VERTICES_WITHOUT_SIDE: usize = 4;
/// With folds around fewer than one vertex in this many it is merely crumpled here and there.
const VERTICES_OF_A_FOLD: usize = 64;
/// With more folds, a body is tangled by this many pairs of close triangles for each triangle: spikes and rags.
const CLOSE_BESIDE_FOLDS: usize = 8;
/// Of random pairs, one for each triangle, 16 are close on average at that limit. By this many it is exceeded for certain.
const FAR_TOO_MANY_CLOSE: usize = 48;
/// A body is tangled by this many touching pairs for each triangle: a large part of the surface lies on the rest.
const MOST_TOUCHING: usize = 3;
/// A body is tangled by this many pairs of near tiles for each triangle: their list would take more memory than all else.
pub(crate) const MOST_PAIRS_OF_TILES: usize = 64;

/// What a body that is not tangled has at most. A search that finds more can stop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// Vertices around which the surface folds over.
    folds: usize,
    /// Pairs of triangles that touch.
    pub(crate) touching: usize,
    /// Pairs of triangles whose boxes overlap, beside many folds.
    close: usize,
    /// Up to this many folds are few.
    few_folds: usize,
}

impl Limits {
    pub(crate) const NONE: Self =
        Self { folds: usize::MAX, touching: usize::MAX, close: usize::MAX, few_folds: usize::MAX };

    pub(crate) fn of<T: Scalar>(mesh: &Mesh<T>) -> Self {
        let topology = mesh.topology();
        let (triangles, vertices) = (topology.triangles().len(), topology.surface_vertices().len());
        if triangles < FEWEST_TRIANGLES {
            return Self::NONE;
        }
        let (touching, close) = (triangles * MOST_TOUCHING, triangles * CLOSE_BESIDE_FOLDS);
        Self { folds: vertices / VERTICES_WITHOUT_SIDE, touching, close, few_folds: vertices / VERTICES_OF_A_FOLD }
    }

    /// Whether a body with this many folds is known to be tangled before its close pairs are counted.
    pub(crate) fn are_exceeded<T: Scalar>(&self, mesh: &Mesh<T>, folds: usize) -> bool {
        let are_too_close = |_, close, _| (close >= FAR_TOO_MANY_CLOSE).then_some(true);
        folds > self.folds || folds > self.few_folds && judge_by_random_pairs(mesh, 1, are_too_close)
    }

    /// How many pairs may be close in a body with this many folds.
    pub(crate) fn close(&self, folds: usize) -> usize {
        if folds > self.few_folds { self.close } else { usize::MAX }
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self::NONE
    }
}

/// Whether a body is tangled, judged by random pairs of its triangles. A body in order takes one pair for every two triangles,
/// a wholly tangled one few pairs in all.
pub(crate) fn is_tangled<T: Scalar>(mesh: &Mesh<T>) -> bool {
    let count = mesh.topology().triangles().len();
    let first = count * PAIRS_TRIED / FIRST_PART;
    let is_small = count < FEWEST_TRIANGLES;
    let most = PAIRS_TRIED * if is_small { count / OTHERS_OF_FEW } else { TOUCHING };
    count >= FEWEST_OF_ALL
        && judge_by_random_pairs(mesh, PAIRS_TRIED, |tried, close, touching| {
            let are_close = close >= CLOSE * PAIRS_TRIED && touching >= TOUCHING_OF_CLOSE * PAIRS_TRIED;
            let is_in_order = tried == first && close * FIRST_PART < FEWEST_CLOSE * PAIRS_TRIED;
            if are_close && !is_small || touching >= most { Some(true) } else { is_in_order.then_some(false) }
        })
}

/// Whether a body is tangled for rays that have this many of its tiles on their way, judged by random pairs of its triangles. A
/// body in order is known after the first part of the pairs, if less than half as many touch as would be enough.
pub(crate) fn is_tangled_for_rays<T: Scalar>(mesh: &Mesh<T>, tiles: usize) -> bool {
    let enough = (SQUARE_OF_TILES_TIMES_TOUCHING * PAIRS_TRIED_FOR_RAYS / (tiles * tiles)).max(FEWEST_TOUCHING);
    let part = (enough / FEWEST_TOUCHING).max(FIRST_PART_FOR_RAYS);
    let first = mesh.topology().triangles().len() * PAIRS_TRIED_FOR_RAYS / part;
    let touch_often = judge_by_random_pairs(mesh, PAIRS_TRIED_FOR_RAYS, |tried, _, touching| {
        let is_in_order = tried == first && touching * part * 2 < enough;
        if touching >= enough { Some(true) } else { is_in_order.then_some(false) }
    });
    touch_often && count_folds(mesh) * VERTICES_OF_A_FOLD > mesh.topology().surface_vertices().len()
}

/// Tries random pairs of a body's triangles, `for_each` of them for each triangle, until the judge can tell. It is given how many
/// were tried, are close, and touch. The pairs depend on the mesh alone, and not on its numbering.
fn judge_by_random_pairs<T: Scalar>(
    mesh: &Mesh<T>,
    for_each: usize,
    judge: impl Fn(usize, usize, usize) -> Option<bool>,
) -> bool {
    let (count, triangles) = (mesh.topology().triangles().len(), mesh.triangles_in_space());
    let (mut close, mut touching) = (0, 0);
    let mut state = 0u64;
    for tried in 0..count * for_each {
        if let Some(is_tangled) = judge(tried, close, touching) {
            return is_tangled;
        }
        // The first triangle goes through all of them, every second one first; the other is random, by Knuth's linear
        // congruential generator.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let other = ((state >> 32) * count as u64) >> 32;
        let one = (2 * tried + 2 * tried / count) % count;
        let found = nearness(mesh, [triangles[one], triangles[other as usize]]);
        close += usize::from(found != Nearness::Apart);
        touching += usize::from(found == Nearness::Touching);
    }
    judge(count * for_each, close, touching).unwrap_or(false)
}

/// Whether no triangle is left that casts a ray or is met by one.
pub(crate) fn is_collapsed<T: Scalar>(mesh: &Mesh<T>) -> bool {
    (0..mesh.topology().triangles().len() as u32).all(|triangle| is_merged(&mesh.corners(triangle)))
}
