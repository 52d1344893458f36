//! Scalars, vectors and boxes.

mod aabb;
mod scalar;

pub use aabb::Aabb;
pub use scalar::Scalar;

/// A position, direction or force: three scalars, contiguous.
pub type Vector3<T> = nalgebra::Vector3<T>;

/// The Euclidean length, without overflow or underflow of the squares, so that scaling the vector by a power of two
/// scales the result exactly. NaN or infinite components give NaN or infinity.
pub fn length<T: Scalar>(v: &Vector3<T>) -> T {
    let largest = v.amax();
    if largest == T::zero() {
        return T::zero();
    }
    (v / largest).norm() * largest
}

/// The unit vector along `v`, or `None` where `v` has no direction (zero or not finite). Scaling `v` by a power of
/// two does not change a bit of the result.
pub fn direction<T: Scalar>(v: &Vector3<T>) -> Option<Vector3<T>> {
    let largest = v.amax();
    if !(largest > T::zero() && largest.is_finite()) {
        return None;
    }
    let scaled = v / largest;
    Some(scaled / scaled.norm())
}
