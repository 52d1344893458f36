use super::twist::{V3, angular, linear};

/// How much a node moves a row; positive for the second body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) node: u32,
    /// Along the direction: weighs the row's own points.
    pub(super) along: f64,
    /// Across it: weighs the first body's point, of both bodies. Friction acts in one point, so that angular momentum is kept.
    pub(super) across: f64,
}

impl Entry {
    pub(super) fn largest(&self) -> f64 {
        self.along.abs().max(self.across.abs())
    }
}

/// How a rigid body moves a row: velocity = sign · (linear + angular × arm).
#[derive(Clone, Copy, Debug)]
pub(super) struct RigidEnd {
    pub(super) index: usize,
    pub(super) sign: f64,
    pub(super) arm: V3,
}

impl RigidEnd {
    pub(super) fn velocity(&self, twists: &[f64]) -> V3 {
        let twist = &twists[6 * self.index..6 * self.index + 6];
        (linear(twist) + angular(twist).cross(&self.arm)) * self.sign
    }

    /// Adds the load of a force that acts on the second body's point, and against it on the first's.
    pub(super) fn add_load(&self, force: &V3, loads: &mut [f64]) {
        let torque = self.arm.cross(force);
        for axis in 0..3 {
            loads[6 * self.index + axis] += self.sign * force[axis];
            loads[6 * self.index + 3 + axis] += self.sign * torque[axis];
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

/// A row's force between two linearisations: it is linear in the velocities.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LinearForce {
    pub(super) pushes: bool,
    /// The slip at which the force is `push` and `pull`.
    pub(super) at: Slip,
    /// The force on the first body along the direction, in N, and across it.
    pub(super) push: f64,
    pub(super) pull: V3,
    /// The derivatives of both by the slip, in N s/m.
    pub(super) normal: f64,
    pub(super) tangential: f64,
}

impl LinearForce {
    /// The force on the first body at a slip, for a row in this direction.
    pub(super) fn force_at(&self, direction: &V3, slip: &Slip) -> V3 {
        let Self { at, push, pull, normal, tangential, .. } = self;
        direction * (push + normal * (slip.along - at.along)) + pull + (slip.across - at.across) * *tangential
    }
}

/// One contact as a unilateral spring with friction. Its force acts on the first body, and the opposite on the second.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Row {
    /// Of unit length; the first body is pushed along it.
    pub(super) direction: V3,
    /// In N/m.
    pub(super) coefficient: f64,
    /// The depth that the step is to undo, in m, where detection had the bodies.
    pub(super) depth: f64,
    /// Longer in an impact.
    pub(super) damping_time: f64,
    pub(super) friction: f64,
    /// The index of its pair among the pairs of this step.
    pub(crate) pair: usize,
    /// 1 where the bodies stand in the pair's order, −1 where the other way round.
    pub(crate) order: f64,
    /// The slip of the predicted motion, with which detection moved the bodies.
    pub(super) ahead: Slip,
    /// The slip across the direction at the start of the step.
    pub(super) sliding: V3,
    /// The friction spring where detection had the bodies: from the first body's point to its anchor.
    pub(super) stretch: V3,
    /// The index of its anchor among those of this step, if it can rub.
    pub(super) anchor: Option<usize>,
    /// The slip by bodies that the host moves.
    pub(super) given: V3,
    pub(super) rigid: [Option<RigidEnd>; 2],
    /// Its entries end here, and begin where those of the row before end.
    pub(super) end: usize,
    pub(super) linear: LinearForce,
}

/// A row that pushes: the derivative of its linear force.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spring {
    pub(super) direction: V3,
    /// By the slip along the direction and across it, in N s/m.
    pub(super) normal: f64,
    pub(super) tangential: f64,
    /// Its row, and the range of its entries.
    pub(super) row: usize,
    pub(super) begin: usize,
    pub(super) end: usize,
    pub(super) has_rigid_ends: bool,
}

impl Row {
    /// Adds what the row's force on its first body does to those of its bodies that are rigid.
    pub(super) fn add_rigid_loads(&self, force: &V3, loads: &mut [f64]) {
        self.rigid.iter().flatten().for_each(|end| end.add_load(&-force, loads));
    }

    /// The depth that a step is to undo. The cap limits the depth of the pressure, `depth` · `cos_alpha`, that there was at the
    /// start of the step; what bodies close within the step is undone in full.
    pub(super) fn capped(depth: f64, cos_alpha: f64, closed: f64, cap: f64) -> f64 {
        let most = cap / cos_alpha + closed;
        if depth > most { most } else { depth }
    }

    /// The force along the direction at a slip, before it is known that it pushes.
    pub(super) fn push_at(&self, along: f64, dt: f64) -> f64 {
        self.coefficient * (self.depth + dt * (along - self.ahead.along) + self.damping_time * along)
    }

    /// The friction spring at the end of the step.
    pub(super) fn stretch_at(&self, across: &V3, dt: f64) -> V3 {
        self.stretch + (across - self.ahead.across) * dt
    }

    /// The row's force, linear about a slip, without friction.
    pub(super) fn linear_at(&self, slip: Slip, dt: f64) -> LinearForce {
        let push = self.push_at(slip.along, dt);
        LinearForce {
            pushes: push > 0.0,
            at: slip,
            push,
            pull: V3::zeros(),
            normal: self.coefficient * (dt + self.damping_time),
            tangential: 0.0,
        }
    }

    /// For a row of a loaded pair that is not predicted to push. The prediction knows no supports: a body that others hold up
    /// seems to leave what rests on it, faster by up to `gained`. If the row pushes without some of that speed, it keeps its
    /// law. Else it adds no force, but pushes if the solve brings the two together.
    pub(super) fn keep_loaded(&mut self, gained: f64, dt: f64) {
        let Slip { along, .. } = self.linear.at;
        if !(self.depth > 0.0 && self.coefficient > 0.0 && along < 0.0) {
            return;
        }
        self.linear.pushes = true;
        if -self.linear.push > self.linear.normal * gained {
            self.linear.push = 0.0;
            self.linear.normal = self.coefficient * (dt - self.depth / along);
        }
    }

    /// Adds the friction of a row that will bear `load`: a spring as stiff as the contact, or softer where it would pull by
    /// more than friction allows. `expected`: the length of the spring and its damper then, in m.
    pub(super) fn add_friction(&self, linear: &mut LinearForce, load: f64, expected: f64, dt: f64) {
        let most = self.friction * load.max(0.0);
        let trial = self.coefficient * expected;
        let softer = if trial > most { self.coefficient * (most / trial) } else { self.coefficient };
        linear.pull = self.spring_at(&linear.at.across, dt) * softer;
        linear.tangential = softer * (dt + self.damping_time);
    }

    /// The friction spring with its damper, in m: the force over the coefficient, if nothing capped it.
    pub(super) fn spring_at(&self, across: &V3, dt: f64) -> V3 {
        self.stretch_at(across, dt) + across * self.damping_time
    }

    /// The length of [`spring_at`](Self::spring_at) that is expected before anything is solved. Surfaces go on as fast as at
    /// the start of the step; but a spring that had begun to slide ends as fast as friction alone leaves it, which takes `lost`
    /// of the free speed.
    pub(super) fn expected_spring(&self, load: f64, lost: f64, dt: f64) -> f64 {
        let expected = self.spring_at(&self.sliding, dt).norm();
        let start = self.stretch_at(&V3::zeros(), dt).norm();
        // A spring at its limit may be a little below it by rounding.
        if self.coefficient * start < 0.999_999 * self.friction * load {
            return expected;
        }
        let time = dt + self.damping_time;
        expected.max(start + time * (self.linear.at.across.norm() - self.friction * lost))
    }

    /// The linear force on the first body at a slip.
    pub(super) fn force_at(&self, slip: &Slip) -> V3 {
        self.linear.force_at(&self.direction, slip)
    }

    /// What a change of its rigid bodies' velocities adds to the force on the first body.
    pub(super) fn force_by_rigid(&self, changes: &[f64]) -> V3 {
        let change = self.rigid.iter().flatten().fold(V3::zeros(), |sum, end| sum + end.velocity(changes));
        let LinearForce { normal, tangential, .. } = self.linear;
        self.direction * (normal * self.direction.dot(&change)) + self.across(&change) * tangential
    }

    /// The potentials of a force along the direction and across it, where the row has a stiffness.
    pub(super) fn energies(&self, force: &V3, dt: f64) -> impl Iterator<Item = f64> + use<> {
        let (along, across) = (self.direction.dot(force), self.across(force));
        let both = [(along * along, self.linear.normal), (across.norm_squared(), self.linear.tangential)];
        both.into_iter().filter(|both| both.1 > 0.0).map(move |(square, stiffness)| 0.5 * dt * square / stiffness)
    }

    pub(super) fn across(&self, u: &V3) -> V3 {
        u - self.direction * self.direction.dot(u)
    }
}
