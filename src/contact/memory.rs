use super::Contact;
use crate::math::{Scalar, Vector3};

/// What a pair of bodies remembers from step to step while their boxes overlap: whether it is escaping, and whether its
/// overlap gets smaller. Forgotten when the bodies are apart. A host that saves and restores its own state saves and
/// restores this with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairMemory<T: Scalar> {
    /// The direction in which the first body leaves the second, of unit length; `None` while contacts do.
    pub escape: Option<Vector3<T>>,
    /// The smallest overlap so far, renewed where one is smaller by a tenth: Σ area · depth · cos α, or while the pair
    /// escapes its depth.
    pub lowest: Record<T>,
    /// The same, renewed where one is smaller by half; while the pair escapes it rests.
    pub halved: Record<T>,
    /// The net push on the first body as a part of the sum of all pushes, averaged over about eight steps: of length 1
    /// where all have pushed one way, and near 0 where they push against each other or to and fro. While the pair
    /// escapes it rests.
    pub net_push: Vector3<T>,
}

/// A number to be undercut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record<T: Scalar> {
    /// The number; infinite before the first.
    pub value: T,
    /// For how many steps it has stood.
    pub steps: u32,
}

impl<T: Scalar> Record<T> {
    const NONE: Self = Self { value: T::INFINITY, steps: 0 };

    fn follow(&mut self, value: T, factor: T) {
        *self = if value <= self.value * factor {
            Self { value, steps: 0 }
        } else {
            Self { value: self.value, steps: self.steps.saturating_add(1) }
        };
    }
}

impl<T: Scalar> Default for PairMemory<T> {
    fn default() -> Self {
        Self { escape: None, lowest: Record::NONE, halved: Record::NONE, net_push: Vector3::zeros() }
    }
}

/// Steps without a smaller overlap after which deep contacts are stuck.
const STEPS_TO_A_NEW_LOW: u32 = 8;
/// Steps without a halved overlap after which contacts that push against each other are jammed.
const STEPS_TO_HALVE: u32 = 16;
/// Steps without a smaller depth after which an escape is held fast by others.
const STEPS_TO_TURN: u32 = 24;

/// How the overlap of a pair has come along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Progress {
    /// The contacts push one way, on the whole: they part the bodies, or bear a load.
    OneWay,
    /// They push against each other.
    Balanced,
    /// The same, and the overlap has not got smaller for some steps.
    Slow,
    /// The same, for so long that they hold one another.
    Jammed,
}

/// Of the sum of all pushes the part that remains as net push where they push one way.
const NET_PUSH: f64 = 0.3;
/// How much the newest step counts in the average of net pushes.
const NEWEST: f64 = 1.0 / 8.0;

impl<T: Scalar> PairMemory<T> {
    /// Takes note of a step's contacts; `first` is the number of the pair's first body.
    pub(super) fn observe(&mut self, first: u32, contacts: &[Contact<T>]) -> Progress {
        let mut overlap = T::zero();
        let mut net = Vector3::zeros();
        for contact in contacts {
            let pressure = contact.area * contact.depth * contact.cos_alpha;
            overlap += pressure;
            let on_first = if contact.colliding == first { pressure } else { -pressure };
            net += contact.direction * on_first;
        }
        if overlap > T::zero() {
            // The first step stands for those before it.
            let newest = if self.lowest.value.is_finite() { T::of(NEWEST) } else { T::one() };
            self.net_push += (net / overlap - self.net_push) * newest;
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

    /// Begins, or begins anew, to escape along `away`.
    pub(super) fn start_to_escape(&mut self, away: Vector3<T>) {
        *self = Self { escape: Some(away), ..Self::default() };
    }

    /// Takes note of how deep the escaping pair still is; gives whether it has long been held fast.
    pub(super) fn observe_escape(&mut self, depth: T) -> bool {
        self.lowest.follow(depth, T::of(0.9));
        self.lowest.steps >= STEPS_TO_TURN
    }
}
