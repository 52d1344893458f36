//! Where contacts took hold of the other body: what lets bodies at rest stay there instead of creeping.

use super::loads::Key;
use super::twist::V3;
use crate::math::direction;
use crate::memory::{self, Room};
use nalgebra::Matrix3;
use std::cmp::Ordering;
use std::ops::Range;

/// A point of a triangle's plane, or above it, as seen from the corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AnchorPoint {
    pub(crate) vertices: [u32; 3],
    pub(crate) weights: [f64; 3],
    /// Above the triangle's plane, along its normal, in m.
    pub(crate) height: f64,
}

impl AnchorPoint {
    /// No point: of a spring whose vertices have weights that change, so that only its stretch is known.
    pub(super) const NOWHERE: Self = Self { vertices: [0; 3], weights: [0.0; 3], height: 0.0 };

    /// Its position, given the positions of the surface's vertices.
    pub(super) fn point(&self, vertex: impl Fn(u32) -> V3) -> V3 {
        let mut sum = V3::zeros();
        for k in 0..3 {
            if self.weights[k] != 0.0 {
                sum += vertex(self.vertices[k]) * self.weights[k];
            }
        }
        if self.height != 0.0 {
            let [a, b, c] = self.vertices.map(&vertex);
            sum += direction(&(b - a).cross(&(c - a))).unwrap_or_default() * self.height;
        }
        sum
    }
}

/// What a contact holds on to.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Hold {
    Material(AnchorPoint),
    /// The stretch of the spring if it starts from [nowhere](AnchorPoint::NOWHERE).
    Space(V3),
}

/// A material point of the second body: where the contact's first point was, so deep inside where the two overlap deeply.
/// Corners of one of the body's triangles give it, so it moves, turns and stretches with the body, and nothing adds up from
/// step to step. A contact finds its own again by the triangle from which it starts, and among several there by the nearest
/// point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Anchor {
    pub(crate) key: Key,
    /// Of the first body, or its vertex over a half-space.
    pub(crate) triangle: u32,
    pub(crate) from: AnchorPoint,
    pub(crate) hold: Hold,
}

/// A contact of this step that can rub.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pending {
    pub(super) key: Key,
    triangle: u32,
    pub(super) from: AnchorPoint,
    /// The corners of the triangle that it is to hold on to; `None` over a half-space.
    pub(super) on: Option<[u32; 3]>,
    /// Its anchor of the step before, by index among those kept.
    before: Option<usize>,
}

#[derive(Debug, Default)]
pub(crate) struct Anchors {
    /// Of the step before, by pair and triangle.
    kept: Vec<Anchor>,
    /// Their triangles, apart, because a search in these reads less memory.
    triangles: Vec<u32>,
    /// The pair that was looked for last, and the range of its anchors.
    searched: Option<(Key, Range<usize>)>,
    /// Of this step.
    pub(super) pending: Vec<Pending>,
    next: Vec<Anchor>,
    /// Scratch memory for sorting: ranges of anchors of one pair, and the triangles of one pair with their anchors.
    runs: Vec<(Key, u32, u32)>,
    order: Vec<u64>,
    /// Scratch memory: of each pending contact its anchor of the step before.
    befores: Vec<Option<Anchor>>,
}

impl Anchors {
    /// Those kept of one direction of a pair.
    pub(crate) fn of(&self, key: Key) -> &[Anchor] {
        &self.kept[self.range(key)]
    }

    fn range(&self, key: Key) -> Range<usize> {
        let start = self.kept.partition_point(|anchor| anchor.key < key);
        start..start + self.kept[start..].partition_point(|anchor| anchor.key == key)
    }

    /// Keeps these instead of some. Contacts of this step go on to have the anchors that they had found.
    pub(crate) fn replace(&mut self, is_gone: impl Fn(&Key) -> bool, anchors: &[Anchor]) {
        self.make_room(self.kept.len() + anchors.len());
        let Self { kept, pending, befores, .. } = self;
        let before = |pending: &Pending| pending.before.and_then(|index| kept.get(index)).copied();
        memory::refill(befores, pending.iter().map(before));
        kept.retain(|anchor| !is_gone(&anchor.key));
        kept.extend_from_slice(anchors);
        self.sort();
        let Self { kept, pending, befores, .. } = self;
        for (pending, before) in pending.iter_mut().zip(&*befores) {
            pending.before = before.and_then(|before| kept.binary_search_by(|kept| in_order(kept, &before)).ok());
        }
    }

    pub(super) fn start_step(&mut self) {
        self.pending.clear();
    }

    pub(super) fn forget(&mut self, is_gone: impl Fn(&Key) -> bool) {
        self.kept.retain(|anchor| !is_gone(&anchor.key));
        self.list_triangles();
    }

    /// Adds a contact of this step; gives its index, and its anchor of the step before if it had one.
    pub(super) fn find(
        &mut self,
        key: Key,
        triangle: u32,
        from: AnchorPoint,
        on: Option<[u32; 3]>,
    ) -> (usize, Option<Anchor>) {
        // Contacts of one pair mostly come one after the other.
        let of_pair = match &self.searched {
            Some((last, range)) if *last == key => range.clone(),
            _ => self.range(key),
        };
        let triangles = &self.triangles[of_pair.clone()];
        let start = of_pair.start + triangles.partition_point(|&other| other < triangle);
        let end = start + self.triangles[start..of_pair.end].partition_point(|&other| other == triangle);
        let before = nearest(&self.kept[start..end], &from.weights).map(|nearest| start + nearest);
        self.searched = Some((key, of_pair));
        self.pending.room_for(1).push(Pending { key, triangle, from, on, before });
        (self.pending.len() - 1, before.map(|before| self.kept[before]))
    }

    /// Whether the contact had no anchor in the step before.
    pub(super) fn is_new(&self, index: usize) -> bool {
        self.pending[index].before.is_none()
    }

    /// Keeps the anchor of the step before, to the bit, so that rounding does not add up to a motion. False where there is none.
    pub(super) fn keep(&mut self, index: usize) -> bool {
        let Some(before) = self.pending[index].before else { return false };
        self.next.room_for(1).push(self.kept[before]);
        true
    }

    /// From now on the contact holds on to this.
    pub(super) fn set(&mut self, index: usize, hold: Hold) {
        let Pending { key, triangle, from, .. } = self.pending[index];
        self.next.room_for(1).push(Anchor { key, triangle, from, hold });
    }

    /// To be called before a step's contacts are given their anchors: from then on nothing can fail.
    pub(super) fn prepare_finish(&mut self) {
        self.next.clear();
        self.make_room(self.pending.len());
    }

    /// So that so many anchors can be sorted.
    fn make_room(&mut self, count: usize) {
        let Self { kept, next, runs, order, triangles, .. } = self;
        for list in [kept, next] {
            list.room_for(count.saturating_sub(list.len()));
        }
        runs.room_for(count.saturating_sub(runs.len()));
        order.room_for(count.saturating_sub(order.len()));
        triangles.room_for(count.saturating_sub(triangles.len()));
    }

    pub(super) fn finish_step(&mut self) {
        std::mem::swap(&mut self.kept, &mut self.next);
        self.pending.clear();
        self.sort();
    }

    /// Anchors of a pair come in few runs. So the runs are sorted, then the triangles of each pair, and each anchor moves once.
    fn sort(&mut self) {
        let Self { kept, next, runs, order, .. } = self;
        runs.clear();
        let mut start = 0;
        for run in kept.chunk_by(|one, next| one.key == next.key) {
            let end = start + run.len() as u32;
            runs.room_for(1).push((run[0].key, start, end));
            start = end;
        }
        runs.sort_unstable();
        next.clear();
        next.room_for(kept.len());
        for of_key in runs.chunk_by(|one, next| one.0 == next.0) {
            order.clear();
            for index in of_key.iter().flat_map(|&(_, start, end)| start..end) {
                order.room_for(1).push(u64::from(kept[index as usize].triangle) << 32 | u64::from(index));
            }
            order.sort_unstable();
            next.extend(order.iter().map(|&index| kept[index as u32 as usize]));
        }
        for alike in next.chunk_by_mut(|a, b| (a.triangle, a.key) == (b.triangle, b.key)) {
            alike.sort_unstable_by(in_order);
        }
        std::mem::swap(kept, next);
        next.clear();
        self.list_triangles();
    }

    fn list_triangles(&mut self) {
        memory::refill(&mut self.triangles, self.kept.iter().map(|anchor| anchor.triangle));
        self.searched = None;
    }
}

/// The nearest of the anchors of one triangle, and the first of several. They come in the order of their first weights, so those
/// before and behind the point are looked at until by these alone they are farther. Mostly the first one is where the contact is.
fn nearest(anchors: &[Anchor], weights: &[f64; 3]) -> Option<usize> {
    let place = anchors.partition_point(|anchor| compare(&anchor.from.weights, weights).is_lt());
    let mut nearest: Option<(f64, usize)> = None;
    let mut look = |index: usize| {
        let apart = [0, 1, 2].map(|k| (anchors[index].from.weights[k] - weights[k]).powi(2));
        let found = (apart.iter().sum(), index);
        let best = *nearest.insert(nearest.filter(|nearest| *nearest <= found).unwrap_or(found));
        best.0 > 0.0 && apart[0] <= best.0
    };
    (place..anchors.len()).all(&mut look);
    (0..place).rev().all(&mut look);
    nearest.map(|(_, index)| index)
}

fn compare(a: &[f64; 3], b: &[f64; 3]) -> Ordering {
    a.iter().zip(b).fold(Ordering::Equal, |order, (a, b)| order.then(a.total_cmp(b)))
}

/// Of several anchors that are equally near, [`Anchors::find`] takes the first. So the order must not depend on other pairs.
fn in_order(a: &Anchor, b: &Anchor) -> Ordering {
    let order = |anchor: &Anchor| (anchor.key, anchor.triangle);
    let hold = |anchor: &Anchor| match anchor.hold {
        Hold::Material(corners) => (corners.vertices, corners.weights),
        Hold::Space(point) => ([0; 3], point.into()),
    };
    let ((vertices, weights), (other_vertices, other_weights)) = (hold(a), hold(b));
    order(a)
        .cmp(&order(b))
        .then_with(|| compare(&a.from.weights, &b.from.weights))
        .then_with(|| vertices.cmp(&other_vertices))
        .then_with(|| compare(&weights, &other_weights))
}

/// A point as seen from a triangle. `vertex`: the positions of the surface's vertices.
pub(super) fn seen_from(vertices: &[u32; 3], point: &V3, vertex: impl Fn(u32) -> V3) -> AnchorPoint {
    let [a, b, c] = vertices.map(vertex);
    let (u, v) = (b - a, c - a);
    let axes = direction(&u.cross(&v)).and_then(|normal| Matrix3::from_columns(&[u, v, normal]).try_inverse());
    let [second, third, height] = axes.map_or([0.0; 3], |axes| (axes * (point - a)).into());
    AnchorPoint { vertices: *vertices, weights: [1.0 - second - third, second, third], height }
}

/// Sorted by vertex number, because a contact that starts from a vertex has that one first.
pub(super) fn sorted(vertices: [u32; 3], weights: [f64; 3]) -> AnchorPoint {
    let mut order = [0, 1, 2];
    order.sort_unstable_by_key(|&k: &usize| vertices[k]);
    AnchorPoint { vertices: order.map(|k| vertices[k]), weights: order.map(|k| weights[k]), height: 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::loads::Surface;

    fn anchor(weights: [f64; 3]) -> Anchor {
        let from = AnchorPoint { vertices: [0, 1, 2], weights, height: 0.0 };
        Anchor { key: (0, Surface::Body(1)), triangle: 0, from, hold: Hold::Space(V3::zeros()) }
    }

    /// All pairs of points of a grid, as halved triangles have them, and points beside them. The judge looks at every anchor.
    #[test]
    fn the_nearest_anchor_is_that_of_all() {
        let point = |i: u32, j: u32, aside: f64| {
            let [b, c] = [i, j].map(|k| f64::from(k) / 8.0 + aside);
            [1.0 - b - c, b, c]
        };
        let grid: Vec<[f64; 3]> = (0..9).flat_map(|i| (0..9 - i).map(move |j| point(i, j, 0.0))).collect();
        for (left_out, aside) in (1..9).flat_map(|left_out| [0.0, 0.03, 0.0625].map(|aside| (left_out, aside))) {
            let mut anchors: Vec<Anchor> = grid
                .iter()
                .enumerate()
                .filter(|(k, _)| k % left_out != 1)
                .map(|(_, &weights)| anchor(weights))
                .collect();
            // Some twice: the first of them is to be found.
            anchors.extend_from_within(..anchors.len() / 3);
            anchors.sort_by(in_order);
            for i in 0..9 {
                let weights = point(i, 3 * i % (9 - i), aside);
                let distance = |anchor: &Anchor| -> f64 {
                    anchor.from.weights.iter().zip(weights).map(|(a, b)| (a - b).powi(2)).sum()
                };
                let judge = (0..anchors.len()).min_by(|&a, &b| distance(&anchors[a]).total_cmp(&distance(&anchors[b])));
                assert_eq!(nearest(&anchors, &weights), judge, "{left_out}, {aside}, {i}");
            }
        }
        assert_eq!(nearest(&[], &[0.2, 0.3, 0.5]), None);
    }
}
