//! Over which vertices contacts spread their loads.

use crate::contact::outline::{Flat, Outline};
use crate::contact::point_pair::{Contact, SpreadNumber, SurfacePoint};
use crate::math::{Scalar, Vector3};
use crate::memory::{self, Room};
use crate::mesh::Topology;
use std::num::NonZeroU32;

/// The vertices that bear the loads of those contacts of a list that stand for many triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Spreads<T: Scalar> {
    spreads: Vec<Spread<T>>,
    vertices: Vec<(u32, T)>,
}

/// The vertices of one contact: of the colliding body those between the first two bounds, of the other those up to the third.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Spread<T: Scalar> {
    bounds: [u32; 3],
    gap: T,
}

/// The vertices that bear one end of a contact.
#[derive(Clone, Copy)]
pub(crate) enum WeightedVertices<'a, T: Scalar> {
    Point(&'a SurfacePoint<T>),
    /// With weights that sum to 1.
    Spread(&'a [(u32, T)]),
}

impl<T: Scalar> WeightedVertices<'_, T> {
    /// Calls `each(vertex, weight)`.
    #[inline(always)]
    pub(crate) fn for_each(&self, mut each: impl FnMut(u32, T)) {
        match self {
            Self::Point(point) => (0..3).for_each(|corner| each(point.vertices[corner], point.weights[corner])),
            Self::Spread(vertices) => vertices.iter().for_each(|&(vertex, weight)| each(vertex, weight)),
        }
    }
}

impl<T: Scalar> Spreads<T> {
    pub(crate) fn clear(&mut self) {
        self.spreads.clear();
        self.vertices.clear();
    }

    pub(crate) fn len(&self) -> usize {
        self.spreads.len()
    }

    /// Adds the vertices of a contact's two ends; gives their number.
    pub(crate) fn add(&mut self, ends: [&[(u32, T)]; 2], gap: T) -> SpreadNumber {
        let start = self.vertices.len();
        ends.iter().for_each(|end| memory::append(&mut self.vertices, end.iter().copied()));
        let bounds = [start, start + ends[0].len(), self.vertices.len()].map(|bound| bound as u32);
        self.spreads.room_for(1).push(Spread { bounds, gap });
        SpreadNumber(NonZeroU32::new(self.spreads.len() as u32))
    }

    /// Adds those of another list.
    pub(crate) fn append(&mut self, other: &Self) {
        let start = self.vertices.len() as u32;
        let moved = |spread: &Spread<T>| Spread { bounds: spread.bounds.map(|bound| bound + start), ..*spread };
        memory::append(&mut self.spreads, other.spreads.iter().map(moved));
        memory::append(&mut self.vertices, other.vertices.iter().copied());
    }

    fn spread(&self, contact: &Contact<T>) -> Option<&Spread<T>> {
        contact.spread.0.map(|number| &self.spreads[number.get() as usize - 1])
    }

    /// The vertices that bear a contact's two ends.
    #[inline(always)]
    pub(crate) fn vertices_of<'a>(&'a self, contact: &'a Contact<T>) -> [WeightedVertices<'a, T>; 2] {
        let Some(spread) = self.spread(contact) else {
            return [&contact.p1, &contact.p2].map(WeightedVertices::Point);
        };
        let [start, middle, end] = spread.bounds.map(|bound| bound as usize);
        [&self.vertices[start..middle], &self.vertices[middle..end]].map(WeightedVertices::Spread)
    }

    /// How far, at detection, the mean of the second end's vertices was from that of the first's, along the direction.
    #[inline(always)]
    pub(crate) fn gap(&self, contact: &Contact<T>) -> T {
        let between = || (contact.p2.position - contact.p1.position).dot(&contact.direction);
        self.spread(contact).map_or_else(between, |spread| spread.gap)
    }
}

/// Scratch memory for finding spreads.
#[derive(Clone, Debug, Default)]
pub(crate) struct SpreadWorkspace<T: Scalar> {
    pub(crate) ends: [EndWorkspace<T>; 2],
    pub(crate) marks: Marks,
    pub(crate) outline: Outline<T>,
}

/// The vertices that bear one end, with their weights, and their positions.
#[derive(Clone, Debug, Default)]
pub(crate) struct EndWorkspace<T: Scalar> {
    pub(crate) vertices: Vec<(u32, T)>,
    pub(crate) positions: Vec<Vector3<T>>,
    /// The same, seen along the push.
    pub(crate) flat: Vec<Flat<T>>,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Marks {
    /// By vertex: its number among the end's vertices, from 1 on; 0 where it is not among them.
    pub(crate) numbers: Vec<u32>,
    /// By triangle, whether it was met; and those met.
    pub(crate) is_met: Vec<bool>,
    pub(crate) met: Vec<u32>,
    /// Whether the marks may be wrong, because memory ran out in between.
    pub(crate) is_unfinished: bool,
}

impl Marks {
    /// Adds a triangle to those met, unless it is there.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn meet(&mut self, triangle: u32) {
        if !std::mem::replace(&mut self.is_met[triangle as usize], true) {
            self.met.room_for(1).push(triangle);
        }
    }

    /// Forgets those met.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn forget(&mut self) {
        self.met.iter().for_each(|&triangle| self.is_met[triangle as usize] = false);
        self.met.clear();
    }

    /// Makes marks for two meshes.
    pub(crate) fn start(&mut self, topologies: [&Topology; 2]) {
        if std::mem::replace(&mut self.is_unfinished, true) {
            self.numbers.clear();
            self.is_met.clear();
            self.met.clear();
        }
        for topology in topologies {
            let [vertices, triangles] = [topology.vertex_count(), topology.triangles().len()];
            if self.numbers.len() < vertices {
                memory::refill_with(&mut self.numbers, 0, vertices);
            }
            if self.is_met.len() < triangles {
                memory::refill_with(&mut self.is_met, false, triangles);
            }
        }
    }
}
