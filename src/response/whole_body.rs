//! Pushing escaping pairs as whole bodies. A body without stiffness of its own yields where its contacts push it, and
//! the rest of it stays inside; pushed by the same force at every vertex it keeps its shape and leaves.
//!
//! A push is one spring between the means of all vertices of the two bodies, along the pair's direction. Its coefficient
//! is the sum of those of the contacts it stands for, so the two bodies are pushed as hard either way.

use super::{BodiesMut, PenaltyLaw, Vectors};
use crate::contact::EscapePush;
use crate::math::{Scalar, Vector3};

/// (u1 − u0)·d of the means of a field u over the vertices of each body: what is to come from the depth, where the first
/// body moves along d.
fn closing<T: Scalar, V: Vectors<T>>(push: &EscapePush<T>, bodies: &[V]) -> T {
    let [first, second] = [0, 1].map(|end| {
        let field = &bodies[push.bodies[end] as usize];
        let sum = (0..push.vertex_counts[end]).fold(Vector3::zeros(), |sum, vertex| sum + field.get(vertex));
        sum / T::of(f64::from(push.vertex_counts[end]))
    });
    (second - first).dot(&push.direction)
}

fn depth<T: Scalar, V: Vectors<T>>(push: &EscapePush<T>, positions: Option<&[V]>) -> T {
    let at_detection = (push.centres[1] - push.centres[0]).dot(&push.direction);
    positions.map_or(push.depth, |positions| closing(push, positions) - at_detection + push.depth)
}

fn spread<T: Scalar, F: BodiesMut<T> + ?Sized>(push: &EscapePush<T>, force: T, forces: &mut F) {
    for (end, sign) in [(0, T::one()), (1, -T::one())] {
        let share = push.direction * (sign * force / T::of(f64::from(push.vertex_counts[end])));
        (0..push.vertex_counts[end]).for_each(|vertex| forces.add_to(push.bodies[end], vertex, share));
    }
}

/// Adds the forces of `pushes`, as [`add_forces`](super::add_forces) does those of contacts; nothing, unless the law
/// [pushes whole bodies](PenaltyLaw::pushing_whole_bodies).
///
/// # Panics
/// Where a body or vertex of a push lies beyond the given arrays.
pub fn add_push_forces<T: Scalar, P: Vectors<T>, F: BodiesMut<T> + ?Sized>(
    pushes: &[EscapePush<T>],
    law: &PenaltyLaw,
    positions: Option<&[P]>,
    velocities: Option<&[P]>,
    forces: &mut F,
) {
    let damping_time = T::of(law.damping_time());
    for push in law.effective(pushes) {
        let closing_speed = velocities.map_or(T::zero(), |velocities| closing(push, velocities));
        let stretch = depth(push, positions) + damping_time * closing_speed;
        spread(push, law.push_coefficient(push) * stretch, forces);
    }
}

/// Adds the differential of `pushes`, as [`add_differential`](super::add_differential) does that of contacts.
///
/// # Panics
/// Where a body or vertex of a push lies beyond the given arrays.
pub fn add_push_differential<T: Scalar, P: Vectors<T>, F: BodiesMut<T> + ?Sized>(
    pushes: &[EscapePush<T>],
    law: &PenaltyLaw,
    stiffness_factor: f64,
    damping_factor: f64,
    displacements: &[P],
    forces: &mut F,
) {
    let factor = T::of(stiffness_factor + damping_factor * law.damping_time());
    for push in law.effective(pushes) {
        spread(push, factor * law.push_coefficient(push) * closing(push, displacements), forces);
    }
}

/// The energy stored in `pushes`, as [`energy`](super::energy) is that of contacts.
///
/// # Panics
/// Where a body or vertex of a push lies beyond the given arrays.
pub fn push_energy<T: Scalar, P: Vectors<T>>(pushes: &[EscapePush<T>], law: &PenaltyLaw, positions: Option<&[P]>) -> T {
    let doubled = law.effective(pushes).iter().fold(T::zero(), |sum, push| {
        let depth = depth(push, positions);
        sum + law.push_coefficient(push) * depth * depth
    });
    doubled * T::of(0.5)
}
