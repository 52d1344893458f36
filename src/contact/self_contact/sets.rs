use crate::memory::{self, Room};

/// Sets of numbers, joined two by two (Tarjan 1975), each with its parity in its set.
#[derive(Clone, Debug, Default)]
pub(super) struct Sets {
    parents: Vec<u32>,
    parities: Vec<bool>,
}

impl Sets {
    /// `count` sets of one number each.
    pub(super) fn reset(&mut self, count: usize) {
        self.parents.clear();
        memory::append(&mut self.parents, 0..count as u32);
        self.parities.clear();
        self.parities.room_for(count).resize(count, false);
    }

    /// The number that stands for the set of `number`, and the parity of `number` beside it.
    pub(super) fn find(&mut self, number: u32) -> (u32, bool) {
        let (mut root, mut parity) = (number, false);
        while self.parents[root as usize] != root {
            parity ^= self.parities[root as usize];
            root = self.parents[root as usize];
        }
        let (mut at, mut left) = (number, parity);
        while self.parents[at as usize] != root {
            let (next, step) = (self.parents[at as usize], self.parities[at as usize]);
            (self.parents[at as usize], self.parities[at as usize]) = (root, left);
            left ^= step;
            at = next;
        }
        (root, parity)
    }

    /// Joins two sets so that the two numbers differ in parity where `differ` says so; gives whether that agrees with what
    /// was known.
    pub(super) fn join(&mut self, a: u32, b: u32, differ: bool) -> bool {
        let ((root_a, parity_a), (root_b, parity_b)) = (self.find(a), self.find(b));
        if root_a == root_b {
            return (parity_a ^ parity_b) == differ;
        }
        // The smaller number stands for both, so that nothing depends on the order.
        let (child, root) = (root_a.max(root_b), root_a.min(root_b));
        self.parents[child as usize] = root;
        self.parities[child as usize] = parity_a ^ parity_b ^ differ;
        true
    }
}
