//! Over which vertices contacts spread their loads.

use crate::contact::point_pair::{Contact, SpreadPlace, SurfacePoint};
use crate::math::{Scalar, Vector3};
use crate::memory::{self, Room};
use crate::mesh::Topology;
use std::num::NonZeroU32;

/// The vertices that bear the loads of those contacts of a list that stand for many triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Spreads<T: Scalar> {
    loads: Vec<Load<T>>,
    bearings: Vec<(u32, T)>,
}

/// The bearings of one contact: of the colliding body between the first two of these places, of the other up to the last.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Load<T: Scalar> {
    places: [u32; 3],
    gap: T,
}

/// What one end of a contact bears on.
#[derive(Clone, Copy)]
pub(crate) enum Bearings<'a, T: Scalar> {
    Point(&'a SurfacePoint<T>),
    /// Vertices and their weights, which sum to 1.
    Spread(&'a [(u32, T)]),
}

impl<T: Scalar> Bearings<'_, T> {
    /// Vertices and their weights.
    #[inline(always)]
    pub(crate) fn for_each(&self, mut each: impl FnMut(u32, T)) {
        match self {
            Self::Point(point) => (0..3).for_each(|corner| each(point.vertices[corner], point.weights[corner])),
            Self::Spread(bearings) => bearings.iter().for_each(|&(vertex, weight)| each(vertex, weight)),
        }
    }
}

impl<T: Scalar> Spreads<T> {
    pub(crate) fn clear(&mut self) {
        self.loads.clear();
        self.bearings.clear();
    }

    /// How many contacts they are for.
    pub(crate) fn len(&self) -> usize {
        self.loads.len()
    }

    /// Adds what the two ends of a contact bear on; gives its place.
    pub(crate) fn add(&mut self, ends: [&[(u32, T)]; 2], gap: T) -> SpreadPlace {
        let start = self.bearings.len();
        ends.iter().for_each(|end| memory::append(&mut self.bearings, end.iter().copied()));
        let places = [start, start + ends[0].len(), self.bearings.len()].map(|place| place as u32);
        self.loads.room_for(1).push(Load { places, gap });
        SpreadPlace(NonZeroU32::new(self.loads.len() as u32))
    }

    /// Adds those of another list.
    pub(crate) fn append(&mut self, other: &Self) {
        let start = self.bearings.len() as u32;
        let moved = |load: &Load<T>| Load { places: load.places.map(|place| place + start), ..*load };
        memory::append(&mut self.loads, other.loads.iter().map(moved));
        memory::append(&mut self.bearings, other.bearings.iter().copied());
    }

    fn load(&self, contact: &Contact<T>) -> Option<&Load<T>> {
        contact.spread.0.map(|place| &self.loads[place.get() as usize - 1])
    }

    /// What a contact's two ends bear on.
    #[inline(always)]
    pub(crate) fn bearings<'a>(&'a self, contact: &'a Contact<T>) -> [Bearings<'a, T>; 2] {
        let Some(load) = self.load(contact) else { return [&contact.p1, &contact.p2].map(Bearings::Point) };
        let [start, middle, end] = load.places.map(|place| place as usize);
        [&self.bearings[start..middle], &self.bearings[middle..end]].map(Bearings::Spread)
    }

    /// How far what the second end bears on was beyond what the first does, along the direction, at detection.
    #[inline(always)]
    pub(crate) fn gap(&self, contact: &Contact<T>) -> T {
        let between = || (contact.p2.position - contact.p1.position).dot(&contact.direction);
        self.load(contact).map_or_else(between, |load| load.gap)
    }
}

/// Room for finding what contacts bear on.
#[derive(Clone, Debug, Default)]
pub(crate) struct SpreadWorkspace<T: Scalar> {
    pub(crate) ends: [EndWorkspace<T>; 2],
    pub(crate) marks: Marks,
}

/// The vertices that one end bears on, their weights, and where they are.
#[derive(Clone, Debug, Default)]
pub(crate) struct EndWorkspace<T: Scalar> {
    pub(crate) bearings: Vec<(u32, T)>,
    pub(crate) positions: Vec<Vector3<T>>,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Marks {
    /// By vertex: where it stands among the bearings, from 1 on; 0 between two ends.
    pub(crate) places: Vec<u32>,
    /// By triangle, whether it was met; and those met.
    pub(crate) is_met: Vec<bool>,
    pub(crate) met: Vec<u32>,
    /// Whether memory has ended on the way.
    pub(crate) is_unfinished: bool,
}

impl Marks {
    /// Makes room for two meshes.
    pub(crate) fn start(&mut self, topologies: [&Topology; 2]) {
        if std::mem::replace(&mut self.is_unfinished, true) {
            self.places.clear();
            self.is_met.clear();
        }
        for topology in topologies {
            let [vertices, triangles] = [topology.vertex_count(), topology.triangles().len()];
            if self.places.len() < vertices {
                memory::refill_with(&mut self.places, 0, vertices);
            }
            if self.is_met.len() < triangles {
                memory::refill_with(&mut self.is_met, false, triangles);
            }
        }
    }
}
