use super::Contact;
use crate::math::{Scalar, Vector3};

/// What a pair of bodies remembers from step to step while their boxes overlap: whether it is escaping, and if not,
/// whether its overlap gets smaller. Forgotten when the bodies are apart. A host that saves and restores its own state
/// saves and restores this with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairMemory<T: Scalar> {
    /// The direction in which the first body leaves the second, of unit length; `None` while contacts do.
    pub escape: Option<Vector3<T>>,
    /// The smallest Σ area · depth · cos α so far, and for how many steps none was smaller by a tenth.
    lowest: (T, u32),
    /// The last Σ area · depth · cos α that was half of the one before it, and for how many steps none has been.
    halved: (T, u32),
}

impl<T: Scalar> Default for PairMemory<T> {
    fn default() -> Self {
        Self { escape: None, lowest: (T::INFINITY, 0), halved: (T::INFINITY, 0) }
    }
}

/// Steps without a smaller overlap after which deep contacts are stuck.
const STEPS_TO_A_NEW_LOW: u32 = 8;
/// Steps without a halved overlap after which contacts that push against each other are jammed.
const STEPS_TO_HALVE: u32 = 24;

/// How the overlap of a pair has come along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Progress {
    /// It gets smaller, or is pressed together by a load.
    Fine,
    /// It has not got smaller for some steps: stuck, if there are contacts deeper than half the body is thick.
    Slow,
    /// It does not get smaller, and the contacts push against each other.
    Jammed,
}

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
        Self::follow(&mut self.lowest, overlap, T::of(0.9));
        Self::follow(&mut self.halved, overlap, T::of(0.5));
        // A loaded contact at rest has a net force; a jam has none.
        if self.halved.1 >= STEPS_TO_HALVE && net.norm() <= overlap * T::of(0.3) {
            Progress::Jammed
        } else if self.lowest.1 >= STEPS_TO_A_NEW_LOW {
            Progress::Slow
        } else {
            Progress::Fine
        }
    }

    fn follow(record: &mut (T, u32), overlap: T, factor: T) {
        *record = if overlap <= record.0 * factor { (overlap, 0) } else { (record.0, record.1.saturating_add(1)) };
    }
}
