use crate::memory;

/// Disjoint sets of numbers (union–find, Tarjan 1975). Each number also has a parity within its set.
#[derive(Clone, Debug, Default)]
pub(crate) struct UnionFind {
    parents: Vec<u32>,
    parities: Vec<bool>,
}

impl UnionFind {
    /// Starts anew with `count` sets of one number each.
    pub(crate) fn reset(&mut self, count: usize) {
        memory::refill(&mut self.parents, 0..count as u32);
        memory::refill_with(&mut self.parities, false, count);
    }

    /// The number that stands for the set of `number`, and the parity of `number` beside it.
    pub(crate) fn find(&mut self, number: u32) -> (u32, bool) {
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

    /// Joins two sets so that the two numbers differ in parity, or not, as `differ` says; gives whether that agrees with what was
    /// known.
    pub(crate) fn join(&mut self, a: u32, b: u32, differ: bool) -> bool {
        let ((root_a, parity_a), (root_b, parity_b)) = (self.find(a), self.find(b));
        if root_a == root_b {
            return (parity_a ^ parity_b) == differ;
        }
        // The smaller number becomes the root, so that the order of joins does not matter.
        let (child, root) = (root_a.max(root_b), root_a.min(root_b));
        self.parents[child as usize] = root;
        self.parities[child as usize] = parity_a ^ parity_b ^ differ;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    const COUNT: usize = 24;

    /// What joins alone tell of the numbers: for each its group, and its parity in it.
    struct Known([(usize, bool); COUNT]);

    impl Known {
        /// Joins two groups by naming all of one anew; gives whether that agrees.
        fn join(&mut self, a: usize, b: usize, differ: bool) -> bool {
            let ((group_a, parity_a), (group_b, parity_b)) = (self.0[a], self.0[b]);
            let turns = parity_a != (parity_b != differ);
            if group_a == group_b {
                return !turns;
            }
            for (group, parity) in self.0.iter_mut().filter(|(group, _)| *group == group_b) {
                (*group, *parity) = (group_a, *parity != turns);
            }
            true
        }
    }

    #[test]
    fn sets_and_parities_are_those_of_all_joins() {
        for seed in 0..40 {
            let (mut sets, mut known) = (UnionFind::default(), Known(std::array::from_fn(|number| (number, false))));
            sets.reset(7);
            sets.join(3, 5, true);
            sets.reset(COUNT);
            let mut random = Random::new(seed);
            let mut next = |count: usize| ((0.5 + 0.5 * random.signed()) * count as f64) as usize;
            for _ in 0..COUNT {
                let (a, b, differ) = (next(COUNT), next(COUNT), next(2) == 1);
                assert_eq!(sets.join(a as u32, b as u32, differ), known.join(a, b, differ));
                if next(8) == 0 {
                    assert_same(&mut sets, &known);
                }
            }
            assert_same(&mut sets, &known);
        }
    }

    fn assert_same(sets: &mut UnionFind, known: &Known) {
        let found: [_; COUNT] = std::array::from_fn(|number| sets.find(number as u32));
        for (a, b) in (0..COUNT).flat_map(|a| (0..COUNT).map(move |b| (a, b))) {
            let are_one = known.0[a].0 == known.0[b].0;
            assert_eq!(found[a].0 == found[b].0, are_one, "{a} and {b}");
            if are_one {
                assert_eq!(found[a].1 == found[b].1, known.0[a].1 == known.0[b].1, "{a} and {b}");
            }
        }
        // The smallest number of a set stands for it.
        assert!((0..COUNT).all(|number| found[number].0 as usize <= number));
    }
}
