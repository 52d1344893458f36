use super::OwnContacts;
use crate::math::{Aabb, Scalar};
use crate::memory::{self, Room};
use crate::mesh::Mesh;
use crate::octree::Octree;
use std::collections::VecDeque;

/// So many bodies are removed after one before its number is given to another: whoever still uses the number is told so
/// for that long, and numbers stay small.
pub(super) const REMOVALS_BETWEEN: usize = 1 << 16;

#[derive(Debug)]
pub(super) struct Body<T: Scalar> {
    pub(super) number: u32,
    pub(super) mesh: Mesh<T>,
    pub(super) octree: Octree<T>,
    /// Room for where it meets other bodies.
    pub(super) regions: Vec<Aabb<T>>,
    /// Room for a list of the octree's tiles.
    pub(super) tiles: Vec<u32>,
    /// Where self-collision is switched on.
    pub(super) own: Option<OwnContacts<T>>,
}

/// A body in a place of its own, so that the list is short to move.
pub(super) type Boxed<T> = Box<[Body<T>; 1]>;

/// The bodies of a scene in ascending order of their numbers. A number without a body costs four bytes and no time.
#[derive(Debug)]
pub(super) struct Bodies<T: Scalar> {
    list: Vec<Boxed<T>>,
    /// The numbers without a body, the one that has been so for longest first. With those of the list they are all below
    /// some number.
    free: VecDeque<u32>,
}

impl<T: Scalar> Default for Bodies<T> {
    fn default() -> Self {
        Self { list: Vec::new(), free: VecDeque::new() }
    }
}

impl<T: Scalar> Bodies<T> {
    /// Adds a body; gives its number.
    pub(super) fn add(&mut self, mesh: Mesh<T>) -> u32 {
        let rested = self.free.len() > REMOVALS_BETWEEN;
        let number = if rested { self.free[0] } else { (self.list.len() + self.free.len()) as u32 };
        let octree = Octree::new(&mesh);
        let body = Body { number, mesh, octree, regions: Vec::new(), tiles: Vec::new(), own: None };
        let body = memory::boxed(body);
        // To remove one takes no memory then.
        self.free.room_for(self.list.len() + 1);
        self.list.room_for(1);
        if rested {
            self.free.pop_front();
        }
        let place = self.place(number).unwrap_or_else(|place| place);
        self.list.insert(place, body);
        number
    }

    pub(super) fn remove(&mut self, number: u32) -> Option<Body<T>> {
        let place = self.place(number).ok()?;
        self.free.room_for(1).push_back(number);
        let [body] = *self.list.remove(place);
        Some(body)
    }

    pub(super) fn get(&self, number: u32) -> Option<&Body<T>> {
        self.place(number).ok().map(|place| &self.list[place][0])
    }

    pub(super) fn get_mut(&mut self, number: u32) -> Option<&mut Body<T>> {
        self.place(number).ok().map(|place| &mut self.list[place][0])
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

    /// Where a body stands in the list, or would.
    pub(super) fn place(&self, number: u32) -> Result<usize, usize> {
        // As long as none has been removed, at its number; never behind it.
        match self.list.get(number as usize) {
            Some(body) if body[0].number == number => Ok(number as usize),
            _ => self.list.binary_search_by_key(&number, |body| body[0].number),
        }
    }
}
