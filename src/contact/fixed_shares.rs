use crate::math::Scalar;
use crate::mesh::Roundness;

/// The shares of the load that the two directions carry for bodies of these shapes, whatever their pose.
///
/// The forces of one body's rays are the gradient of an energy: an integral over the distances inside the other body. With
/// constant shares the sum of both directions is a gradient too, and closed paths cost no work. Distances to a flat face give
/// the force of Archimedes. Those to a ball give less, the less the smaller the ball is. So the body that is curved more casts
/// more, and beside a flat one it casts all. Of two flat bodies the smaller casts more: it is more likely to touch with a whole
/// face, whose border is its own and needs no search. That goes only by the root of the sizes, because a block pressed between
/// others has the right force where both cast alike. docs/accuracy.md has the errors that the two constants leave.
pub(crate) fn fixed_shares<T: Scalar>(shapes: [Roundness; 2]) -> [T; 2] {
    const LITTLE: f64 = 1.0 / 128.0;
    const NOTHING: f64 = 1.0 / 512.0;
    let largest = shapes[0].area.max(shapes[1].area);
    let shapes = shapes.map(|Roundness { of_unit, area, .. }| [of_unit, area / largest]);
    // The squares of both curvatures, times both areas.
    let claims = [0, 1].map(|k| (shapes[k][0] + LITTLE * shapes[k][1].sqrt().sqrt()).powi(2) * shapes[1 - k][1]);
    match claims.map(|claim| claim / (claims[0] + claims[1])) {
        [first, _] if first < NOTHING => [T::zero(), T::one()],
        [_, second] if second < NOTHING => [T::one(), T::zero()],
        [first, second] if first + second > 0.0 => [T::of(first), T::of(second)],
        // Beyond the largest numbers.
        _ => [T::of(0.5); 2],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn share(roundness: [f64; 2], areas: [f64; 2]) -> f64 {
        let shapes = [0, 1].map(|body| Roundness { of_unit: roundness[body], area: areas[body], half_thickness: 0.0 });
        let [first, second] = fixed_shares::<f64>(shapes);
        assert!((first + second - 1.0).abs() < 1e-15);
        first
    }

    /// Rounder bodies carry more, equal ones the same, and beside a ball a flat body none.
    #[test]
    fn the_rounder_body_casts() {
        for roundness in [0.0, 1.0, 2.5] {
            assert_eq!(share([roundness; 2], [3.0; 2]), 0.5);
        }
        let of_equal = |roundness| share(roundness, [7.0; 2]);
        assert_eq!((of_equal([1.0, 0.0]), of_equal([0.0, 1.0]), of_equal([0.3, 0.0])), (1.0, 0.0, 1.0));
        assert!((of_equal([1.0, 0.5]) - 0.8).abs() < 0.01 && (of_equal([0.01, 0.0]) - 0.84).abs() < 0.01);
    }

    /// A small ball on a large one is nearly a ball on a slab; a box on a floor casts from its own faces.
    #[test]
    fn the_smaller_body_casts_more() {
        for roundness in [0.0, 1.0] {
            let (of_four, most) = if roundness > 0.0 { (0.8, 1e3) } else { (2.0 / 3.0, 1e6) };
            assert!((share([roundness; 2], [1.0, 4.0]) - of_four).abs() < 0.002);
            assert_eq!((share([roundness; 2], [1.0, most]), share([roundness; 2], [most, 1.0])), (1.0, 0.0));
        }
        assert!((share([1.0, 0.0], [100.0, 1.0]) - share([1.0, 0.0], [1e302, 1e300])).abs() < 1e-15);
        assert!(share([1.0, 0.0], [100.0, 1.0]) > 0.99, "a small flat body does not count for a ball");
        assert_eq!(share([0.0; 2], [0.0; 2]), 0.5);
    }
}
