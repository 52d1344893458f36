//! Velocities of rigid bodies: three numbers linear, three angular; of forces: force, torque.

use crate::math::{Vector3, margins};
use crate::memory;
use nalgebra::{Matrix3, Matrix6, Vector6};

pub(super) type V3 = Vector3<f64>;

/// The node's vector of a field.
#[inline(always)] // in the innermost loops
pub(super) fn at(field: &[f64], node: u32) -> V3 {
    // One check of the bounds instead of three.
    V3::from(field.as_chunks::<3>().0[node as usize])
}

pub(super) fn linear(twist: &[f64]) -> V3 {
    V3::new(twist[0], twist[1], twist[2])
}

pub(super) fn angular(twist: &[f64]) -> V3 {
    V3::new(twist[3], twist[4], twist[5])
}

/// The rotation by an angle vector (Rodrigues).
pub(super) fn rotation(angle: &V3) -> Matrix3<f64> {
    let cross = angle.cross_matrix();
    let square = angle.norm_squared();
    let (first, second) = if square < margins::SMALL_ANGLE {
        (1.0 - square / 6.0, 0.5 - square / 24.0)
    } else {
        let length = square.sqrt();
        (length.sin() / length, (1.0 - length.cos()) / square)
    };
    Matrix3::identity() + cross * first + cross * cross * second
}

/// What a rigid body weighs, about its centre of mass.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Inertia {
    pub(super) mass: f64,
    pub(super) about: Matrix3<f64>,
    /// What joints add to both.
    pub(super) added: Matrix6<f64>,
}

impl Inertia {
    /// Along the axes that this rotation leads to.
    pub(super) fn turned(&self, rotation: &Matrix3<f64>) -> Self {
        let turn = |matrix: Matrix3<f64>| rotation * matrix * rotation.transpose();
        let mut added = self.added;
        if added != Matrix6::zeros() {
            for (row, column) in [(0, 0), (0, 3), (3, 0), (3, 3)] {
                let mut block = added.fixed_view_mut::<3, 3>(row, column);
                let turned = turn(block.clone_owned());
                block.copy_from(&turned);
            }
        }
        Self { about: turn(self.about), added, ..*self }
    }

    pub(super) fn momentum(&self, twist: &[f64]) -> [f64; 6] {
        let own = [linear(twist) * self.mass, self.about * angular(twist)];
        let added = self.added * Vector6::from_column_slice(twist);
        std::array::from_fn(|k| own[k / 3][k % 3] + added[k])
    }

    pub(super) fn energy(&self, twist: &[f64]) -> f64 {
        let (all, angular) = (Vector6::from_column_slice(twist), angular(twist));
        let own = self.mass * linear(twist).norm_squared() + angular.dot(&(self.about * angular));
        0.5 * (own + all.dot(&(self.added * all)))
    }
}

/// A symmetric positive definite matrix of any size, factored in place (Cholesky), its lower half by rows.
#[derive(Debug, Default)]
pub(super) struct Factor {
    size: usize,
    numbers: Vec<f64>,
}

impl Factor {
    pub(super) fn reset(&mut self, size: usize) {
        self.size = size;
        memory::refill_with(&mut self.numbers, 0.0, size * size);
    }

    pub(super) fn add(&mut self, row: usize, column: usize, value: f64) {
        self.numbers[row * self.size + column] += value;
    }

    /// Gives the row with the smallest pivot relative to its number on the diagonal, and that fraction: of rows that depend on
    /// one another, elimination leaves nothing but rounding.
    pub(super) fn factor(&mut self) -> (usize, f64) {
        let n = self.size;
        let a = &mut self.numbers;
        let mut least = (0, 1.0);
        for j in 0..n {
            let whole = a[j * n + j];
            for i in j..n {
                let sum = (0..j).fold(a[i * n + j], |sum, k| sum - a[i * n + k] * a[j * n + k]);
                a[i * n + j] = if i == j { sum.sqrt() } else { sum / a[j * n + j] };
                let pivot = sum / whole;
                // NaN counts as 0.
                if i == j && (pivot.is_nan() || pivot < least.1) {
                    least = (j, pivot.max(0.0));
                }
            }
        }
        least
    }

    pub(super) fn solve(&self, x: &mut [f64]) {
        let (n, l) = (self.size, &self.numbers);
        for i in 0..n {
            let sum = (0..i).fold(x[i], |sum, k| sum - l[i * n + k] * x[k]);
            x[i] = sum / l[i * n + i];
        }
        for i in (0..n).rev() {
            let sum = (i + 1..n).fold(x[i], |sum, k| sum - l[k * n + i] * x[k]);
            x[i] = sum / l[i * n + i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_are_orthonormal_and_turn_by_their_angle() {
        for angle in [[0.0; 3], [1e-9, 0.0, 2e-9], [1e-4, -2e-4, 0.0], [0.3, -2.0, 1.1]].map(V3::from) {
            let turned = rotation(&angle);
            assert!((turned * turned.transpose() - Matrix3::identity()).norm() < 1e-14);
            assert!((turned * angle - angle).norm() <= 1e-15 * angle.norm());
            let cosine = (turned.trace() - 1.0) / 2.0;
            assert!((cosine - angle.norm().cos()).abs() < 1e-14);
        }
        let quarter = rotation(&V3::new(0.0, 0.0, std::f64::consts::FRAC_PI_2));
        assert!((quarter * V3::x() - V3::y()).norm() < 1e-15);
    }

    #[test]
    fn an_inertia_turns_with_its_body() {
        let turn = rotation(&V3::new(0.3, -1.0, 0.7));
        let inertia = Inertia {
            mass: 2.0,
            about: Matrix3::new(3.0, 0.5, 0.0, 0.5, 2.0, 0.1, 0.0, 0.1, 1.0),
            added: Matrix6::from_fn(|row, column| 1.0 / (1 + row + column) as f64),
        };
        let twist = [1.0, -2.0, 0.5, 0.7, 3.0, -1.0];
        let both = |of: &[f64; 6], turn: &Matrix3<f64>| {
            let parts = [turn * linear(of), turn * angular(of)];
            std::array::from_fn(|k| parts[k / 3][k % 3])
        };
        let turned = inertia.turned(&turn).momentum(&both(&twist, &turn));
        let expected: [f64; 6] = both(&inertia.momentum(&twist), &turn);
        (0..6).for_each(|k| assert!((turned[k] - expected[k]).abs() < 1e-13, "{turned:?} {expected:?}"));
    }

    #[test]
    fn a_factored_matrix_solves() {
        let rows = [[4.0, 1.0, 0.5], [1.0, 3.0, -1.0], [0.5, -1.0, 5.0]];
        let mut factor = Factor::default();
        factor.reset(3);
        (0..9).for_each(|k| factor.add(k / 3, k % 3, rows[k / 3][k % 3]));
        factor.factor();
        let mut x = [1.0, -2.0, 3.0];
        factor.solve(&mut x);
        for (row, expected) in rows.iter().zip([1.0, -2.0, 3.0]) {
            let found: f64 = row.iter().zip(x).map(|(a, x)| a * x).sum();
            assert!((found - expected).abs() < 1e-14);
        }
    }
}
