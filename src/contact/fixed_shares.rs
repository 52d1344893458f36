use crate::math::Scalar;

/// The shares of the load that the two directions carry for bodies of these roundnesses, whatever their pose.
///
/// The forces of one body's rays are the gradient of an energy, in the field of distances inside the other body. With constant
/// shares the sum of both directions is such a gradient too, so closed paths cost no work. In the field of a flat face the
/// force is that of Archimedes; in that of a ball it is smaller. So the rounder body casts more, and all where the other is
/// flat beside it. docs/accuracy.md has the errors that the two constants leave.
pub(crate) fn fixed_shares<T: Scalar>(roundness: [f64; 2]) -> [T; 2] {
    const LITTLE: f64 = 1.0 / 128.0;
    const NOTHING: f64 = 1.0 / 512.0;
    let claims = roundness.map(|roundness| (roundness + LITTLE).powi(2));
    let parts = claims.map(|claim| claim / (claims[0] + claims[1]));
    match parts {
        [first, _] if first < NOTHING => [T::zero(), T::one()],
        [_, second] if second < NOTHING => [T::one(), T::zero()],
        _ => parts.map(T::of),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounder bodies carry more, equal ones the same, and beside a ball a flat body none.
    #[test]
    fn the_rounder_body_casts() {
        let share = |roundness: [f64; 2]| fixed_shares::<f64>(roundness)[0];
        for roundness in [0.0, 1.0, 2.5] {
            assert_eq!(fixed_shares::<f64>([roundness; 2]), [0.5; 2]);
        }
        assert_eq!((share([1.0, 0.0]), share([0.0, 1.0]), share([0.3, 0.0])), (1.0, 0.0, 1.0));
        assert!((share([1.0, 0.5]) - 0.8).abs() < 0.01 && (share([0.01, 0.0]) - 0.84).abs() < 0.01);
        let [first, second] = fixed_shares::<f64>([0.7, 0.4]);
        assert!((first + second - 1.0f64).abs() < 1e-15);
    }
}
