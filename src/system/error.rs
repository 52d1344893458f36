use crate::math::margins;
use crate::mesh::MeshError;
use std::fmt;

/// Why a contact system refused something. Nothing was changed.
#[derive(Debug)]
#[expect(missing_docs, reason = "a field's name says what it is")]
pub enum SystemError {
    /// The scene has no body of this number.
    NotInScene { body: u32 },
    /// The system has no body of this number, or none of the kind that was asked for.
    UnknownBody { body: u32 },
    /// The system has a body of this number already.
    BodyTwice { body: u32 },
    /// An array has another length than is needed.
    WrongCount { what: &'static str, given: usize, expected: usize },
    /// A number of an array is NaN or infinite.
    NotFinite { what: &'static str, index: usize, value: f64 },
    /// A number of an array is larger than `most`, up to which forces and energies can be computed.
    BeyondRange { what: &'static str, index: usize, value: f64, most: f64 },
    /// A step's length is not finite and > 0, or out of range.
    StepLength { seconds: f64 },
    /// A node's mass, or without a node a rigid body's, is not > 0, or out of range.
    Mass { node: Option<usize>, value: f64 },
    /// An inertia is not symmetric and positive definite.
    Inertia,
    /// A rotation is no rotation matrix.
    Rotation { body: u32 },
    /// A material's number is out of its range.
    Material { what: &'static str, value: f64, range: &'static str },
    /// The weights of a surface vertex do not sum to one.
    WeightSum { vertex: usize, sum: f64 },
    /// A surface vertex names a node that does not exist, as there are only `count`.
    NodeRange { vertex: usize, node: u32, count: usize },
    /// The offsets of a table of weights do not rise from 0 to its length; they are wrong at this vertex.
    Offsets { vertex: usize },
    /// There is no half-space of this number, but `count` others.
    UnknownHalfSpace { half_space: u32, count: usize },
    /// A half-space's normal is no unit vector.
    Normal { length: f64 },
    /// A step has to be begun first.
    NoStep,
    /// A step has been begun and not finished.
    StepUnderWay,
    /// Rigid bodies are eliminated, and the matrix is then no sum of blocks.
    Eliminated,
    /// A matrix in compressed rows has more numbers or rows than 32-bit indices reach.
    MatrixSize,
    /// Eliminated, a rigid body would lose its mass to rounding beside the stiffness of its contacts, in steps of this length.
    TooStiff { body: u32, dt: f64 },
    /// No pair of this body and the other remembers anything.
    NotRemembered { body: u32 },
    /// Bytes, so many in length, are not what a pair of these bodies remembered.
    Memory { length: usize },
    /// A mesh refused the positions that its body would have.
    Mesh { body: u32, source: MeshError },
}

impl fmt::Display for SystemError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotInScene { body } => write!(f, "the scene has no body {body}; add its mesh to the scene first"),
            Self::UnknownBody { body } => {
                write!(f, "the contact system has no such body {body}; say first what carries each body of the scene")
            }
            Self::BodyTwice { body } => write!(f, "the contact system has body {body} already; remove it first"),
            Self::WrongCount { what, given, expected } => {
                write!(f, "{what} has {given} numbers; give {expected}")
            }
            Self::NotFinite { what, index, value } => {
                write!(f, "{what}[{index}] is {value}; give finite numbers")
            }
            Self::BeyondRange { what, index, value, most } => {
                write!(f, "{what}[{index}] is {value:e}; give numbers of at most {most:.2e} in size")
            }
            Self::StepLength { seconds } => {
                let (least, most) = (margins::SHORTEST_STEP, margins::LARGEST_GIVEN);
                write!(f, "the step is {seconds} seconds long; give seconds above 0, from {least:.2e} to {most:.2e}")
            }
            Self::Mass { node: Some(node), value } => {
                let [least, most] = margins::MASSES;
                write!(
                    f,
                    "the mass of node {node} is {value}; give kilograms above 0, from {least:.2e} to {most:.2e}, or infinity \
                     for a node held fast"
                )
            }
            Self::Mass { node: None, value } => {
                let [least, most] = margins::MASSES;
                write!(
                    f,
                    "the rigid body's mass is {value}; give kilograms above 0, from {least:.2e} to {most:.2e}"
                )
            }
            Self::Inertia => f.write_str("the inertia is singular; give a symmetric, positive definite matrix"),
            Self::Rotation { body } => {
                write!(f, "the rotation of body {body} is none; give an orthonormal matrix of determinant 1")
            }
            Self::Material { what, value, range } => write!(
                f,
                "the material's {what} is {value}; it must be {range}, and only the depth cap may be above {:.2e}",
                margins::LARGEST_GIVEN
            ),
            Self::WeightSum { vertex, sum } => {
                write!(f, "the weights of surface vertex {vertex} sum to {sum}; they must sum to 1")
            }
            Self::NodeRange { vertex, node, count } => {
                write!(f, "surface vertex {vertex} names node {node} of {count}; nodes count from 0")
            }
            Self::Offsets { vertex } => {
                write!(f, "the offsets of surface vertex {vertex} are wrong; they rise from 0 to the table's length")
            }
            Self::UnknownHalfSpace { half_space, count } => {
                write!(f, "there is no half-space {half_space}; {count} were added, and they count from 0")
            }
            Self::Normal { length } => write!(f, "the half-space's normal has length {length}; normalise it"),
            Self::NoStep => f.write_str("no step is under way; begin one first"),
            Self::StepUnderWay => f.write_str("a step is under way; finish it first"),
            Self::Eliminated => f.write_str(
                "rigid bodies are eliminated, so the matrix is no sum of blocks; make the system with their unknowns kept",
            ),
            Self::MatrixSize => f.write_str(
                "the matrix has more numbers or rows than 32-bit indices reach; take its 3 × 3 blocks, or products with it",
            ),
            Self::TooStiff { body, dt } => write!(
                f,
                "the contacts of rigid body {body} are so stiff, in a step of {dt} seconds, that its mass is lost in rounding; \
                 take a softer material or a shorter step, or make the system with rigid unknowns kept"
            ),
            Self::NotRemembered { body } => {
                write!(f, "body {body} remembers nothing of the other; ask for the pairs that do")
            }
            Self::Memory { length } => {
                write!(f, "the {length} bytes are not what these bodies remembered; pass all of them, unchanged")
            }
            Self::Mesh { body, source } => write!(f, "body {body}: {source}"),
        }
    }
}

impl std::error::Error for SystemError {}

pub(crate) fn check_count(what: &'static str, given: usize, expected: usize) -> Result<(), SystemError> {
    if given == expected { Ok(()) } else { Err(SystemError::WrongCount { what, given, expected }) }
}

pub(crate) fn check_range(what: &'static str, numbers: &[f64]) -> Result<(), SystemError> {
    check_within(what, numbers, margins::LARGEST_GIVEN)
}

/// `most`: a power of two.
pub(crate) fn check_within(what: &'static str, numbers: &[f64], most: f64) -> Result<(), SystemError> {
    let to_largest = f64::MAX / most;
    // Only NaN and infinity give something else than 0 when multiplied by 0. Without a branch, the loop checks several at once.
    let (eights, rest) = numbers.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for eight in eights {
        for k in 0..8 {
            sums[k] += eight[k] * to_largest * 0.0;
        }
    }
    let is_within = |number: &f64| (number * to_largest).is_finite();
    if sums.iter().chain(rest).all(is_within) {
        return Ok(());
    }
    match numbers.iter().position(|number| !is_within(number)) {
        Some(index) if numbers[index].is_finite() => {
            Err(SystemError::BeyondRange { what, index, value: numbers[index], most })
        }
        Some(index) => Err(SystemError::NotFinite { what, index, value: numbers[index] }),
        None => Ok(()),
    }
}
