use crate::escape::PairMemory;
use crate::math::Scalar;
use crate::memory::Room;
use std::collections::HashSet;

/// A pair, its bodies in their order, and what it remembers.
pub(super) type Remembered<T> = ([u32; 2], PairMemory<T>);

/// A pair by its numbers alone, the smaller first.
pub(super) fn by_number([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// What is known of pairs from step to step.
#[derive(Debug, Default)]
pub(super) struct Pairs<T: Scalar> {
    pub(super) history: History<T>,
    /// The pairs that may not escape, overlapping or not: by number, in ascending order.
    pub(super) without_escape: Vec<[u32; 2]>,
    /// The pairs that do not collide: by number, in no order, as there may be very many.
    pub(super) ignored: HashSet<[u32; 2]>,
}

impl<T: Scalar> Pairs<T> {
    /// Forgets all pairs of a body.
    pub(super) fn forget(&mut self, body: u32) {
        self.history.forget(|pair| pair.contains(&body));
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
                // What led to an escape must not start the next one.
                self.history.forget(|known| by_number(*known) == pair);
            }
            _ => {}
        }
    }
}

/// What the overlapping pairs remember. All queries of a step start from `before`, as the last step left it; `after` is what the
/// newest query would leave to the next step. Both are in the order of the bodies, which stays while other bodies come and go.
#[derive(Debug, Default)]
pub(super) struct History<T: Scalar> {
    pub(super) before: Vec<Remembered<T>>,
    pub(super) after: Vec<Remembered<T>>,
    /// Whether there has been a query in this step.
    pub(super) is_queried: bool,
    /// The stamp of the newest positions of any body at the newest query.
    pub(super) queried_at: u64,
    /// Whether the host says when a step ends. Otherwise it ends at the first query after a body was given positions.
    pub(super) is_advanced: bool,
    /// How much of a whole step has passed since the counts last went on: below 1.
    pub(super) passed: f64,
}

/// The rules by which pairs escape count steps of this many seconds; a longer step counts as one.
const WHOLE_STEP: f64 = 1.0 / 60.0;
/// This much of a step counts as a whole one: parts that add up to a step but for rounding, or a frame at 62.5 Hz.
const NEARLY_WHOLE: f64 = 0.95;

impl<T: Scalar> History<T> {
    /// What pairs remember as of the newest query, or else of the last step.
    pub(super) fn newest(&self) -> &[Remembered<T>] {
        if self.is_queried { &self.after } else { &self.before }
    }

    /// Starts a query: copies what `pairs` remembered before this step into `after`, and nothing for those that are new. `stamp`
    /// is that of the newest positions, `order` what pairs compare by.
    pub(super) fn start_query(
        &mut self,
        pairs: impl Iterator<Item = [u32; 2]>,
        stamp: u64,
        order: impl Fn(&[u32; 2]) -> [u32; 2],
    ) {
        if !self.is_advanced && stamp != self.queried_at {
            self.end_step();
        }
        (self.is_queried, self.queried_at) = (false, stamp);
        self.after.clear();
        let mut known = self.before.iter().peekable();
        for pair in pairs {
            while known.next_if(|(other, _)| order(other) < order(&pair)).is_some() {}
            let memory =
                known.next_if(|(other, _)| *other == pair).map_or(PairMemory::default(), |(_, memory)| *memory);
            self.after.room_for(1).push((pair, memory));
        }
    }

    /// Ends a step of this many seconds.
    pub(super) fn advance(&mut self, seconds: f64, order: impl Fn(&[u32; 2]) -> [u32; 2]) {
        self.is_advanced = true;
        self.passed += (seconds / WHOLE_STEP).min(1.0);
        let is_whole = self.passed >= NEARLY_WHOLE;
        if is_whole {
            self.passed = (self.passed - 1.0).max(0.0);
        }
        if self.is_queried && !is_whole {
            // Counts do not advance, but escapes and overlaps begin and end at once.
            let mut known = self.before.iter().peekable();
            for (pair, memory) in &mut self.after {
                while known.next_if(|(other, _)| order(other) < order(pair)).is_some() {}
                let before = known.next_if(|(other, _)| other == pair).map(|(_, before)| before);
                let goes_on =
                    |before: &&PairMemory<T>| before.escape == memory.escape && *memory != PairMemory::default();
                if let Some(before) = before.filter(goes_on) {
                    *memory = *before;
                }
            }
        }
        self.end_step();
    }

    fn end_step(&mut self) {
        if self.is_queried {
            std::mem::swap(&mut self.before, &mut self.after);
            self.is_queried = false;
        }
    }

    fn forget(&mut self, mut is_gone: impl FnMut(&[u32; 2]) -> bool) {
        self.before.retain(|(pair, _)| !is_gone(pair));
        self.after.retain(|(pair, _)| !is_gone(pair));
    }

    /// Replaces what a pair remembers, before this step and since.
    pub(super) fn set(&mut self, pair: [u32; 2], memory: PairMemory<T>, order: impl Fn(&[u32; 2]) -> [u32; 2]) {
        let lists = [Some(&mut self.before), Some(&mut self.after).filter(|_| self.is_queried)];
        // Room first: either both change or none.
        let lists = lists.map(|list| list.map(|list| list.room_for(1)));
        for list in lists.into_iter().flatten() {
            match list.binary_search_by_key(&order(&pair), |(other, _)| order(other)) {
                Ok(place) => list[place].1 = memory,
                Err(place) => list.insert(place, (pair, memory)),
            }
        }
    }

    /// Whether both lists are in the order by which pairs compare.
    pub(super) fn is_in_order<K: PartialOrd>(&self, order: impl Fn(&[u32; 2]) -> [K; 2]) -> bool {
        [&self.before, &self.after].into_iter().all(|list| {
            let of_two = |two: &[Remembered<T>]| order(&two[0].0) < order(&two[1].0);
            list.windows(2).all(of_two)
                && list.iter().map(|(pair, _)| order(pair)).all(|[first, second]| first < second)
        })
    }
}
