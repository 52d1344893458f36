use super::Scene;
use crate::contact::{Contact, ContactList, Pair, PotentialRoom, overlap_region};
use crate::force::{PenaltyLaw, energy};
use crate::math::Scalar;

impl<T: Scalar> Scene<T> {
    /// Finds the contacts as [`query`](Self::query) does, and gives the energy that bodies store where they are, in J. Under the
    /// pressure law it is the integral of the pressure over what they share, of which the forces are the negative gradient: two
    /// queries at different positions differ in it by the work between. Where the law has no such integral, it is
    /// [`energy`]: by rays' own law, of rays from vertices, of open sheets, of bodies with themselves, and where contacts are
    /// not weighted by area. What an escape does is no energy of the positions; it counts as its springs do.
    pub fn potential(&mut self, law: &PenaltyLaw, contacts: &mut ContactList<T>) -> f64 {
        self.query(contacts);
        match law.stiffness_of_area() {
            Some(stiffness) => self.potential_of(contacts, |_| [stiffness, f64::INFINITY]),
            None => energy::<T, Vec<_>>(contacts, law, None).to_f64(),
        }
    }

    /// The same of the newest query, where each pair has a stiffness and a depth beyond which pressure does not grow.
    pub(crate) fn potential_of(&self, contacts: &mut ContactList<T>, law: impl Fn([u32; 2]) -> [f64; 2]) -> f64 {
        contacts.sum_of_pairs(|pair, contacts, room| {
            let [stiffness, cap] = law(pair);
            stiffness * self.potential_of_pair(pair, contacts, T::of(cap), room).to_f64()
        })
    }

    fn potential_of_pair(&self, bodies: [u32; 2], contacts: &[Contact<T>], cap: T, room: &mut PotentialRoom<T>) -> T {
        let tracers = bodies.map(|number| self.bodies.get(number).expect("its contacts were found").surface.tracer());
        let [first, second] = tracers.each_ref().map(|tracer| tracer.mesh().aabb());
        let (overlap, region) = overlap_region(first, second);
        let mut pair = Pair::new(bodies, tracers.each_ref(), [&overlap, &region], &self.options);
        if !pair.measures_distances() || bodies[0] == bodies[1] {
            pair.fixed_shares = None;
        }
        pair.potential(contacts, cap, room)
    }
}
