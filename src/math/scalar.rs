/// The floating-point types the library works in: `f32` and `f64`.
pub trait Scalar: nalgebra::RealField + Copy + Default + Send + Sync + crate::simd::HasLanes {
    /// Half the distance from 1 to the next larger number: the largest relative error of one rounded operation.
    const ROUNDING_UNIT: Self;
    /// The largest finite number.
    const LARGEST: Self;
    /// Positive infinity.
    const INFINITY: Self;
    /// Squared lengths between these two have lost nothing to underflow or overflow.
    const SAFE_SQUARES: (Self, Self);
    /// Powers of two: the first brings vectors with squared lengths below the safe ones among these, the second those above.
    const RESCUE_FACTORS: (Self, Self);

    /// The nearest number of this type.
    fn of(value: f64) -> Self;
    /// The same number as an `f64` (exact).
    fn to_f64(self) -> f64;
}

macro_rules! scalar {
    ($type:ident, $raise:expr, $lower:expr) => {
        impl Scalar for $type {
            const ROUNDING_UNIT: Self = $type::EPSILON / 2.0;
            const LARGEST: Self = $type::MAX;
            const INFINITY: Self = $type::INFINITY;
            const SAFE_SQUARES: (Self, Self) = {
                let spare = 1.0 / ($type::EPSILON * $type::EPSILON);
                ($type::MIN_POSITIVE * spare, $type::MAX / spare)
            };
            const RESCUE_FACTORS: (Self, Self) = ($raise, $lower);

            fn of(value: f64) -> Self {
                value as $type
            }
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
        }
    };
}

scalar!(f32, power_of_two_f32(100), power_of_two_f32(-70));
scalar!(f64, power_of_two_f64(700), power_of_two_f64(-650));

const fn power_of_two_f32(exponent: i32) -> f32 {
    f32::from_bits(((exponent + 127) as u32) << 23)
}

const fn power_of_two_f64(exponent: i64) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}
