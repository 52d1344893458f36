//! How much of the push that a step predicts its solve leaves, for each pair of bodies: what friction must be told.

use super::Material;
use super::anchors::Surface;
use crate::memory::Room;

/// A stiff contact predicts far more than it will bear, because the solve lets bodies give way. Pairs that have been in
/// contact keep the share of the step before; new ones give way like two rigid bodies.
#[derive(Debug, Default)]
pub(super) struct PairLoads {
    /// Of the step before, in order.
    before: Vec<Pair>,
    /// Of this one, in the order in which rows came.
    pub(super) now: Vec<Pair>,
}

/// The bodies of a row.
pub(super) type Key = (u32, Surface);

#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) key: Key,
    pub(super) material: Material,
    /// 1/m of both, together.
    pub(super) inverse_mass: f64,
    /// In N: all that rows push by prediction, their stiffness in N s/m, and what the solve left.
    predicted: f64,
    normal: f64,
    solved: f64,
    /// Of the step before: predicted and left.
    then: Option<(f64, f64)>,
    /// How many rows it has.
    pub(super) rows: usize,
}

impl PairLoads {
    /// The place of a pair among those of this step; `new` where it is its first row.
    pub(super) fn place(&mut self, key: Key, new: impl FnOnce() -> (Material, f64)) -> usize {
        let is_it = |pair: &Pair| pair.key == key;
        // Rows of one pair come one after the other.
        if let Some(place) = self.now.last().filter(|pair| is_it(pair)).map(|_| self.now.len() - 1) {
            return place;
        }
        if let Some(place) = self.now.iter().position(is_it) {
            return place;
        }
        let (material, inverse_mass) = new();
        let then = self.before.binary_search_by_key(&key, |pair| pair.key).ok();
        let then = then.map(|place| (self.before[place].predicted, self.before[place].solved));
        let pair =
            Pair { key, material, inverse_mass, predicted: 0.0, normal: 0.0, solved: 0.0, then, rows: 0 };
        self.now.room_for(1).push(pair);
        self.now.len() - 1
    }

    pub(super) fn start_step(&mut self) {
        self.now.clear();
    }

    pub(super) fn finish_step(&mut self) {
        std::mem::swap(&mut self.before, &mut self.now);
        self.before.sort_unstable_by_key(|pair| pair.key);
        self.now.clear();
    }

    pub(super) fn forget(&mut self, is_gone: impl Fn(&Key) -> bool) {
        self.before.retain(|pair| !is_gone(&pair.key));
    }
}

impl Pair {
    pub(super) fn add_predicted(&mut self, push: f64, normal: f64) {
        self.predicted += push;
        self.normal += normal;
    }

    pub(super) fn add_solved(&mut self, push: f64) {
        self.solved += push;
    }

    /// Did the pair bear anything in the step before?
    pub(super) fn is_loaded(&self) -> bool {
        self.then.is_some_and(|(_, solved)| solved > 0.0)
    }

    /// What a row that predicts this push will bear: its part of the pair's, of stiffness `normal`.
    pub(super) fn load(&self, push: f64, normal: f64, dt: f64) -> f64 {
        match self.then {
            Some((_, solved)) if !(self.predicted > 0.0) => solved * normal / self.normal,
            Some((predicted, solved)) if predicted > 0.0 => push * (solved / predicted).clamp(0.0, 1.0),
            _ => push / (1.0 + dt * self.normal * self.inverse_mass),
        }
    }

    /// By what the two would slow one another down in a step if their load acted along their motion, in m/s.
    pub(super) fn speed_lost(&self, dt: f64) -> f64 {
        self.then.map_or(0.0, |(_, solved)| solved * self.inverse_mass * dt)
    }
}
