//! Where contacts took hold of the other body: what lets bodies at rest stay there instead of creeping.

use super::loads::Key;
use super::twist::V3;
use crate::math::direction;
use crate::memory::Room;
use nalgebra::Matrix3;
use std::cmp::Ordering;

/// A point of a triangle, or beside or above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corners {
    pub(super) vertices: [u32; 3],
    pub(super) weights: [f64; 3],
    /// Above the triangle's plane, along its normal, in m.
    pub(super) height: f64,
}

impl Corners {
    /// Where it is, with the surface's vertices.
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
pub(super) enum Hold {
    Material(Corners),
    Space(V3),
}

/// An anchor is a material point of the second body, where the contact's first point was, so deep inside where the two overlap
/// deeply. It is given by one of the body's triangles, so it moves, turns and stretches with the body and nothing adds up from
/// step to step. A contact finds its own again by the triangle from which it starts, and
/// among several there by the nearest point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Anchor {
    pub(super) key: Key,
    /// Of the first body, or its vertex over a half-space.
    pub(super) triangle: u32,
    pub(super) from: Corners,
    pub(super) hold: Hold,
    /// Among those kept, what it was found as.
    found: Option<usize>,
}

impl Anchor {
    pub(super) fn kept(key: Key, triangle: u32, from: Corners, hold: Hold) -> Self {
        Self { key, triangle, from, hold, found: None }
    }
}

#[derive(Debug, Default)]
pub(super) struct Anchors {
    /// Of the step before, by pair and triangle.
    kept: Vec<Anchor>,
    /// Of this step.
    pub(super) pending: Vec<Anchor>,
    next: Vec<Anchor>,
}

impl Anchors {
    /// Those kept of one direction of a pair.
    pub(super) fn of(&self, key: Key) -> &[Anchor] {
        let start = self.kept.partition_point(|anchor| anchor.key < key);
        let count = self.kept[start..].partition_point(|anchor| anchor.key == key);
        &self.kept[start..start + count]
    }

    /// Keeps these in place of some. Those that this step has found are found where they are then.
    pub(super) fn replace(&mut self, is_gone: impl Fn(&Key) -> bool, anchors: &[Anchor]) {
        let Self { kept, pending, next } = self;
        next.clear();
        next.room_for(pending.len());
        kept.room_for(anchors.len());
        let found = |anchor: &Anchor| anchor.found.and_then(|found| kept.get(found)).copied().unwrap_or(*anchor);
        next.extend(pending.iter().map(found));
        kept.retain(|anchor| !is_gone(&anchor.key));
        kept.extend_from_slice(anchors);
        self.sort();
        let Self { kept, pending, next } = self;
        for (anchor, found) in pending.iter_mut().zip(&*next).filter(|(anchor, _)| anchor.found.is_some()) {
            anchor.found = kept.binary_search_by(|kept| in_order(kept, found)).ok();
        }
        next.clear();
    }

    pub(super) fn start_step(&mut self) {
        self.pending.clear();
    }

    pub(super) fn forget(&mut self, is_gone: impl Fn(&Key) -> bool) {
        self.kept.retain(|anchor| !is_gone(&anchor.key));
    }

    /// Adds an anchor of this step; gives its place, and where the contact held on in the step before.
    pub(super) fn find(&mut self, key: Key, triangle: u32, from: Corners, hold: Hold) -> (usize, Option<Anchor>) {
        let place = (key, triangle);
        let start = self.kept.partition_point(|anchor| (anchor.key, anchor.triangle) < place);
        let distance =
            |anchor: &Anchor| -> f64 { (0..3).map(|k| (anchor.from.weights[k] - from.weights[k]).powi(2)).sum() };
        let mut nearest: Option<(f64, usize)> = None;
        for (offset, anchor) in self.kept[start..].iter().enumerate() {
            if (anchor.key, anchor.triangle) != place {
                break;
            }
            let far = distance(anchor);
            if nearest.is_none_or(|(least, _)| far < least) {
                nearest = Some((far, start + offset));
            }
        }
        let found = nearest.map(|(_, place)| place);
        self.pending.room_for(1).push(Anchor { key, triangle, from, hold, found });
        (self.pending.len() - 1, found.map(|place| self.kept[place]))
    }

    /// Whether the contact did not hold on in the step before.
    pub(super) fn is_new(&self, place: usize) -> bool {
        self.pending[place].found.is_none()
    }

    /// The anchor stays where it is: to the bit, so that rounding does not add up to a way. False for a new one.
    pub(super) fn keep(&mut self, place: usize) -> bool {
        let Some(found) = self.pending[place].found else { return false };
        self.next.room_for(1).push(self.kept[found]);
        true
    }

    /// From now on the contact holds on to this.
    pub(super) fn set(&mut self, place: usize, hold: Hold) {
        let anchor = Anchor { hold, ..self.pending[place] };
        self.next.room_for(1).push(anchor);
    }

    pub(super) fn finish_step(&mut self) {
        std::mem::swap(&mut self.kept, &mut self.next);
        self.next.clear();
        self.pending.clear();
        self.sort();
    }

    fn sort(&mut self) {
        // Mostly they come so.
        if !self.kept.is_sorted_by(|a, b| in_order(a, b).is_le()) {
            self.kept.sort_unstable_by(in_order);
        }
    }
}

/// Of several as near as each other the first is taken, which must not depend on other pairs.
fn in_order(a: &Anchor, b: &Anchor) -> Ordering {
    let order = |anchor: &Anchor| (anchor.key, anchor.triangle);
    let held = |anchor: &Anchor| match anchor.hold {
        Hold::Material(corners) => (corners.vertices, corners.weights),
        Hold::Space(point) => ([0; 3], point.into()),
    };
    let compare =
        |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).fold(Ordering::Equal, |order, (a, b)| order.then(a.total_cmp(b)));
    let ((vertices, weights), (other_vertices, other_weights)) = (held(a), held(b));
    order(a)
        .cmp(&order(b))
        .then_with(|| compare(&a.from.weights, &b.from.weights))
        .then_with(|| vertices.cmp(&other_vertices))
        .then_with(|| compare(&weights, &other_weights))
}

/// A point as seen from a triangle. `vertex`: where the surface's are.
pub(super) fn seen_from(vertices: &[u32; 3], point: &V3, vertex: impl Fn(u32) -> V3) -> Corners {
    let [a, b, c] = vertices.map(vertex);
    let (u, v) = (b - a, c - a);
    let axes = direction(&u.cross(&v)).and_then(|normal| Matrix3::from_columns(&[u, v, normal]).try_inverse());
    let [second, third, height] = axes.map_or([0.0; 3], |axes| (axes * (point - a)).into());
    Corners { vertices: *vertices, weights: [1.0 - second - third, second, third], height }
}

/// By rising vertex number: a contact that starts from a vertex has that one first.
pub(super) fn sorted(vertices: [u32; 3], weights: [f64; 3]) -> Corners {
    let mut order = [0, 1, 2];
    order.sort_unstable_by_key(|&k: &usize| vertices[k]);
    Corners { vertices: order.map(|k| vertices[k]), weights: order.map(|k| weights[k]), height: 0.0 }
}
