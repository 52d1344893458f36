use crate::contact::Contact;
use crate::math::{Scalar, Vector3, length};
use std::fmt;

/// What a contact's stiffness is multiplied with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Weighting {
    /// The area the ray stands for: stiffness is in N/m³, and the net force does not depend on the triangulation.
    #[default]
    Area,
    /// Nothing, as in the paper: stiffness is in N/m per ray, and a finer mesh is a stiffer one.
    Vertex,
}

/// How strongly contacts push and rub.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PenaltyLaw {
    stiffness: f64,
    damping_time: f64,
    weighting: Weighting,
    friction: f64,
    slip_speed: f64,
}

/// Why a law was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LawError {
    /// Negative or not finite.
    Stiffness(f64),
    /// Negative or not finite.
    DampingTime(f64),
    /// Negative or not finite.
    Friction(f64),
    /// Not above 0 where there is friction, or not finite.
    SlipSpeed(f64),
}

impl fmt::Display for LawError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stiffness(value) => write!(f, "stiffness is {value}; it must be a finite number ≥ 0"),
            Self::DampingTime(value) => write!(f, "damping_time is {value}; it must be a finite number of seconds ≥ 0"),
            Self::Friction(value) => write!(f, "friction is {value}; it must be a finite number ≥ 0"),
            Self::SlipSpeed(value) => write!(
                f,
                "slip_speed is {value}; it must be a finite number of m/s, above 0 where there is friction: how fast contacts at \
                 rest may creep, such as a thousandth of the speeds that matter"
            ),
        }
    }
}

impl std::error::Error for LawError {}

impl PenaltyLaw {
    /// A law with `stiffness` k (N/m³ or N/m, as `weighting` says) and damping k · `damping_time` along the ray, the
    /// time in seconds; without friction.
    ///
    /// # Errors
    /// [`LawError`] where a number is negative or not finite.
    pub fn new(stiffness: f64, damping_time: f64, weighting: Weighting) -> Result<Self, LawError> {
        if !is_valid(stiffness) {
            return Err(LawError::Stiffness(stiffness));
        }
        if !is_valid(damping_time) {
            return Err(LawError::DampingTime(damping_time));
        }
        Ok(Self { stiffness, damping_time, weighting, friction: 0.0, slip_speed: 0.0 })
    }

    /// The same law with Coulomb friction that needs no memory: a function of the velocities alone, for integrators that choose
    /// their own steps. It is regularised by the square root (Wriggers 2006, Computational Contact Mechanics, section 5.2): a
    /// contact that pushes by N rubs by μ cos α N v / √(v² + s²) against its slip v across the ray, with μ = `friction` and
    /// s = `slip_speed` in m/s. A contact whose friction has to bear a part p < μ of N creeps at s p / √(μ² − p²). As in the
    /// contact system, μ applies to the part of the push that goes straight into the other surface.
    ///
    /// # Errors
    /// [`LawError`] where a number is negative or not finite, or where there is friction and the slip speed is 0.
    pub fn with_friction(self, friction: f64, slip_speed: f64) -> Result<Self, LawError> {
        if !is_valid(friction) {
            return Err(LawError::Friction(friction));
        }
        if !is_valid(slip_speed) || friction > 0.0 && slip_speed == 0.0 {
            return Err(LawError::SlipSpeed(slip_speed));
        }
        Ok(Self { friction, slip_speed, ..self })
    }

    /// The stiffness in N/m³; `None` where contacts are not weighted by their area.
    pub(crate) fn stiffness_of_area(&self) -> Option<f64> {
        (self.weighting == Weighting::Area).then_some(self.stiffness)
    }

    /// The damping's time constant, in seconds.
    pub fn damping_time(&self) -> f64 {
        self.damping_time
    }

    /// The coefficient of friction.
    pub fn friction(&self) -> f64 {
        self.friction
    }

    /// The spring coefficient of one contact, in N/m: stiffness · weight · cos α.
    pub fn coefficient<T: Scalar>(&self, contact: &Contact<T>) -> T {
        self.weighted_stiffness(contact) * contact.cos_alpha
    }

    /// Stiffness · weight, in N/m.
    pub(super) fn weighted_stiffness<T: Scalar>(&self, contact: &Contact<T>) -> T {
        let weight = match self.weighting {
            Weighting::Area => contact.area,
            Weighting::Vertex => T::one(),
        };
        T::of(self.stiffness) * weight
    }

    /// The force on the first end of a contact: `push` along its direction, and friction across it. `velocity` is that of the
    /// second end, relative to the first.
    pub(super) fn force<T: Scalar>(
        &self,
        direction: &Vector3<T>,
        cos_alpha: T,
        push: T,
        velocity: &Vector3<T>,
    ) -> Vector3<T> {
        let along = direction * push;
        if self.friction == 0.0 || push <= T::zero() {
            return along;
        }
        // In double precision, where no slip speed is lost.
        let slip = (velocity - direction * velocity.dot(direction)).map(T::to_f64);
        let rubbing = slip / length(&slip).hypot(self.slip_speed) * self.friction;
        along + rubbing.map(T::of) * (push * cos_alpha)
    }
}

fn is_valid(value: f64) -> bool {
    value.is_finite() && value >= 0.0
}
