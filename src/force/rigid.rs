use super::PenaltyLaw;
use crate::contact::{Contact, ContactList};
use crate::math::{Scalar, Vector3};

/// How a rigid body moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMotion {
    /// A point of it, such as its centre of mass.
    pub point: Vector3<f64>,
    /// That point's velocity, and the body's angular velocity in rad/s.
    pub velocity: [Vector3<f64>; 2],
}

impl RigidMotion {
    fn velocity_at(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.velocity[0] + self.velocity[1].cross(&(point - self.point))
    }
}

/// Gives `add` each contact's force on either body, and its torque about the point of the body's motion. The bodies move as
/// `motion` says. The law is that of [`add_forces`](super::add_forces) at the positions of detection, but a contact never pulls,
/// and all of it acts at the contact's first point: so a list's forces, and its torques about one point, add up to zero.
pub fn add_wrenches<T: Scalar>(
    list: &ContactList<T>,
    law: &PenaltyLaw,
    motion: impl Fn(u32) -> RigidMotion,
    mut add: impl FnMut(u32, [Vector3<f64>; 2]),
) {
    for contact in &list.contacts {
        let Contact { colliding, collided, direction, depth, cos_alpha, .. } = *contact;
        let [point, direction] = [contact.p1.position, direction].map(|vector| vector.map(T::to_f64));
        let motions = [colliding, collided].map(&motion);
        let velocity = motions[1].velocity_at(&point) - motions[0].velocity_at(&point);
        let stretch = depth.to_f64() + law.damping_time() * velocity.dot(&direction);
        // NaN stays, for callers to see.
        let stretch = if stretch < 0.0 { 0.0 } else { stretch };
        let push = law.coefficient(contact).to_f64() * stretch;
        let force = law.force(&direction, cos_alpha.to_f64(), push, &velocity);
        for (body, motion, force) in [(colliding, motions[0], force), (collided, motions[1], -force)] {
            add(body, [force, (point - motion.point).cross(&force)]);
        }
    }
}
