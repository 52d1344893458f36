//! Forces pair by pair: each pair's are summed first, in whichever process, and then added in the order of the pairs. By rounding
//! these sums differ from those of [`add_forces`](crate::force::add_forces) in a few last digits.

use crate::contact::ContactList;
use crate::force::{BodiesMut, PenaltyLaw, Vectors, add_forces_of};
use crate::math::{Scalar, Vector3};
use crate::memory::Room;

/// The forces of one pair, or of a body with itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PairForces {
    /// The two bodies, the one whose contacts come first in the list first; the same twice for a body with itself.
    pub bodies: [u32; 2],
    /// Where its forces begin in [`ForcesByPair::forces`].
    pub start: usize,
    /// How many are the first body's, and how many after them the second's; none for a body with itself.
    pub counts: [usize; 2],
}

/// The forces of a contact list, summed pair by pair. Filled again, it allocates nothing in a steady step.
#[derive(Clone, Debug, Default)]
pub struct ForcesByPair<T: Scalar> {
    pairs: Vec<PairForces>,
    forces: Vec<(u32, Vector3<T>)>,
    sums: Vec<Sum<T>>,
    /// For either body of a pair, by vertex, where in `sums` its sum stands, or [`NOWHERE`].
    places: [Vec<u32>; 2],
}

const NOWHERE: u32 = u32::MAX;

/// What a pair does at one vertex.
#[derive(Clone, Copy, Debug)]
struct Sum<T: Scalar> {
    side: usize,
    vertex: u32,
    force: Vector3<T>,
}

struct Collector<'a, T: Scalar> {
    first: u32,
    sums: &'a mut Vec<Sum<T>>,
    places: &'a mut [Vec<u32>; 2],
}

impl<T: Scalar> BodiesMut<T> for Collector<'_, T> {
    fn add_to(&mut self, body: u32, vertex: u32, force: Vector3<T>) {
        let side = usize::from(body != self.first);
        let (places, at) = (&mut self.places[side], vertex as usize);
        if places.len() <= at {
            places.room_for(at + 1 - places.len()).resize(at + 1, NOWHERE);
        }
        if places[at] == NOWHERE {
            places[at] = self.sums.len() as u32;
            self.sums.room_for(1).push(Sum { side, vertex, force: Vector3::zeros() });
        }
        self.sums[places[at] as usize].force += force;
    }
}

impl<T: Scalar> ForcesByPair<T> {
    /// The pairs with contacts, in the order of the list.
    pub fn pairs(&self) -> &[PairForces] {
        &self.pairs
    }

    /// The forces of all pairs: vertex numbers, in ascending order for each body of a pair, and what acts there.
    pub fn forces(&self) -> &[(u32, Vector3<T>)] {
        &self.forces
    }

    /// Sums the forces of `list` anew. The arrays are as in [`add_forces`](crate::force::add_forces).
    pub fn sum<P: Vectors<T>>(
        &mut self,
        list: &ContactList<T>,
        law: &PenaltyLaw,
        positions: Option<&[P]>,
        velocities: Option<&[P]>,
    ) {
        self.pairs.clear();
        self.forces.clear();
        // Something is left only where the last call ran out of memory.
        for Sum { side, vertex, .. } in self.sums.drain(..) {
            self.places[side][vertex as usize] = NOWHERE;
        }
        let mut contacts = &list.contacts[..];
        while let Some(first) = contacts.first() {
            let bodies = [first.colliding, first.collided];
            let is_of_pair = |other: [u32; 2]| other == bodies || other == [bodies[1], bodies[0]];
            let end = contacts.iter().position(|contact| !is_of_pair([contact.colliding, contact.collided]));
            let (of_pair, others) = contacts.split_at(end.unwrap_or(contacts.len()));
            contacts = others;
            let mut collector = Collector { first: bodies[0], sums: &mut self.sums, places: &mut self.places };
            add_forces_of(of_pair, list, law, positions, velocities, &mut collector);
            self.take_sums(bodies);
        }
    }

    fn take_sums(&mut self, bodies: [u32; 2]) {
        let Self { pairs, forces, sums, places } = self;
        sums.sort_unstable_by_key(|sum| (sum.side, sum.vertex));
        let (start, mut counts) = (forces.len(), [0; 2]);
        forces.room_for(sums.len());
        for Sum { side, vertex, force } in sums.drain(..) {
            places[side][vertex as usize] = NOWHERE;
            counts[side] += 1;
            forces.push((vertex, force));
        }
        pairs.room_for(1).push(PairForces { bodies, start, counts });
    }
}
