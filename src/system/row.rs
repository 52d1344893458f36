use super::twist::{V3, angular, linear};

/// A node's part in a row. Positive for the second body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) node: u32,
    /// At the row's own points.
    pub(super) along: f64,
    /// At the first body's point, of both bodies: friction acts in one point, so that angular momentum is kept.
    pub(super) across: f64,
}

impl Entry {
    pub(super) fn largest(&self) -> f64 {
        self.along.abs().max(self.across.abs())
    }
}

/// Where a rigid body takes part in a row: velocity = sign · (linear + angular × arm).
#[derive(Clone, Copy, Debug)]
pub(super) struct RigidEnd {
    pub(super) place: usize,
    pub(super) sign: f64,
    pub(super) arm: V3,
}

impl RigidEnd {
    pub(super) fn velocity(&self, twists: &[f64]) -> V3 {
        let twist = &twists[6 * self.place..6 * self.place + 6];
        (linear(twist) + angular(twist).cross(&self.arm)) * self.sign
    }

    /// Adds the load of a force on the row: what moves the body against it is its opposite.
    pub(super) fn add_load(&self, force: &V3, loads: &mut [f64]) {
        let torque = self.arm.cross(force);
        for axis in 0..3 {
            loads[6 * self.place + axis] += self.sign * force[axis];
            loads[6 * self.place + 3 + axis] += self.sign * torque[axis];
        }
    }
}

/// How the second point of a row moves against the first.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slip {
    /// Along the direction: how fast the depth grows, in m/s.
    pub(super) along: f64,
    /// Across it: of the second body where the first one's point is.
    pub(super) across: V3,
}

/// A row as it is held between two linearisations: its force is linear in the velocities.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Held {
    pub(super) pushes: bool,
    /// Where the force is as given here.
    pub(super) at: Slip,
    /// The force on the first body along the direction, in N, and across it.
    pub(super) push: f64,
    pub(super) pull: V3,
    /// The derivatives of both by the slip, in N s/m.
    pub(super) normal: f64,
    pub(super) tangential: f64,
}

impl Held {
    /// The force on the first body at a slip, for a row in this direction.
    pub(super) fn force_at(&self, direction: &V3, slip: &Slip) -> V3 {
        let Self { at, push, pull, normal, tangential, .. } = self;
        direction * (push + normal * (slip.along - at.along)) + pull + (slip.across - at.across) * *tangential
    }
}

/// One contact as a unilateral spring with friction. On the first body acts force, on the second its opposite.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Row {
    /// Of unit length; the first body is pushed along it.
    pub(super) direction: V3,
    /// In N/m.
    pub(super) coefficient: f64,
    /// What is asked of the step, in m, where detection had the bodies.
    pub(super) asked: f64,
    /// Longer in an impact.
    pub(super) damping_time: f64,
    pub(super) friction: f64,
    /// The place of its pair among the pairs of this step.
    pub(crate) pair: usize,
    /// 1 where the bodies stand in the pair's order, −1 where the other way round.
    pub(crate) order: f64,
    /// The slip with which detection moved the bodies on.
    pub(super) ahead: Slip,
    /// Across the direction, at the start of the step.
    pub(super) sliding: V3,
    /// Of the friction spring where detection had the bodies: from the first body's point to what it holds on to.
    pub(super) stretch: V3,
    /// Among the anchors of this step, where it can rub.
    pub(super) anchor: Option<usize>,
    /// Bodies moved by the host.
    pub(super) given: V3,
    pub(super) rigid: [Option<RigidEnd>; 2],
    /// Its entries end here, and begin where those of the row before end.
    pub(super) end: usize,
    pub(super) held: Held,
}

/// A row that pushes, as it is held: the derivative of its force.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spring {
    pub(super) direction: V3,
    /// By the slip along the direction and across it, in N s/m.
    pub(super) normal: f64,
    pub(super) tangential: f64,
    /// Its place among the rows, and those of its entries.
    pub(super) place: usize,
    pub(super) begin: usize,
    pub(super) end: usize,
    pub(super) has_rigid_ends: bool,
}

impl Row {
    /// Adds what the row's force on its first body does to those of its bodies that are rigid.
    pub(super) fn add_rigid_loads(&self, force: &V3, loads: &mut [f64]) {
        self.rigid.iter().flatten().for_each(|end| end.add_load(&-force, loads));
    }

    /// The depth that a step asks for: the cap is on the depth of the pressure, `depth` · `cos_alpha`, and is for what there
    /// was at the start of the step. What bodies close within it is met in full.
    pub(super) fn asked(depth: f64, cos_alpha: f64, closing: f64, cap: f64) -> f64 {
        let most = cap / cos_alpha + closing.max(0.0);
        if depth > most { most } else { depth }
    }

    /// The force along the direction at a slip, before it is known that it pushes.
    pub(super) fn push_at(&self, along: f64, dt: f64) -> f64 {
        self.coefficient * (self.asked + dt * (along - self.ahead.along) + self.damping_time * along)
    }

    /// The friction spring at the end of the step.
    pub(super) fn stretch_at(&self, across: &V3, dt: f64) -> V3 {
        self.stretch + (across - self.ahead.across) * dt
    }

    /// The row as it is held at a slip, without friction.
    pub(super) fn held_at(&self, slip: Slip, dt: f64) -> Held {
        let push = self.push_at(slip.along, dt);
        Held {
            pushes: push > 0.0,
            at: slip,
            push,
            pull: V3::zeros(),
            normal: self.coefficient * (dt + self.damping_time),
            tangential: 0.0,
        }
    }

    /// For a row that is not predicted to push. What rests on a body that its own support holds up only seems to be left by
    /// it, which is no reason to let go. Such a row adds no force yet, and pushes if the solve brings the two together. It
    /// keeps its law where losing part of `gained`, the speed by which the two part if nothing supports them, makes it push.
    pub(super) fn hold_loaded(&mut self, gained: f64, dt: f64) {
        let Slip { along, .. } = self.held.at;
        if !(self.asked > 0.0 && self.coefficient > 0.0 && along < 0.0) {
            return;
        }
        self.held.pushes = true;
        if -self.held.push > self.held.normal * gained {
            self.held.push = 0.0;
            self.held.normal = self.coefficient * (dt - self.asked / along);
        }
    }

    /// Adds friction where the row will bear `load`: a spring as stiff as the contact, or softer where it would pull by
    /// more than friction allows. `expected`: the length of the spring and its damper then, in m.
    pub(super) fn add_friction(&self, held: &mut Held, load: f64, expected: f64, dt: f64) {
        let most = self.friction * load.max(0.0);
        let trial = self.coefficient * expected;
        let softer = if trial > most { self.coefficient * (most / trial) } else { self.coefficient };
        held.pull = self.spring_at(&held.at.across, dt) * softer;
        held.tangential = softer * (dt + self.damping_time);
    }

    /// The friction spring with its damper, in m: the force over the coefficient, if nothing capped it.
    pub(super) fn spring_at(&self, across: &V3, dt: f64) -> V3 {
        self.stretch_at(across, dt) + across * self.damping_time
    }

    /// How long that is expected to be, before anything is solved: as fast as at the start of the step; a spring that had
    /// begun to slide is as fast at the end as friction alone leaves it, which takes `lost` of the free speed.
    pub(super) fn expected_spring(&self, load: f64, lost: f64, dt: f64) -> f64 {
        let expected = self.spring_at(&self.sliding, dt).norm();
        let start = self.stretch_at(&V3::zeros(), dt).norm();
        // Held to the cap, rounding may leave it below.
        if self.coefficient * start < 0.999_999 * self.friction * load {
            return expected;
        }
        let time = dt + self.damping_time;
        expected.max(start + time * (self.held.at.across.norm() - self.friction * lost))
    }

    /// The force on the first body at a slip, as the row is held.
    pub(super) fn force_at(&self, slip: &Slip) -> V3 {
        self.held.force_at(&self.direction, slip)
    }

    /// What a change of its rigid bodies' velocities adds to the force on the first body.
    pub(super) fn force_by_rigid(&self, changes: &[f64]) -> V3 {
        let change = self.rigid.iter().flatten().fold(V3::zeros(), |sum, end| sum + end.velocity(changes));
        let Held { normal, tangential, .. } = self.held;
        self.direction * (normal * self.direction.dot(&change)) + self.across(&change) * tangential
    }

    /// The potential along the direction and that across it, where it exerts a force.
    pub(super) fn energies(&self, force: &V3, dt: f64) -> impl Iterator<Item = f64> + use<> {
        let (along, across) = (self.direction.dot(force), self.across(force));
        let both = [(along * along, self.held.normal), (across.norm_squared(), self.held.tangential)];
        both.into_iter().filter(|both| both.1 > 0.0).map(move |(square, stiffness)| 0.5 * dt * square / stiffness)
    }

    pub(super) fn across(&self, u: &V3) -> V3 {
        u - self.direction * self.direction.dot(u)
    }
}
