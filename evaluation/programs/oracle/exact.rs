//! Exact arithmetic on floating-point numbers, for what rounded arithmetic leaves undecided.
//!
//! Every finite floating-point number is a whole number times a power of two, and sums, differences and products of
//! such numbers are of the same kind. `dashu-int` does the whole numbers: well kept, and without allocation up to 128
//! bits, which most of these are.

use super::judge::Line;
use dashu_int::IBig;
use std::cmp::Ordering;
use std::ops::{Add, Mul, Sub};

/// mantissa · 2^exponent.
#[derive(Clone, Debug)]
pub struct Dyadic {
    mantissa: IBig,
    exponent: i32,
}

impl From<f64> for Dyadic {
    fn from(value: f64) -> Self {
        assert!(value.is_finite(), "the judge is given finite numbers");
        let bits = value.to_bits();
        let fraction = (bits & ((1 << 52) - 1)) as i64;
        let (magnitude, exponent) = match (bits >> 52 & 0x7ff) as i32 {
            0 => (fraction, -1074),
            biased => (fraction | 1 << 52, biased - 1075),
        };
        if magnitude == 0 {
            return Self { mantissa: IBig::ZERO, exponent: 0 };
        }
        // Short mantissas keep the sums short.
        let spare = magnitude.trailing_zeros();
        let mantissa = (magnitude >> spare) * if value < 0.0 { -1 } else { 1 };
        Self { mantissa: mantissa.into(), exponent: exponent + spare as i32 }
    }
}

impl Dyadic {
    /// Both mantissas at the smaller exponent.
    fn aligned(&self, other: &Self) -> (IBig, IBig, i32) {
        if self.mantissa == IBig::ZERO {
            return (IBig::ZERO, other.mantissa.clone(), other.exponent);
        }
        if other.mantissa == IBig::ZERO {
            return (self.mantissa.clone(), IBig::ZERO, self.exponent);
        }
        let exponent = self.exponent.min(other.exponent);
        let shifted = |number: &Self| &number.mantissa << (number.exponent - exponent) as usize;
        (shifted(self), shifted(other), exponent)
    }

    pub fn squared(&self) -> Self {
        self * self
    }

    pub fn is_above(&self, other: &Self) -> bool {
        let (left, right, _) = self.aligned(other);
        left.cmp(&right) == Ordering::Greater
    }
}

impl Add for &Dyadic {
    type Output = Dyadic;
    fn add(self, other: &Dyadic) -> Dyadic {
        let (left, right, exponent) = self.aligned(other);
        Dyadic { mantissa: left + right, exponent }
    }
}

impl Sub for &Dyadic {
    type Output = Dyadic;
    fn sub(self, other: &Dyadic) -> Dyadic {
        let (left, right, exponent) = self.aligned(other);
        Dyadic { mantissa: left - right, exponent }
    }
}

impl Mul for &Dyadic {
    type Output = Dyadic;
    fn mul(self, other: &Dyadic) -> Dyadic {
        Dyadic { mantissa: &self.mantissa * &other.mantissa, exponent: self.exponent + other.exponent }
    }
}

fn cross(p: &[Dyadic; 2], q: &[Dyadic; 2]) -> Dyadic {
    &(&p[0] * &q[1]) - &(&p[1] * &q[0])
}

fn dot(p: &[Dyadic; 2], q: &[Dyadic; 2]) -> Dyadic {
    &(&p[0] * &q[0]) + &(&p[1] * &q[1])
}

/// Whether the line comes within `distance` of the segment, in the projection of [`Line`].
pub fn is_near(line: &Line, segment: [&[f64; 3]; 2], distance: f64) -> bool {
    let direction = line.axes.map(|axis| Dyadic::from(line.direction[axis]));
    let project = |point: &[f64; 3]| {
        let [x, y, z] = line.axes.map(|axis| &Dyadic::from(point[axis]) - &Dyadic::from(line.origin[axis]));
        [&(&x * &direction[2]) - &(&direction[0] * &z), &(&y * &direction[2]) - &(&direction[1] * &z)]
    };
    let [p, q] = segment.map(project);
    let along = [&q[0] - &p[0], &q[1] - &p[1]];
    let length_squared = dot(&along, &along);
    let limit = (&Dyadic::from(distance) * &direction[2]).squared();

    // Where the foot of the perpendicular from the line lies, in multiples of `along`, times its squared length.
    let zero = Dyadic::from(0.0);
    let foot = &zero - &dot(&p, &along);
    if !foot.is_above(&zero) {
        !dot(&p, &p).is_above(&limit)
    } else if !length_squared.is_above(&foot) {
        !dot(&q, &q).is_above(&limit)
    } else {
        !cross(&p, &q).squared().is_above(&(&limit * &length_squared))
    }
}

/// Whether `origin + t · direction` and the weighted sum of the corners are within `limit` of one another, axis by
/// axis.
pub fn is_same_point(line: &Line, t: f64, corners: [&[f64; 3]; 3], weights: [f64; 3], limit: f64) -> bool {
    let (t, limit) = (Dyadic::from(t), Dyadic::from(limit).squared());
    (0..3).all(|axis| {
        let origin = Dyadic::from(line.origin[axis]);
        let mut difference = &Dyadic::from(0.0) - &(&t * &Dyadic::from(line.direction[axis]));
        for (corner, weight) in corners.iter().zip(weights) {
            let reach = &Dyadic::from(corner[axis]) - &origin;
            difference = &difference + &(&Dyadic::from(weight) * &reach);
        }
        !difference.squared().is_above(&limit)
    })
}
