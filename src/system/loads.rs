//! The load of each pair of bodies, which limits its friction: how much of the predicted push is left after the solve.

use super::Material;
use super::twist::V3;
use crate::memory::Room;

/// A stiff contact predicts far more than it will bear, because the solve lets bodies give way. Of the predicted push, pairs in
/// contact keep the fraction of the step before; new ones keep what two rigid bodies would.
#[derive(Debug, Default)]
pub(crate) struct PairLoads {
    /// Of the step before, in order.
    before: Vec<PairLoad>,
    /// Of this one, in the order in which rows came.
    pub(crate) now: Vec<PairLoad>,
}

/// What a body rubs on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Surface {
    /// The body of this number.
    Body(u32),
    /// The half-space of this number.
    HalfSpace(u32),
}

/// The bodies of a row, in its order or, for its pair, in ascending order.
pub(crate) type Key = (u32, Surface);

#[derive(Clone, Copy, Debug)]
pub(crate) struct PairLoad {
    pub(crate) key: Key,
    pub(super) material: Material,
    /// The sum of both bodies' 1/mass.
    pub(super) inverse_mass: f64,
    /// The push of all its rows in N, as predicted; their stiffness in N s/m; and the push in N after the solve.
    predicted: f64,
    normal: f64,
    solved: f64,
    /// The pushes of all rows that are left positive once bodies have given way.
    relieved: f64,
    /// On the first body, in N.
    force: V3,
    /// The push of the step before: predicted, and after the solve.
    then: Option<(f64, f64)>,
    /// The friction springs at the end of this step, and of the one before.
    springs: Springs,
    springs_then: Springs,
    /// The stiffness of this step's friction springs: of those kept from the step before, and of the new ones.
    kept: f64,
    new: f64,
    pub(super) wander: Wander,
}

/// How fast a pair's surfaces close at the start of the step, and how fast as seen by an observer who moves along with the
/// contact, as with that of a ball that rolls. The observer sees what presses bodies together, and not the shape that passes
/// by. It moves with the centre of one body or the other, or between the two: whichever sees least.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wander {
    /// Sums over rows of coefficient · speed², in N m/s²: at rest, with the first body, with the second, and of the product of
    /// these two. They are apart for rows whose bodies stand in the pair's order and for the others, so that it does not matter
    /// which body comes first.
    sums: [[f64; 4]; 2],
}

impl Wander {
    pub(super) fn add(&mut self, order: f64, coefficient: f64, closing: f64, [first, second]: [f64; 2]) {
        let numbers = [closing * closing, first * first, second * second, first * second];
        let sums = &mut self.sums[usize::from(order < 0.0)];
        sums.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += coefficient * number);
    }

    /// The fraction of the pair's damping that takes motion of the two against one another.
    pub(super) fn damped_fraction(&self) -> f64 {
        let [closing, first, second, product] = std::array::from_fn(|k| self.sums[0][k] + self.sums[1][k]);
        let least = first.min(second);
        // Between the two the least is that of a parabola.
        let seen = if product < least {
            (first * second - product * product).max(0.0) / (first + second - 2.0 * product)
        } else {
            least
        };
        // Squared, because the facets of a round body leave a little even when it rolls.
        if seen < closing { (seen / closing).powi(2) } else { 1.0 }
    }
}

/// The sum of a pair's friction springs.
#[derive(Clone, Copy, Debug, Default)]
struct Springs {
    /// In N/m.
    coefficient: f64,
    /// What they pull with, in N.
    pull: V3,
}

impl PairLoads {
    /// A pair's index in this step, in either order of its bodies; `new` gives its material and 1/mass for its first row.
    pub(super) fn index_of(&mut self, key: Key, new: impl FnOnce() -> (Material, f64)) -> usize {
        let (key, _) = in_order(key);
        // From the end, since rows of one pair come one after the other.
        if let Some(index) = self.now.iter().rposition(|pair| pair.key == key) {
            return index;
        }
        let (material, inverse_mass) = new();
        let load = PairLoad::new(key, material, inverse_mass, self.before(key));
        self.now.room_for(1).push(load);
        self.now.len() - 1
    }

    pub(super) fn before_keys(&self) -> impl ExactSizeIterator<Item = Key> + '_ {
        self.before.iter().map(|pair| pair.key)
    }

    fn before(&self, key: Key) -> Option<&PairLoad> {
        self.before.binary_search_by_key(&key, |pair| pair.key).ok().map(|index| &self.before[index])
    }

    /// What is remembered of a pair from the step before: the push predicted and after the solve, and its springs.
    pub(crate) fn remembered(&self, key: Key) -> Option<[f64; 6]> {
        let PairLoad { predicted, solved, springs: Springs { coefficient, pull }, .. } = *self.before(key)?;
        Some([predicted, solved, coefficient, pull.x, pull.y, pull.z])
    }

    /// The net force on the first of the pair in the step before.
    pub(super) fn force(&self, key: Key) -> V3 {
        let (key, turned) = in_order(key);
        self.before(key).map_or_else(V3::zeros, |pair| pair.force) * if turned { -1.0 } else { 1.0 }
    }

    /// Replaces it; the two bodies in either order.
    pub(crate) fn put(&mut self, key: Key, [predicted, solved, coefficient, x, y, z]: [f64; 6]) {
        let (key, turned) = in_order(key);
        let pull = V3::new(x, y, z) * if turned { -1.0 } else { 1.0 };
        let springs = Springs { coefficient, pull };
        let material =
            Material { stiffness: 0.0, damping_time: 0.0, friction: 0.0, depth_cap: f64::INFINITY, restitution: 0.0 };
        let pair = PairLoad { predicted, solved, springs, ..PairLoad::new(key, material, 0.0, None) };
        match self.before.binary_search_by_key(&key, |pair| pair.key) {
            Ok(index) => self.before[index] = pair,
            Err(index) => self.before.room_for(1).insert(index, pair),
        }
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

/// The smaller number first, and whether that turns the pair around.
pub(super) fn in_order(key: Key) -> (Key, bool) {
    match key {
        (first, Surface::Body(second)) if second < first => ((second, Surface::Body(first)), true),
        key => (key, false),
    }
}

impl PairLoad {
    fn new(key: Key, material: Material, inverse_mass: f64, before: Option<&Self>) -> Self {
        Self {
            key,
            material,
            inverse_mass,
            predicted: 0.0,
            normal: 0.0,
            solved: 0.0,
            relieved: 0.0,
            force: V3::zeros(),
            then: before.map(|pair| (pair.predicted, pair.solved)),
            springs: Springs::default(),
            springs_then: before.map(|pair| pair.springs).unwrap_or_default(),
            kept: 0.0,
            new: 0.0,
            wander: Wander::default(),
        }
    }

    pub(super) fn add_predicted(&mut self, push: f64, normal: f64) {
        self.predicted += push;
        self.normal += normal;
    }

    /// Once all is predicted.
    pub(super) fn add_relieved(&mut self, push: f64, normal: f64) {
        self.relieved += self.relieved_push(push, normal);
    }

    /// The fraction of its predicted push that the step before left.
    fn fraction_left(&self) -> f64 {
        self.then.map_or(1.0, |(predicted, solved)| (solved / predicted).clamp(0.0, 1.0))
    }

    /// What is left of a row's push: where bodies give way, all rows lose the same depth, not the same fraction.
    fn relieved_push(&self, push: f64, normal: f64) -> f64 {
        (push - self.predicted * (1.0 - self.fraction_left()) * normal / self.normal).max(0.0)
    }

    pub(super) fn add_solved(&mut self, push: f64, force: &V3) {
        self.solved += push;
        self.force += force;
    }

    /// A friction spring as it is at the end of the step.
    pub(super) fn add_spring(&mut self, coefficient: f64, stretch: &V3) {
        self.springs.coefficient += coefficient;
        self.springs.pull += stretch * coefficient;
    }

    /// A friction spring of this step.
    pub(super) fn count_spring(&mut self, coefficient: f64, is_new: bool) {
        *if is_new { &mut self.new } else { &mut self.kept } += coefficient;
    }

    /// The stretch with which a new spring begins: where rays start from other points than in the step before, the new springs
    /// take over the pull of those that are gone, and never more.
    pub(super) fn inherited(&self) -> V3 {
        let Springs { coefficient, pull } = self.springs_then;
        let lost = coefficient - self.kept;
        if !(lost > 0.0 && self.new > 0.0) {
            return V3::zeros();
        }
        pull / coefficient * (lost / self.new).min(1.0)
    }

    /// Whether the pair carried a load in the step before.
    pub(super) fn is_loaded(&self) -> bool {
        self.then.is_some_and(|(_, solved)| solved > 0.0)
    }

    /// The load expected of a row with this predicted push and the stiffness `normal`, from that of its pair.
    pub(super) fn load(&self, push: f64, normal: f64, dt: f64) -> f64 {
        match self.then {
            Some((_, solved)) if self.predicted <= 0.0 => solved * normal / self.normal,
            Some((predicted, _)) if predicted > 0.0 => match self.relieved_push(push, normal) {
                load if load > 0.0 => load * (self.predicted * self.fraction_left() / self.relieved),
                _ => 0.0,
            },
            _ => push / (1.0 + dt * self.normal * self.inverse_mass),
        }
    }

    /// How much speed, in m/s, the pair's load could take off its relative motion in one step.
    pub(super) fn speed_lost(&self, dt: f64) -> f64 {
        self.then.map_or(0.0, |(_, solved)| solved * self.inverse_mass * dt)
    }
}
