//! Scalars, vectors and boxes.

mod aabb;
pub(crate) mod margins;
mod pose;
mod scalar;

pub use aabb::Aabb;
pub use pose::{Pose, PoseError};
pub use scalar::Scalar;

/// A position, direction or force: three scalars, contiguous.
pub type Vector3<T> = nalgebra::Vector3<T>;

/// The Euclidean length. Where squares would overflow or underflow, the vector is first scaled by a power of two, which
/// is exact: so scaling by powers of two scales the result exactly. NaN or infinite components give NaN or infinity.
pub fn length<T: Scalar>(v: &Vector3<T>) -> T {
    let square = v.norm_squared();
    if T::SAFE_SQUARES.0 <= square && square <= T::SAFE_SQUARES.1 {
        return square.sqrt();
    }
    let factor = rescue_factor(square);
    (v * factor).norm() / factor
}

/// The unit vector along `v`, or `None` where `v` has no direction (zero or not finite). Scaling `v` by a power of
/// two does not change a bit of the result.
pub fn direction<T: Scalar>(v: &Vector3<T>) -> Option<Vector3<T>> {
    let square = v.norm_squared();
    if T::SAFE_SQUARES.0 <= square && square <= T::SAFE_SQUARES.1 {
        return Some(v / square.sqrt());
    }
    let scaled = v * rescue_factor(square);
    let length = scaled.norm();
    (length > T::zero() && length.is_finite()).then(|| scaled / length)
}

/// The cosine of the angle between `v` and a vector of unit length; zero where `v` has no direction. Scaling `v` by a power
/// of two does not change a bit of it.
pub fn cosine<T: Scalar>(v: &Vector3<T>, unit: &Vector3<T>) -> T {
    let square = v.norm_squared();
    let is_safe = T::SAFE_SQUARES.0 <= square && square <= T::SAFE_SQUARES.1;
    let scaled = v * if is_safe { T::one() } else { rescue_factor(square) };
    let length = scaled.norm();
    if length > T::zero() && length.is_finite() { scaled.dot(unit) / length } else { T::zero() }
}

/// A power of two that brings a number to between 1 and 2, or as near as powers go whose inverses are in range; and its
/// inverse. Both are one for zero.
pub(crate) fn normalising_factor<T: Scalar>(number: T) -> (T, T) {
    let exponent = |number: T| (number.to_f64().to_bits() >> 52 & 0x7ff) as i32 - 1023;
    if number == T::zero() {
        return (T::one(), T::one());
    }
    let most = exponent(T::LARGEST) - 1;
    let exponent = exponent(number).clamp(-most, most);
    let power_of_two = |exponent: i32| T::of(f64::from_bits(((exponent + 1023) as u64) << 52));
    (power_of_two(-exponent), power_of_two(exponent))
}

fn rescue_factor<T: Scalar>(square: T) -> T {
    if square < T::one() { T::RESCUE_FACTORS.0 } else { T::RESCUE_FACTORS.1 }
}
