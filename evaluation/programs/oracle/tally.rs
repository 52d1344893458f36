//! Sums over batches, whatever the order in which threads finish them.

use raycontact::math::Scalar;

/// A case in which the library is wrong.
#[derive(Clone, Debug)]
pub struct Failure {
    pub batch: u64,
    pub place: usize,
    pub text: String,
}

#[derive(Clone, Debug, Default)]
pub struct Tally {
    pub queries: u64,
    /// How often the nearest point was asked for.
    pub points: u64,
    pub missing: u64,
    pub spurious: u64,
    pub wrong: u64,
    pub leaks: u64,
    pub exact_decisions: u64,
    /// Largest distance between the two ways a hit names its point, in rounding units of the reach: f32, f64.
    pub point_errors: [f64; 2],
    /// Largest error of a distance to the nearest point, rounded up to a power of two, in the same units.
    pub distance_errors: [f64; 2],
    /// The first in the order of the queries.
    pub first_failure: Option<Failure>,
}

impl Tally {
    pub fn note_point_error<T: Scalar>(&mut self, error: f64) {
        let largest = &mut self.point_errors[usize::from(T::ROUNDING_UNIT.to_f64() < 1e-10)];
        *largest = largest.max(error);
    }

    pub fn note_distance_error<T: Scalar>(&mut self, error: f64) {
        let largest = &mut self.distance_errors[usize::from(T::ROUNDING_UNIT.to_f64() < 1e-10)];
        *largest = largest.max(error);
    }

    pub fn merge(self, other: Self) -> Self {
        let order = |failure: &Failure| (failure.batch, failure.place);
        Self {
            queries: self.queries + other.queries,
            points: self.points + other.points,
            missing: self.missing + other.missing,
            spurious: self.spurious + other.spurious,
            wrong: self.wrong + other.wrong,
            leaks: self.leaks + other.leaks,
            exact_decisions: self.exact_decisions + other.exact_decisions,
            point_errors: [0, 1].map(|i| self.point_errors[i].max(other.point_errors[i])),
            distance_errors: [0, 1].map(|i| self.distance_errors[i].max(other.distance_errors[i])),
            first_failure: self.first_failure.into_iter().chain(other.first_failure).min_by_key(order),
        }
    }

    pub fn faults(&self) -> u64 {
        self.missing + self.spurious + self.wrong + self.leaks
    }
}
