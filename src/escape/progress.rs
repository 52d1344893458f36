//! Pairs that contacts cannot part: when a pair begins to escape, and how the escape goes on.

use crate::contact::{ContactKind, ContactList, Outcome, Pair};
use crate::escape::direction::{choose_direction, is_short_way_out, push_apart};
use crate::escape::pair_memory::{PairMemory, Progress};
use crate::math::{Scalar, Vector3};

// What chose these numbers: docs/architecture.md, *Tuned constants*.

/// A short way out is less than this many times the depth of the deepest contact.
const SHORT_WAY: f64 = 2.0;
/// A short way out is also less than this part of the smaller body's size.
const SHALLOW: f64 = 0.1;
/// An escape that leads deeper turns to a way shorter than this part of its own.
const SHORTER_WAY: f64 = 0.9;

impl<T: Scalar> Pair<'_, T> {
    /// Detects the pair's contacts; an overlap without any ordinary contact is reported as an escape in this step.
    pub(crate) fn detect_without_memory(&self, contacts: &mut ContactList<T>) {
        let start = contacts.len();
        let is_targetless = self.detect(contacts) == Outcome::Targetless;
        if is_targetless && contacts.len() == start && self.options.escape {
            self.start_to_escape(start, contacts);
        }
    }

    /// Detects the pair's contacts, or goes on with its escape, or begins one. `alone`: one of the bodies meets no third.
    pub(crate) fn detect_or_escape(&self, memory: &mut PairMemory<T>, alone: bool, contacts: &mut ContactList<T>) {
        if let Some(away) = memory.escape.filter(|_| self.may_escape) {
            self.go_on_escaping(away, memory, alone, contacts);
            return;
        }
        memory.escape = None;
        let start = contacts.len();
        let outcome = self.detect(contacts);
        if outcome == Outcome::Settled && contacts.len() == start {
            *memory = PairMemory::default();
            return;
        }
        // Reserved now, so that a later step that asks for depths allocates nothing.
        contacts.workspace.reserve(contacts.len() - start);
        // Points without a target alone mean nothing: ordinary contacts near edges have them too.
        let targetless = outcome == Outcome::Targetless;
        let stuck = match memory.observe(self.bodies[0], &contacts.contacts[start..]) {
            _ if contacts.len() == start => targetless,
            Progress::OneWay => false,
            Progress::Balanced => targetless || self.any_passes_its_own(start, contacts),
            Progress::Slow => targetless || self.any_leaves_own(start, T::of(2.0), contacts),
            Progress::Jammed => true,
        };
        if stuck
            && !self.is_led_out(memory, start, contacts)
            && let Some(away) = self.start_to_escape(start, contacts)
        {
            memory.start_to_escape(away);
        }
    }

    /// Whether the contacts, which begin at `start`, push the pair apart by a short way, though most push against each other. A
    /// star that stands on its spikes is such a pair: its contacts push the spikes from all sides, and upward a little.
    fn is_led_out(&self, memory: &PairMemory<T>, start: usize, contacts: &mut ContactList<T>) -> bool {
        let deepest = contacts.contacts[start..].iter().fold(T::zero(), |deepest, contact| deepest.max(contact.depth));
        let sizes = self.tracers.map(|tracer| tracer.mesh().aabb().longest_side());
        let limit = (deepest * T::of(SHORT_WAY)).min(sizes[0].min(sizes[1]) * T::of(SHALLOW));
        let away = memory.lasting_push().filter(|_| deepest > T::zero());
        away.is_some_and(|away| is_short_way_out(self, &away, limit, contacts))
    }

    /// Keeps the direction until the pair is apart, with two exceptions. Bodies that fall on into one another turn to a way that
    /// has become shorter. Where other bodies hold the pair back, it turns to the line of centres: all pairs that do so can come
    /// apart at once, as when all bodies move away from one point.
    fn go_on_escaping(&self, away: Vector3<T>, memory: &mut PairMemory<T>, alone: bool, contacts: &mut ContactList<T>) {
        let start = contacts.len();
        let Some(mut depth) = push_apart(self, &away, contacts) else {
            *memory = PairMemory::default();
            return;
        };
        if alone
            && memory.leads_deeper(depth)
            && let Some(shorter) = choose_direction(self, depth * T::of(SHORTER_WAY), contacts)
        {
            contacts.statistics.escape_contacts -= (contacts.len() - start) as u64;
            withdraw(start, contacts);
            contacts.pushes.pop();
            depth = push_apart(self, &shorter, contacts).unwrap_or(depth);
            memory.escape = Some(shorter);
            contacts.statistics.escapes_turned += 1;
        }
        contacts.statistics.escaping_pairs += 1;
        if memory.observe_escape(depth) {
            memory.start_to_escape(self.line_of_centres());
            contacts.statistics.escapes_turned += 1;
        }
    }

    /// Replaces the pair's contacts, which begin at `start`, by the first ones of its escape.
    fn start_to_escape(&self, start: usize, contacts: &mut ContactList<T>) -> Option<Vector3<T>> {
        if !self.may_escape {
            contacts.statistics.escapes_forbidden += 1;
            return None;
        }
        let away = choose_direction(self, T::INFINITY, contacts)?;
        let edges = contacts.contacts[start..].iter().filter(|contact| contact.kind == ContactKind::Edge).count();
        contacts.statistics.edge_contacts -= edges as u64;
        withdraw(start, contacts);
        contacts.statistics.escapes_started += 1;
        contacts.statistics.escaping_pairs += 1;
        push_apart(self, &away, contacts);
        Some(away)
    }
}

/// Removes the contacts from `start` on, and counts their rays as replaced.
fn withdraw<T: Scalar>(start: usize, contacts: &mut ContactList<T>) {
    contacts.statistics.replaced += (contacts.len() - start) as u64;
    contacts.contacts.truncate(start);
}
