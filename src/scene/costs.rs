//! What the newest query took, for hosts that balance work.

use super::bodies::{Bodies, Body};
use super::list::List;
use crate::math::Scalar;
use crate::memory::Room;

// What chose this number: docs/architecture.md, *Tuned constants*.

/// Reading this many triangles anew takes as long as one ray.
pub(super) const TRIANGLES_READ_PER_RAY: f64 = 50.0;

/// What a query took for one pair of bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairCost {
    /// The pair's bodies by number, the one that comes first in their order first.
    pub bodies: [u32; 2],
    /// The cost in rays, without reading the bodies' triangles: see [`Scene::body_cost`](super::Scene::body_cost).
    pub cost: f64,
}

impl<T: Scalar> Body<T> {
    /// What it costs to read it.
    pub(super) fn start_cost(&mut self) {
        let is_read = self.surface.mesh().pose().is_none();
        self.cost = if is_read { self.triangle_count() / TRIANGLES_READ_PER_RAY } else { 0.0 };
    }
}

impl<T: Scalar> Bodies<T> {
    /// Shares out what a list of contacts took, and notes it where it is a pair's.
    pub(super) fn add_cost(&mut self, list: &List, pairs: &[[u32; 2]], rays: u64, costs: &mut Vec<PairCost>) {
        let rays = rays as f64;
        match *list {
            List::Body(place) => self.list_mut()[place][0].cost += rays,
            List::Pair(place) => {
                let both = self.two_mut(pairs[place].map(|place| place as usize));
                // A foreign body's own scene does not learn of it.
                let share = if both.iter().any(|body| body.sharing.is_foreign) { rays } else { rays * 0.5 };
                costs.room_for(1).push(PairCost { bodies: both.each_ref().map(|body| body.number), cost: rays });
                both.into_iter().for_each(|body| body.cost += share);
            }
        }
    }
}
