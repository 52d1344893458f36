//! The penalty response: forces, their differential, and the energy, all with the contacts held.
//!
//! Between detections a contact is a spring between two points that move with their triangles. With the direction d,
//! the depth δ = (p2 − p1)·d at the present positions and the coefficient c = k · weight · cos α, the force on p1 is
//! c (δ + τ δ̇) d and that on p2 its opposite; each is spread over its triangle's vertices by the barycentric weights
//! (Hermann, Faure, Raffin 2008, section 4). A contact that stands for many triangles presses on all their vertices, by area,
//! and the opposite lies on about as much of the other surface around p2, so that the pair gets no net force or torque.
//! The energy is ½ Σ c δ², and the elastic force its negative gradient. The differential is the rank-one part along d, which is
//! negative semi-definite. The turning of d with the surface is left out of it, so that conjugate gradients may be used, and so
//! is friction.
//!
//! Functions panic where a body or vertex of a contact lies beyond the arrays that they are given.

mod differential;
mod law;
mod rigid;
mod vectors;

pub(crate) use differential::{Between, add_whole_differential};
pub use law::{LawError, PenaltyLaw, Weighting};
pub use rigid::{RigidMotion, add_wrenches};
pub use vectors::{BodiesMut, Vectors, VectorsMut};

use crate::contact::{Contact, ContactList, WeightedVertices};
use crate::math::{Scalar, Vector3};

/// A contact as a spring.
struct Spring<'a, T: Scalar> {
    contact: &'a Contact<T>,
    /// The weighted vertices that its ends bear on, and how far these were apart along the direction at detection.
    vertices: [WeightedVertices<'a, T>; 2],
    gap: T,
    coefficient: T,
}

impl<'a, T: Scalar> Spring<'a, T> {
    fn new(list: &'a ContactList<T>, contact: &'a Contact<T>, law: &PenaltyLaw) -> Self {
        let (vertices, gap) = (list.spreads.vertices_of(contact), list.spreads.gap(contact));
        Self { contact, vertices, gap, coefficient: law.coefficient(contact) }
    }

    /// u2 − u1, for a field u given at the vertices of each body.
    fn between<V: Vectors<T>>(&self, bodies: &[V]) -> Vector3<T> {
        let Contact { colliding, collided, .. } = self.contact;
        let [first, second] = [0, 1].map(|end| {
            let (field, mut sum) = (&bodies[[*colliding, *collided][end] as usize], Vector3::zeros());
            self.vertices[end].for_each(|vertex, weight| sum += field.get(vertex) * weight);
            sum
        });
        second - first
    }

    /// The part of u2 − u1 along the direction.
    fn along<V: Vectors<T>>(&self, bodies: &[V]) -> T {
        self.between(bodies).dot(&self.contact.direction)
    }

    /// The contact's depth at these positions.
    fn depth<V: Vectors<T>>(&self, positions: Option<&[V]>) -> T {
        let depth = self.contact.depth;
        positions.map_or(depth, |positions| self.along(positions) - self.gap + depth)
    }

    /// Pulls the first end by the force and the second against it.
    fn pull<F: BodiesMut<T> + ?Sized>(&self, force: Vector3<T>, forces: &mut F) {
        let Contact { colliding, collided, .. } = self.contact;
        for (end, (body, force)) in [(colliding, force), (collided, -force)].into_iter().enumerate() {
            self.vertices[end].for_each(|vertex, weight| {
                if weight != T::zero() {
                    forces.add_to(*body, vertex, force * weight);
                }
            });
        }
    }
}

/// Adds the forces of a list's contacts to `forces`, which holds one array per body, as do `positions` (`None`: as at detection)
/// and `velocities` (`None`: no damping and no friction). Friction acts at both ends, so it keeps momentum but gives the pair a
/// net torque, depth times friction; [`add_wrenches`] keeps angular momentum too.
pub fn add_forces<T: Scalar, P: Vectors<T>, F: BodiesMut<T> + ?Sized>(
    list: &ContactList<T>,
    law: &PenaltyLaw,
    positions: Option<&[P]>,
    velocities: Option<&[P]>,
    forces: &mut F,
) {
    add_forces_of(&list.contacts, list, law, positions, velocities, forces);
}

/// The same for some of the list's contacts.
pub(crate) fn add_forces_of<T: Scalar, P: Vectors<T>, F: BodiesMut<T> + ?Sized>(
    contacts: &[Contact<T>],
    list: &ContactList<T>,
    law: &PenaltyLaw,
    positions: Option<&[P]>,
    velocities: Option<&[P]>,
    forces: &mut F,
) {
    let damping_time = T::of(law.damping_time());
    for contact in contacts {
        let spring = Spring::new(list, contact, law);
        let velocity = velocities.map_or_else(Vector3::zeros, |velocities| spring.between(velocities));
        let stretch = spring.depth(positions) + damping_time * velocity.dot(&contact.direction);
        let push = spring.coefficient * stretch;
        spring.pull(law.force(&contact.direction, contact.cos_alpha, push, &velocity), forces);
    }
}

/// Adds `stiffness_factor` · (∂force/∂position) d + `damping_factor` · (∂force/∂velocity) d to `forces`, for the
/// displacements d, without friction; both Jacobians are negative semi-definite. For each iteration of implicit integrators.
pub fn add_differential<T: Scalar, P: Vectors<T>, F: BodiesMut<T> + ?Sized>(
    list: &ContactList<T>,
    law: &PenaltyLaw,
    stiffness_factor: f64,
    damping_factor: f64,
    displacements: &[P],
    forces: &mut F,
) {
    let factor = T::of(stiffness_factor + damping_factor * law.damping_time());
    for contact in &list.contacts {
        let spring = Spring::new(list, contact, law);
        spring.pull(contact.direction * (factor * spring.coefficient * spring.along(displacements)), forces);
    }
}

/// The energy stored in the contacts, ½ Σ c δ², at `positions` (`None`: as at detection).
pub fn energy<T: Scalar, P: Vectors<T>>(list: &ContactList<T>, law: &PenaltyLaw, positions: Option<&[P]>) -> T {
    let doubled = list.contacts.iter().fold(T::zero(), |sum, contact| {
        let spring = Spring::new(list, contact, law);
        let depth = spring.depth(positions);
        sum + spring.coefficient * depth * depth
    });
    doubled * T::of(0.5)
}
