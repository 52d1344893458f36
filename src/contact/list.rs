use crate::contact::escape_push::EscapePush;
use crate::contact::point_pair::Contact;
use crate::contact::potential::Columns;
use crate::contact::spread::Spreads;
use crate::contact::statistics::Statistics;
use crate::contact::workspace::Workspace;
use crate::math::Scalar;
use crate::memory::{self, Room};
use crate::threads::Helpers;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

/// The contacts of one query, in a fixed order: by pair, then the colliding body, then along its surface.
///
/// Two lists are equal where their contacts, pushes and statistics are.
#[derive(Clone, Debug, Default)]
pub struct ContactList<T: Scalar> {
    /// The contacts.
    pub contacts: Vec<Contact<T>>,
    /// How they were found.
    pub statistics: Statistics,
    pub(crate) pushes: Vec<EscapePush<T>>,
    pub(crate) spreads: Spreads<T>,
    pub(crate) workspace: Workspace<T>,
}

impl<T: Scalar> PartialEq for ContactList<T> {
    fn eq(&self, other: &Self) -> bool {
        self.contacts == other.contacts
            && self.statistics == other.statistics
            && self.pushes == other.pushes
            && self.spreads == other.spreads
    }
}

impl<T: Scalar> ContactList<T> {
    /// How many contacts there are.
    pub fn len(&self) -> usize {
        self.contacts.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.contacts.is_empty()
    }

    /// How each escaping pair is pushed as a whole, in the order of the pairs.
    pub fn pushes(&self) -> &[EscapePush<T>] {
        &self.pushes
    }

    /// Empties the list; its capacity stays.
    pub fn clear(&mut self) {
        self.contacts.clear();
        self.pushes.clear();
        self.spreads.clear();
        self.statistics = Statistics::default();
    }

    /// Fills the list anew. If memory runs out, the list is empty.
    pub(crate) fn refill<R>(&mut self, fill: impl FnOnce(&mut Self) -> R) -> R {
        self.clear();
        catch_unwind(AssertUnwindSafe(|| fill(self))).unwrap_or_else(|panic| {
            self.clear();
            resume_unwind(panic)
        })
    }

    /// Replaces its contents by those of `count` other lists. `list` gives how many contacts all lists before have, and the list.
    pub(crate) fn join<'a>(&mut self, helpers: &Helpers, count: usize, list: impl Fn(usize) -> (usize, &'a Self) + Sync)
    where
        T: 'a,
    {
        self.clear();
        let contacts_of = |index| {
            let (before, list) = list(index);
            (before, list.contacts.as_slice())
        };
        helpers.append(&mut self.contacts, count, contacts_of, |_, contact| *contact);
        for index in 0..count {
            let (before, other) = list(index);
            self.take_spreads(before, other);
            memory::append(&mut self.pushes, other.pushes.iter().copied());
            self.statistics += other.statistics;
        }
    }

    /// Takes over another list's contents; that list has to be cleared afterwards.
    pub(crate) fn take_from(&mut self, other: &mut Self) {
        std::mem::swap(&mut self.contacts, &mut other.contacts);
        std::mem::swap(&mut self.pushes, &mut other.pushes);
        std::mem::swap(&mut self.spreads, &mut other.spreads);
        self.statistics = other.statistics;
    }

    /// Adds the contacts, pushes and counts of `other` after its own.
    pub fn append(&mut self, other: &Self) {
        let before = self.len();
        self.contacts.room_for(other.contacts.len()).extend_from_slice(&other.contacts);
        self.take_spreads(before, other);
        self.pushes.room_for(other.pushes.len()).extend_from_slice(&other.pushes);
        self.statistics += other.statistics;
    }

    /// The sum over all pairs of what `of_pair` gives for its two bodies and its contacts.
    pub(crate) fn sum_of_pairs(
        &mut self,
        mut of_pair: impl FnMut([u32; 2], &[Contact<T>], &mut Columns<T>) -> f64,
    ) -> f64 {
        let pairs = self.contacts.chunk_by(|one, next| one.bodies() == next.bodies());
        let columns = &mut self.workspace.columns;
        pairs.fold(0.0, |sum, contacts| sum + of_pair(contacts[0].bodies(), contacts, columns))
    }

    /// Adds the spreads of the contacts of `other`, which come after so many of its own.
    fn take_spreads(&mut self, before: usize, other: &Self) {
        if other.spreads.len() > 0 {
            let spreads_before = self.spreads.len();
            self.spreads.append(&other.spreads);
            let contacts = &mut self.contacts[before..before + other.len()];
            contacts.iter_mut().for_each(|contact| contact.spread = contact.spread.after(spreads_before));
        }
    }
}
