use super::own_contacts::OwnContacts;
use crate::math::{Aabb, Scalar};
use crate::memory::{self, Room};
use crate::mesh::Mesh;
use crate::query::Surface;

#[derive(Debug)]
pub(super) struct Body<T: Scalar> {
    pub(super) number: u32,
    /// Bodies are in ascending order of their keys, and of their numbers where keys are equal.
    pub(super) key: u64,
    pub(super) surface: Surface<T>,
    /// Scratch memory for the boxes in which it meets other bodies.
    pub(super) regions: Vec<Aabb<T>>,
    /// Only where self-collision is switched on.
    pub(super) own: Option<OwnContacts<T>>,
    /// What other scenes know of it: see [`Sharing`](super::hooks::Sharing).
    pub(super) is_foreign: bool,
    pub(super) neighbours: Option<u32>,
    pub(super) overlaps_elsewhere: bool,
    /// The stamp of the last pose that was the same as before; it changes no positions, but may end a step.
    pub(super) given: u64,
    /// The cost of the last query for it, in rays.
    pub(super) cost: f64,
}

/// Boxed, so that the list is quick to move.
pub(super) type Boxed<T> = Box<[Body<T>; 1]>;

/// The bodies of a scene in their order: ascending by key, and by number where keys are equal. A number without a body costs
/// four bytes and no time.
#[derive(Debug, Default)]
pub(super) struct Bodies<T: Scalar> {
    list: Vec<Boxed<T>>,
    /// Numbers of removed bodies that may be given again, in descending order.
    released: Vec<u32>,
    /// The body's index in the list, by number; one for each number that was ever given.
    places: Vec<u32>,
}

/// The index of a number without a body.
const NOWHERE: u32 = u32::MAX;

impl<T: Scalar> Bodies<T> {
    /// Adds a body and gives its number, which is its key unless another is given.
    pub(super) fn add(&mut self, mesh: Mesh<T>, key: Option<u64>) -> u32 {
        let number = self.released.last().copied().unwrap_or(self.places.len() as u32);
        assert_ne!(number, NOWHERE, "all 2^32 - 1 numbers of bodies are taken: release those of removed bodies");
        let key = key.unwrap_or_else(|| u64::from(number));
        let body = memory::boxed(Body {
            number,
            key,
            surface: Surface::new(mesh),
            regions: Vec::new(),
            own: None,
            is_foreign: false,
            neighbours: None,
            overlaps_elsewhere: false,
            given: 0,
            cost: 0.0,
        });
        self.list.room_for(1);
        if self.released.is_empty() {
            self.places.room_for(1).push(NOWHERE);
        } else {
            self.released.pop();
        }
        let place = self.list.partition_point(|other| (other[0].key, other[0].number) < (key, number));
        self.list.insert(place, body);
        self.renew_places(place);
        number
    }

    pub(super) fn remove(&mut self, number: u32) -> Option<Body<T>> {
        let place = self.place(number)?;
        let [body] = *self.list.remove(place);
        self.places[number as usize] = NOWHERE;
        self.renew_places(place);
        Some(body)
    }

    /// Lets the numbers without a body be given again, the smallest first.
    pub(super) fn release_numbers(&mut self) {
        let used = self.places.iter().rposition(|&place| place != NOWHERE).map_or(0, |last| last + 1);
        let unused = (0..used).rev().filter(|&number| self.places[number] == NOWHERE);
        self.released.room_for(used - self.list.len()).clear();
        self.released.extend(unused.map(|number| number as u32));
        self.places.truncate(used);
    }

    /// Whether a body has this key.
    pub(super) fn has_key(&self, key: u64) -> bool {
        self.list.binary_search_by_key(&key, |body| body[0].key).is_ok()
    }

    fn renew_places(&mut self, first: usize) {
        for (place, body) in self.list.iter().enumerate().skip(first) {
            self.places[body[0].number as usize] = place as u32;
        }
    }

    pub(super) fn get(&self, number: u32) -> Option<&Body<T>> {
        self.place(number).map(|place| &self.list[place][0])
    }

    pub(super) fn get_mut(&mut self, number: u32) -> Option<&mut Body<T>> {
        self.place(number).map(|place| &mut self.list[place][0])
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Body<T>> {
        self.list.iter().map(|body| &body[0])
    }

    pub(super) fn iter_mut(&mut self) -> impl Iterator<Item = &mut Body<T>> {
        self.list.iter_mut().map(|body| &mut body[0])
    }

    pub(super) fn list(&self) -> &[Boxed<T>] {
        &self.list
    }

    pub(super) fn list_mut(&mut self) -> &mut [Boxed<T>] {
        &mut self.list
    }

    /// Where a body stands in the list.
    pub(super) fn place(&self, number: u32) -> Option<usize> {
        self.places.get(number as usize).filter(|&&place| place != NOWHERE).map(|&place| place as usize)
    }

    /// Where the bodies of a pair stand, both of which are there: pairs compare by it.
    pub(super) fn order(&self, pair: &[u32; 2]) -> [u32; 2] {
        pair.map(|number| self.places[number as usize])
    }

    /// The two bodies at these places.
    pub(super) fn two_mut(&mut self, [first, second]: [usize; 2]) -> [&mut Body<T>; 2] {
        let bodies = self.list.get_disjoint_mut([first, second]).expect("two different places of the list");
        bodies.map(|body| &mut body[0])
    }
}
