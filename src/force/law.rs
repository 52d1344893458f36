use crate::contact::Contact;
use crate::math::Scalar;
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

/// How strongly contacts push.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PenaltyLaw {
    stiffness: f64,
    damping_time: f64,
    weighting: Weighting,
}

/// Why a law was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LawError {
    /// Negative or not finite.
    Stiffness(f64),
    /// Negative or not finite.
    DampingTime(f64),
}

impl fmt::Display for LawError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stiffness(value) => write!(f, "stiffness is {value}; it must be a finite number ≥ 0"),
            Self::DampingTime(value) => write!(f, "damping_time is {value}; it must be a finite number of seconds ≥ 0"),
        }
    }
}

impl std::error::Error for LawError {}

impl PenaltyLaw {
    /// A law with `stiffness` k (N/m³ or N/m, as `weighting` says) and damping k · `damping_time` along the ray, the
    /// time in seconds.
    ///
    /// # Errors
    /// [`LawError`] where a number is negative or not finite.
    pub fn new(stiffness: f64, damping_time: f64, weighting: Weighting) -> Result<Self, LawError> {
        let valid = |value: f64| value.is_finite() && value >= 0.0;
        if !valid(stiffness) {
            return Err(LawError::Stiffness(stiffness));
        }
        if !valid(damping_time) {
            return Err(LawError::DampingTime(damping_time));
        }
        Ok(Self { stiffness, damping_time, weighting })
    }

    /// The damping's time constant, in seconds.
    pub fn damping_time(&self) -> f64 {
        self.damping_time
    }

    /// The spring coefficient of one contact, in N/m: stiffness · weight · cos α.
    pub fn coefficient<T: Scalar>(&self, contact: &Contact<T>) -> T {
        let weight = match self.weighting {
            Weighting::Area => contact.area,
            Weighting::Vertex => T::one(),
        };
        T::of(self.stiffness) * weight * contact.cos_alpha
    }
}
