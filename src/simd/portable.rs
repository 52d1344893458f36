use crate::simd::lane::{LANE_COUNT, Mask};
use crate::simd::lanes::{Lanes, Lists};
use nalgebra::RealField;

/// [`Lists`] for any processor.
pub(crate) struct OneByOne;

impl Lists for OneByOne {}

/// Plain loops, for any processor.
#[derive(Clone, Copy)]
pub struct Portable<T>([T; LANE_COUNT]);

impl<T: RealField + Copy> Portable<T> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn zip(self, other: Self, operation: impl Fn(T, T) -> T) -> Self {
        let mut result = self;
        for i in 0..LANE_COUNT {
            result.0[i] = operation(self.0[i], other.0[i]);
        }
        result
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn compare(self, other: Self, holds: impl Fn(T, T) -> bool) -> Mask {
        let mut mask = 0;
        for i in 0..LANE_COUNT {
            mask |= Mask::from(holds(self.0[i], other.0[i])) << i;
        }
        mask
    }
}

impl<T: RealField + Copy> Lanes<T> for Portable<T> {
    type Lists = OneByOne;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn splat(value: T) -> Self {
        Self([value; LANE_COUNT])
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn load(from: &[T; LANE_COUNT]) -> Self {
        Self(*from)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn store(self, to: &mut [T; LANE_COUNT]) {
        *to = self.0;
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sqrt(self) -> Self {
        self.zip(self, |a, _| a.sqrt())
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        let mut result = self;
        for i in 0..LANE_COUNT {
            result.0[i] = self.0[i].mul_add(factor.0[i], term.0[i]);
        }
        result
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn negate(self) -> Self {
        self.zip(self, |a, _| -a)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn smaller(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn larger(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_less(self, other: Self) -> Mask {
        self.compare(other, |a, b| a < b)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_at_most(self, other: Self) -> Mask {
        self.compare(other, |a, b| a <= b)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn permute(self, places: &[u8; LANE_COUNT]) -> Self {
        let mut result = self;
        for i in 0..LANE_COUNT {
            result.0[i] = self.0[usize::from(places[i]) % LANE_COUNT];
        }
        result
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn select(bits: Mask, this: Self, other: Self) -> Self {
        let mut result = other;
        for i in 0..LANE_COUNT {
            result.0[i] = if bits >> i & 1 == 1 { this.0[i] } else { other.0[i] };
        }
        result
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn smallest(self) -> T {
        self.0.iter().fold(self.0[0], |a, &b| if b < a { b } else { a })
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn greatest(self) -> T {
        self.0.iter().fold(self.0[0], |a, &b| if b > a { b } else { a })
    }
}
