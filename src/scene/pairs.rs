use crate::contact::PairMemory;
use crate::math::Scalar;
use crate::memory::{self, Room};
use std::collections::HashSet;

/// A pair, its smaller number first, and what it remembers.
pub(super) type Remembered<T> = ([u32; 2], PairMemory<T>);

/// What is known of pairs from step to step. Lists are in ascending order.
#[derive(Debug)]
pub(super) struct Pairs<T: Scalar> {
    /// What each overlapping pair remembers.
    pub(super) memories: Vec<Remembered<T>>,
    /// The same before the step that is under way.
    before: Vec<Remembered<T>>,
    /// The pairs that may not escape, overlapping or not.
    pub(super) without_escape: Vec<[u32; 2]>,
    /// The pairs that do not collide; in no order, as there may be very many.
    pub(super) ignored: HashSet<[u32; 2]>,
}

impl<T: Scalar> Default for Pairs<T> {
    fn default() -> Self {
        Self { memories: Vec::new(), before: Vec::new(), without_escape: Vec::new(), ignored: HashSet::new() }
    }
}

impl<T: Scalar> Pairs<T> {
    /// Starts a step that can be taken back.
    pub(super) fn keep(&mut self) {
        self.before.clear();
        memory::append(&mut self.before, self.memories.iter().cloned());
    }

    /// Takes the step back.
    pub(super) fn go_back(&mut self) {
        std::mem::swap(&mut self.memories, &mut self.before);
    }

    /// Makes the memories those of `pairs`: keeps what is known, and forgets pairs that have parted.
    pub(super) fn remember(&mut self, pairs: &[[u32; 2]]) {
        let memories = &mut self.memories;
        memories.retain(|(pair, _)| pairs.binary_search(pair).is_ok());
        let known = memories.len();
        for pair in pairs {
            if memories[..known].binary_search_by_key(pair, |(pair, _)| *pair).is_err() {
                memories.room_for(1).push((*pair, PairMemory::default()));
            }
        }
        memories.sort_unstable_by_key(|(pair, _)| *pair);
    }

    /// Forgets all pairs of a body.
    pub(super) fn forget(&mut self, body: u32) {
        self.memories.retain(|(pair, _)| !pair.contains(&body));
        self.without_escape.retain(|pair| !pair.contains(&body));
        self.ignored.retain(|pair| !pair.contains(&body));
    }

    pub(super) fn allow_escape(&mut self, pair: [u32; 2], allowed: bool) {
        match (self.without_escape.binary_search(&pair), allowed) {
            (Ok(place), true) => {
                self.without_escape.remove(place);
            }
            (Err(place), false) => {
                self.without_escape.room_for(1).insert(place, pair);
                // Also what led to an escape is not to start the next one.
                self.memories.retain(|(known, _)| *known != pair);
            }
            _ => {}
        }
    }
}
