//! Where a rigid body is: a rotation and a translation, always in double precision.

use super::{Scalar, Vector3, margins};
use std::fmt;

/// Where a body is that keeps its shape: a point p of it, in its own coordinates, is at rotation · p + position in the
/// world's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Where the origin of the body's own coordinates is.
    pub position: [f64; 3],
    /// The rows of the rotation matrix from the body's own coordinates to the world's: its columns are the body's axes as
    /// the world sees them.
    pub rotation: [[f64; 3]; 3],
}

/// Why numbers are no pose.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "a field's name says what it is")]
pub enum PoseError {
    /// A coordinate of the position is NaN or infinite.
    Position { axis: usize },
    /// An entry of the rotation is NaN or infinite.
    Rotation { row: usize, column: usize },
    /// The rows are not at right angles to one another and of unit length: rotation · rotationᵀ is off the identity by so much, as
    /// the root of the sum of squares.
    NotOrthonormal { by: f64 },
    /// The rotation turns the body's left hand into a right one: its determinant is −1.
    Mirrored,
}

impl fmt::Display for PoseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Position { axis } => write!(f, "coordinate {axis} of the pose's position is not finite"),
            Self::Rotation { row, column } => {
                write!(f, "the entry of the pose's rotation in row {row} and column {column} is not finite")
            }
            Self::NotOrthonormal { by } => write!(
                f,
                "the pose's rotation is no rotation matrix: times its transpose it is {by:e} off the identity; give unit rows \
                 at right angles, to within {:e}",
                margins::ROTATION
            ),
            Self::Mirrored => f.write_str(
                "the pose's rotation mirrors the body: its determinant is -1; give one whose determinant is 1",
            ),
        }
    }
}

impl std::error::Error for PoseError {}

impl Pose {
    /// No rotation and no translation.
    pub const IDENTITY: Self =
        Self { position: [0.0; 3], rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] };

    /// Whether the numbers are a pose, or else why not.
    pub fn check(&self) -> Result<(), PoseError> {
        let Self { position, rotation } = self;
        if let Some(axis) = position.iter().position(|x| !x.is_finite()) {
            return Err(PoseError::Position { axis });
        }
        if let Some(entry) = rotation.as_flattened().iter().position(|x| !x.is_finite()) {
            return Err(PoseError::Rotation { row: entry / 3, column: entry % 3 });
        }
        let matrix = nalgebra::Matrix3::from_fn(|row, column| rotation[row][column]);
        let by = (matrix * matrix.transpose() - nalgebra::Matrix3::identity()).norm();
        // NaN where squares of entries overflow.
        if by.is_nan() || by > margins::ROTATION {
            return Err(PoseError::NotOrthonormal { by });
        }
        if matrix.determinant() < 0.0 { Err(PoseError::Mirrored) } else { Ok(()) }
    }

    /// Where a point of the body is: each coordinate is row₀ x + row₁ y + row₂ z + position in double precision, added from
    /// left to right, and is rounded once more to the precision of the point.
    #[inline(always)]
    pub fn moved<T: Scalar>(&self, point: &Vector3<T>) -> Vector3<T> {
        let [x, y, z] = [point.x.to_f64(), point.y.to_f64(), point.z.to_f64()];
        let [first, second, third] = &self.rotation;
        Vector3::new(
            T::of(first[0] * x + first[1] * y + first[2] * z + self.position[0]),
            T::of(second[0] * x + second[1] * y + second[2] * z + self.position[1]),
            T::of(third[0] * x + third[1] * y + third[2] * z + self.position[2]),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(change: impl FnOnce(&mut Pose)) -> PoseError {
        let mut pose = Pose::IDENTITY;
        change(&mut pose);
        pose.check().expect_err("it is no pose")
    }

    #[test]
    fn each_thing_wrong_has_its_own_error() {
        assert_eq!(Pose::IDENTITY.check(), Ok(()));
        assert_eq!(refused(|pose| pose.position[1] = f64::NAN), PoseError::Position { axis: 1 });
        assert_eq!(refused(|pose| pose.rotation[2][0] = f64::INFINITY), PoseError::Rotation { row: 2, column: 0 });
        for wrong in [0.0, 1.0 + 1e-6, 1e200] {
            let error = refused(|pose| pose.rotation[1][1] = wrong);
            assert!(matches!(error, PoseError::NotOrthonormal { .. }), "{wrong}: {error}");
        }
        assert_eq!(refused(|pose| pose.rotation[0][0] = -1.0), PoseError::Mirrored);
    }

    /// A quarter turn about z takes x to y.
    #[test]
    fn rows_are_rows() {
        let rotation = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        let pose = Pose { position: [10.0, 20.0, 30.0], rotation };
        assert_eq!(pose.check(), Ok(()));
        assert_eq!(pose.moved(&Vector3::new(1.0_f32, 0.0, 0.5)), Vector3::new(10.0, 21.0, 30.5));
    }
}
