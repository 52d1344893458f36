/// The floating-point types the library works in: `f32` and `f64`.
pub trait Scalar: nalgebra::RealField + Copy + Default + Send + Sync + private::Sealed {
    /// Half the distance from 1 to the next larger number: the largest relative error of one rounded operation.
    const ROUNDING_UNIT: Self;
    /// The largest finite number.
    const LARGEST: Self;
    /// Positive infinity.
    const INFINITY: Self;

    /// The nearest number of this type.
    fn of(value: f64) -> Self;
    /// The same number as an `f64` (exact).
    fn to_f64(self) -> f64;
}

mod private {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

macro_rules! scalar {
    ($type:ident) => {
        impl Scalar for $type {
            const ROUNDING_UNIT: Self = $type::EPSILON / 2.0;
            const LARGEST: Self = $type::MAX;
            const INFINITY: Self = $type::INFINITY;

            fn of(value: f64) -> Self {
                value as $type
            }
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
        }
    };
}

scalar!(f32);
scalar!(f64);
