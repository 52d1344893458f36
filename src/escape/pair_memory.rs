use crate::contact::Contact;
use crate::math::{Scalar, Vector3};

/// What a pair of bodies remembers from step to step while their boxes overlap: whether it is escaping, and whether its
/// overlap gets smaller. Forgotten when the bodies are apart. A host that saves and restores its own state saves and
/// restores this with it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PairMemory<T: Scalar> {
    /// The direction in which the first body leaves the second, of unit length; `None` while contacts do.
    pub escape: Option<Vector3<T>>,
    /// The smallest overlap so far, Σ area · depth · cos α; while the pair escapes, the smallest depth. Renewed by a value that
    /// is smaller by a tenth.
    pub lowest: Record<T>,
    /// The same, renewed by a value that is smaller by half. While the pair escapes, the largest depth that it has led to.
    pub halved: Record<T>,
    /// The net push on the first body over the sum of all pushes, averaged over about eight steps that are weighted by their
    /// depth. Its length is 1 where all contacts have pushed one way, and near 0 where they push against each other or
    /// to and fro. Not updated during an escape.
    pub net_push: Vector3<T>,
    /// The distance of the deepest contact averaged over the same steps. Not updated during an escape.
    pub mean_depth: T,
}

/// The lowest value so far of a number that should fall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record<T: Scalar> {
    /// The value; infinite before the first.
    pub value: T,
    /// For how many steps no value has been low enough to replace it.
    pub steps: u32,
}

impl<T: Scalar> Default for Record<T> {
    fn default() -> Self {
        Self { value: T::INFINITY, steps: 0 }
    }
}

impl<T: Scalar> Record<T> {
    /// Counts a step; a value of at most `factor` times the record replaces it.
    fn follow(&mut self, value: T, factor: T) {
        *self = if value <= self.value * factor {
            Self { value, steps: 0 }
        } else {
            Self { value: self.value, steps: self.steps.saturating_add(1) }
        };
    }
}

// What chose these numbers: docs/architecture.md, *Tuned constants*.

/// Steps without a smaller overlap after which deep contacts are stuck.
const STEPS_TO_A_NEW_LOW: u32 = 8;
/// Steps without a halved overlap after which contacts that push against each other are jammed.
const STEPS_TO_HALVE: u32 = 16;
/// Steps without a smaller depth after which other bodies are taken to hold an escape back.
const STEPS_TO_TURN: u32 = 24;

/// How the overlap of a pair has developed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Progress {
    /// The contacts mostly push one way: they part the bodies, or carry a load.
    OneWay,
    /// They push against each other.
    Balanced,
    /// The same, and the overlap has not shrunk for some steps.
    Slow,
    /// The same for so long that the contacts hold the bodies in one another.
    Jammed,
}

/// An escape leads deeper where its depth is this many times the one it began with.
const DEEPER: f64 = 1.1;
/// Contacts push one way if their net push is at least this part of the sum of all pushes.
const NET_PUSH: f64 = 0.3;
/// A net push below this part of the sum may be what is left of pushes that change sides.
const LASTING_PUSH: f64 = 0.05;
/// How much the newest step counts in the average of net pushes.
const NEWEST: f64 = 1.0 / 8.0;

impl<T: Scalar> PairMemory<T> {
    /// Updates the memory with a step's contacts; `first` is the number of the pair's first body.
    pub(crate) fn observe(&mut self, first: u32, contacts: &[Contact<T>]) -> Progress {
        let (mut overlap, mut deepest) = (T::zero(), T::zero());
        let mut net = Vector3::zeros();
        for contact in contacts {
            let distance = contact.depth * contact.cos_alpha;
            let pressure = contact.area * distance;
            overlap += pressure;
            deepest = deepest.max(distance);
            let on_first = if contact.colliding == first { pressure } else { -pressure };
            net += contact.direction * on_first;
        }
        if overlap > T::zero() {
            // The first step stands for those before it. Steps are weighted by depth, since bodies set down face on face overlap
            // by a rounding at first, and that must not count as much as a step that bears their weight. They are not weighted by
            // area: bodies thrown to and fro between a broad contact and a narrow one are as deep in either.
            let newest = if self.lowest.value.is_finite() { T::of(NEWEST) } else { T::one() };
            self.mean_depth += (deepest - self.mean_depth) * newest;
            self.net_push += (net / overlap - self.net_push) * (newest * deepest / self.mean_depth).min(T::one());
        }
        self.lowest.follow(overlap, T::of(0.9));
        self.halved.follow(overlap, T::of(0.5));
        // A loaded contact at rest has a net force; a jam has none, or one that changes sides from step to step.
        if self.net_push.norm() > T::of(NET_PUSH) {
            Progress::OneWay
        } else if self.halved.steps >= STEPS_TO_HALVE {
            Progress::Jammed
        } else if self.lowest.steps >= STEPS_TO_A_NEW_LOW {
            Progress::Slow
        } else {
            Progress::Balanced
        }
    }

    /// The direction in which the contacts as a whole push the first body, if there is one.
    pub(crate) fn lasting_push(&self) -> Option<Vector3<T>> {
        let length = self.net_push.norm();
        (length > T::of(LASTING_PUSH)).then(|| self.net_push / length)
    }

    /// Begins, or begins anew, to escape along `away`.
    pub(crate) fn start_to_escape(&mut self, away: Vector3<T>) {
        *self = Self { escape: Some(away), ..Self::default() };
    }

    /// Whether the escape has led deeper than where it began, or than when this was last so.
    pub(crate) fn leads_deeper(&mut self, depth: T) -> bool {
        let is_deeper = depth > self.halved.value * T::of(DEEPER);
        if is_deeper || self.halved.value == T::INFINITY {
            self.halved.value = depth;
        }
        is_deeper
    }

    /// Notes how deep the escaping pair still is; returns whether other bodies have long held it back.
    pub(crate) fn observe_escape(&mut self, depth: T) -> bool {
        self.lowest.follow(depth, T::of(0.9));
        self.lowest.steps >= STEPS_TO_TURN
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::test_contact::contact;

    const AT: [f64; 3] = [0.0; 3];

    #[test]
    fn records_stand_until_they_are_undercut_by_the_factor() {
        let mut record = Record::default();
        // Each number, and what stands after it.
        for (value, stands, steps) in [
            (8.0, 8.0, 0),
            (4.5, 8.0, 1),
            (9.0, 8.0, 2),
            (4.0, 4.0, 0),
            (2.5, 4.0, 1),
            (1.0, 1.0, 0),
            (0.75, 1.0, 1),
            (0.0, 0.0, 0),
            (0.0, 0.0, 0),
        ] {
            record.follow(value, 0.5);
            assert_eq!(record, Record { value: stands, steps });
        }
    }

    /// Pushes of 1 and 1/2 on the first body along x, and of 1/4 on the second along y.
    fn pushes() -> [Contact<f64>; 3] {
        [
            contact(0, AT, [1.0, 0.0, 0.0], [4.0, 0.5, 0.5]),
            contact(0, AT, [1.0, 0.0, 0.0], [0.25, 2.0, 1.0]),
            contact(1, AT, [0.0, 1.0, 0.0], [0.25, 4.0, 0.25]),
        ]
    }

    #[test]
    fn the_overlap_is_the_sum_and_the_net_push_an_average_over_steps() {
        let (mut memory, contacts) = (PairMemory::default(), pushes());
        let net = Vector3::new(1.5, -0.25, 0.0) / 1.75;
        assert_eq!(memory.observe(0, &contacts), Progress::OneWay);
        assert_eq!((memory.lowest.value, memory.halved.value), (1.75, 1.75));
        assert!((memory.net_push - net).norm() < 1e-15, "the first step stands for those before it");
        // From now on they push the other way, an eighth at a time.
        let mut expected = net;
        for _ in 0..4 {
            memory.observe(1, &contacts);
            expected = expected * 0.875 - net * 0.125;
            assert!((memory.net_push - expected).norm() < 1e-15);
        }
        memory.observe(1, &[]);
        assert!((memory.net_push - expected).norm() < 1e-15, "no contacts push no way");
        assert_eq!((memory.lowest.value, memory.halved.value), (0.0, 0.0));
    }

    /// Boxes set down face on face: their faces overlap by a rounding, here and there, and only then bear a load.
    #[test]
    fn overlaps_by_a_rounding_count_as_little_as_they_are() {
        let mut memory = PairMemory::default();
        assert_eq!(memory.observe(0, &balanced(1e-17)), Progress::Balanced);
        let load = [contact(0, AT, [0.0, 0.0, 1.0], [1.0, 1e-3, 1.0])];
        assert_eq!(memory.observe(0, &load), Progress::OneWay);
        assert!((memory.net_push - Vector3::z()).norm() < 1e-12, "{}", memory.net_push);
        assert!((memory.mean_depth - 1e-3 / 8.0).abs() < 1e-15);
    }

    /// A c-clamp and a helix, to and fro between eight contacts and four with a twentieth of their overlap.
    #[test]
    fn bodies_thrown_to_and_fro_jam_whatever_the_areas() {
        let [broad, narrow] = [[1.0, 1.4e-4, 20.0], [-1.0, 0.95e-4, 1.0]]
            .map(|[x, depth, area]| [contact(0, AT, [x, 0.0, 0.0], [area, depth, 1.0])]);
        let mut memory = PairMemory::default();
        let found = (0..40).map(|step| memory.observe(0, if step % 2 == 0 { &broad } else { &narrow }));
        assert_eq!(found.last(), Some(Progress::Jammed));
    }

    /// Two that push against each other.
    fn balanced(depth: f64) -> [Contact<f64>; 2] {
        [1.0, -1.0].map(|x| contact(0, AT, [x, 0.0, 0.0], [1.0, depth, 1.0]))
    }

    #[test]
    fn what_does_not_get_smaller_is_slow_and_then_jammed() {
        let mut memory = PairMemory::default();
        let found: Vec<_> = (0..20).map(|_| memory.observe(0, &balanced(1.0))).collect();
        let (slow, jammed) = (STEPS_TO_A_NEW_LOW as usize, STEPS_TO_HALVE as usize);
        assert!(found[..slow].iter().all(|&progress| progress == Progress::Balanced));
        assert!(found[slow..jammed].iter().all(|&progress| progress == Progress::Slow));
        assert!(found[jammed..].iter().all(|&progress| progress == Progress::Jammed));
        // Smaller by a tenth each step it is neither, though it takes seven steps to halve.
        let mut memory = PairMemory::default();
        assert!((0..40).all(|step| memory.observe(0, &balanced(0.9f64.powi(step))) == Progress::Balanced));
        // Smaller by a little each step it jams.
        let mut memory = PairMemory::default();
        let last = (0..20).map(|step| memory.observe(0, &balanced(0.99f64.powi(step)))).last();
        assert_eq!(last, Some(Progress::Jammed));
    }

    #[test]
    fn three_tenths_of_all_pushes_are_one_way() {
        for (back, expected) in [(0.5, Progress::OneWay), (0.56, Progress::Balanced)] {
            let mut memory = PairMemory::default();
            let pushes =
                [contact(0, AT, [1.0, 0.0, 0.0], [1.0, 1.0, 1.0]), contact(0, AT, [-1.0, 0.0, 0.0], [back, 1.0, 1.0])];
            assert_eq!(memory.observe(0, &pushes), expected, "{back}");
        }
    }

    #[test]
    fn an_escape_turns_after_so_many_steps_without_a_smaller_depth() {
        let mut memory = PairMemory::default();
        memory.observe(0, &balanced(1.0));
        memory.start_to_escape(Vector3::z());
        assert_eq!(memory, PairMemory { escape: Some(Vector3::z()), ..PairMemory::default() });
        assert!((0..STEPS_TO_TURN).all(|step| !memory.observe_escape(1.0 - 0.001 * f64::from(step))));
        assert!(memory.observe_escape(0.99) && !memory.observe_escape(0.5));
    }

    #[test]
    fn an_escape_leads_deeper_only_beyond_where_it_began() {
        let mut memory = PairMemory::default();
        memory.observe(0, &balanced(0.5));
        memory.start_to_escape(Vector3::z());
        let depths =
            [(1.0, false), (1.09, false), (1.11, true), (1.2, false), (1.23, true), (0.1, false), (1.3, false)];
        for (depth, deeper) in depths {
            assert_eq!(memory.leads_deeper(depth), deeper, "{depth}");
        }
    }
}
