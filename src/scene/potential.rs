use super::Scene;
use crate::contact::{Columns, Contact, ContactList, Pair, overlap_region};
use crate::force::{PenaltyLaw, energy};
use crate::math::Scalar;

impl<T: Scalar> Scene<T> {
    /// Finds the contacts as [`query`](Self::query) does, and gives the energy that bodies store where they are, in J. Under the
    /// pressure law it is the integral of the pressure over what they share. The forces are its negative gradient, so it differs
    /// between two queries by the work done between them. It is [`energy`] where there is no such integral: under the law of ray
    /// lengths, with rays from vertices, for open sheets and bodies with themselves, and where contacts are not weighted by area.
    /// An escape is no function of the positions; it counts as the energy of its springs.
    pub fn potential(&mut self, law: &PenaltyLaw, contacts: &mut ContactList<T>) -> f64 {
        self.query(contacts);
        match law.stiffness_of_area() {
            Some(stiffness) => self.potential_of(contacts, |_| [stiffness, f64::INFINITY]),
            None => energy::<T, Vec<_>>(contacts, law, None).to_f64(),
        }
    }

    /// The same for the newest query. `law`: a pair's stiffness, and the depth beyond which its pressure does not grow.
    pub(crate) fn potential_of(&self, contacts: &mut ContactList<T>, law: impl Fn([u32; 2]) -> [f64; 2]) -> f64 {
        contacts.sum_of_pairs(|pair, contacts, columns| {
            let [stiffness, cap] = law(pair);
            stiffness * self.potential_of_pair(pair, contacts, T::of(cap), columns).to_f64()
        })
    }

    fn potential_of_pair(&self, bodies: [u32; 2], contacts: &[Contact<T>], cap: T, columns: &mut Columns<T>) -> T {
        let tracers = bodies.map(|number| self.bodies.get(number).expect("its contacts were found").surface.tracer());
        let [first, second] = tracers.each_ref().map(|tracer| tracer.mesh().aabb());
        let (overlap, region) = overlap_region(first, second);
        let mut pair = Pair::new(bodies, tracers.each_ref(), [&overlap, &region], &self.options);
        if !pair.measures_distances() || bodies[0] == bodies[1] {
            pair.fixed_shares = None;
        }
        pair.potential(contacts, cap, columns)
    }
}
