//! The penalty response: forces, their differential, and the energy, all with the contacts held.
//!
//! Between detections a contact is a spring between two points that move with their triangles. With the direction d,
//! the depth δ = (p2 − p1)·d at the present positions and the coefficient c = k · weight · cos α, the force on p1 is
//! c (δ + τ δ̇) d and that on p2 its opposite; each is spread over its triangle's vertices by the barycentric weights
//! (Hermann, Faure, Raffin 2008, section 4). The energy is ½ Σ c δ², so the elastic force is its negative gradient.
//! The differential is the rank-one part along d, positive semi-definite up to its sign: the turning of d with the
//! surface is left out, so that conjugate gradients may be used.

mod law;
mod pair_forces;
mod vectors;

pub use law::{LawError, PenaltyLaw, Weighting};
pub use pair_forces::{ForcesByPair, PairForces};
pub use vectors::{BodiesMut, Vectors, VectorsMut};

use crate::contact::{Contact, SurfacePoint};
use crate::math::{Scalar, Vector3};

/// A contact as a spring.
struct Spring<'a, T: Scalar> {
    contact: &'a Contact<T>,
    coefficient: T,
}

impl<'a, T: Scalar> Spring<'a, T> {
    fn new(contact: &'a Contact<T>, law: &PenaltyLaw) -> Self {
        Self { contact, coefficient: law.coefficient(contact) }
    }

    /// (u2 − u1)·d, for a field u given at the vertices of each body.
    fn closing<V: Vectors<T>>(&self, bodies: &[V]) -> T {
        let at = |point: &SurfacePoint<T>, body: u32| {
            let field = &bodies[body as usize];
            (0..3).fold(Vector3::zeros(), |sum, i| sum + field.get(point.vertices[i]) * point.weights[i])
        };
        let Contact { p1, p2, colliding, collided, direction, .. } = self.contact;
        (at(p2, *collided) - at(p1, *colliding)).dot(direction)
    }

    /// The contact's depth, and what has been added to it since detection.
    fn depth<V: Vectors<T>>(&self, positions: Option<&[V]>) -> T {
        let Contact { p1, p2, direction, depth, .. } = self.contact;
        positions
            .map_or(*depth, |positions| self.closing(positions) - (p2.position - p1.position).dot(direction) + *depth)
    }

    /// Pulls p1 along the direction and p2 against it.
    fn pull<F: BodiesMut<T> + ?Sized>(&self, force: T, forces: &mut F) {
        let Contact { p1, p2, colliding, collided, direction, .. } = self.contact;
        for (point, body, force) in [(p1, colliding, *direction * force), (p2, collided, *direction * -force)] {
            for i in 0..3 {
                if point.weights[i] != T::zero() {
                    forces.add_to(*body, point.vertices[i], force * point.weights[i]);
                }
            }
        }
    }
}

/// Adds the forces of `contacts` to `forces`, which holds one array per body, as do `positions` (`None`: as at
/// detection) and `velocities` (`None`: no damping).
///
/// # Panics
/// Where a body or vertex of a contact lies beyond the given arrays.
pub fn add_forces<T: Scalar, P: Vectors<T>, F: BodiesMut<T> + ?Sized>(
    contacts: &[Contact<T>],
    law: &PenaltyLaw,
    positions: Option<&[P]>,
    velocities: Option<&[P]>,
    forces: &mut F,
) {
    let damping_time = T::of(law.damping_time());
    for contact in contacts {
        let spring = Spring::new(contact, law);
        let closing_speed = velocities.map_or(T::zero(), |velocities| spring.closing(velocities));
        let stretch = spring.depth(positions) + damping_time * closing_speed;
        spring.pull(spring.coefficient * stretch, forces);
    }
}

/// Adds `stiffness_factor` · (∂force/∂position) d + `damping_factor` · (∂force/∂velocity) d to `forces`, for the
/// displacements d; both Jacobians are negative semi-definite. What an implicit integrator asks once per iteration.
///
/// # Panics
/// Where a body or vertex of a contact lies beyond the given arrays.
pub fn add_differential<T: Scalar, P: Vectors<T>, F: BodiesMut<T> + ?Sized>(
    contacts: &[Contact<T>],
    law: &PenaltyLaw,
    stiffness_factor: f64,
    damping_factor: f64,
    displacements: &[P],
    forces: &mut F,
) {
    let factor = T::of(stiffness_factor + damping_factor * law.damping_time());
    for contact in contacts {
        let spring = Spring::new(contact, law);
        spring.pull(factor * spring.coefficient * spring.closing(displacements), forces);
    }
}

/// The energy stored in the contacts, ½ Σ c δ², at `positions` (`None`: as at detection).
///
/// # Panics
/// Where a body or vertex of a contact lies beyond the given arrays.
pub fn energy<T: Scalar, P: Vectors<T>>(contacts: &[Contact<T>], law: &PenaltyLaw, positions: Option<&[P]>) -> T {
    let doubled = contacts.iter().fold(T::zero(), |sum, contact| {
        let spring = Spring::new(contact, law);
        let depth = spring.depth(positions);
        sum + spring.coefficient * depth * depth
    });
    doubled * T::of(0.5)
}
