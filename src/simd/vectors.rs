use crate::simd::lane::{LANE_COUNT, Mask};
use crate::simd::lanes::{HasLanes, Lanes};
use nalgebra::Vector3;
use std::marker::PhantomData;

/// Sixteen vectors. Each operation rounds as the same one of [`Vector3`].
#[derive(Clone, Copy)]
pub(crate) struct Vectors<T, L> {
    pub(crate) x: L,
    pub(crate) y: L,
    pub(crate) z: L,
    scalar: PhantomData<T>,
}

/// An operation on two vectors, coordinate by coordinate.
macro_rules! by_coordinates {
    ($($name:ident = $operation:ident),*) => {
        $(#[cfg_attr(not(debug_assertions), inline(always))]
        pub(crate) fn $name(self, other: Self) -> Self {
            Self::new(self.x.$operation(other.x), self.y.$operation(other.y), self.z.$operation(other.z))
        })*
    };
}

impl<T: HasLanes, L: Lanes<T>> Vectors<T, L> {
    by_coordinates!(add = add, sub = sub, times = mul, divided_by = div, smaller = smaller, larger = larger);

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn new(x: L, y: L, z: L) -> Self {
        Self { x, y, z, scalar: PhantomData }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn splat(vector: &Vector3<T>) -> Self {
        Self::new(L::splat(vector.x), L::splat(vector.y), L::splat(vector.z))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn zeros() -> Self {
        let zero = L::splat(T::zero());
        Self::new(zero, zero, zero)
    }

    /// Sixteen vectors, coordinate by coordinate.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn load([x, y, z]: &[[T; LANE_COUNT]; 3]) -> Self {
        Self::new(L::load(x), L::load(y), L::load(z))
    }

    /// Sixteen of the points.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn gather(points: &[Vector3<T>], indices: &[u32; LANE_COUNT]) -> Self {
        let [x, y, z] = L::gather(points, indices);
        Self::new(x, y, z)
    }

    /// Lane i is this one's where bit i is set, else the other's.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn select(bits: Mask, this: Self, other: Self) -> Self {
        Self::new(L::select(bits, this.x, other.x), L::select(bits, this.y, other.y), L::select(bits, this.z, other.z))
    }

    /// The smallest lane of each coordinate; none may be NaN.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn smallest_lanes(self) -> Vector3<T> {
        Vector3::new(self.x.smallest(), self.y.smallest(), self.z.smallest())
    }

    /// The greatest lane of each coordinate; none may be NaN.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn greatest_lanes(self) -> Vector3<T> {
        Vector3::new(self.x.greatest(), self.y.greatest(), self.z.greatest())
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn store(self, [x, y, z]: &mut [[T; LANE_COUNT]; 3]) {
        self.x.store(x);
        self.y.store(y);
        self.z.store(z);
    }

    /// The products of the coordinates and what is added to them, rounded once or twice.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn times_add(self, factor: Self, term: Self) -> Self {
        Self::new(
            self.x.times_add(factor.x, term.x),
            self.y.times_add(factor.y, term.y),
            self.z.times_add(factor.z, term.z),
        )
    }

    /// Lane i of the result is lane `places[i]`, each below 16.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn permuted(self, places: &[u8; LANE_COUNT]) -> Self {
        Self::new(self.x.permute(places), self.y.permute(places), self.z.permute(places))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn scaled(self, factor: L) -> Self {
        Self::new(self.x.mul(factor), self.y.mul(factor), self.z.mul(factor))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn divided(self, divisor: L) -> Self {
        Self::new(self.x.div(divisor), self.y.div(divisor), self.z.div(divisor))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn negate(self) -> Self {
        Self::new(self.x.negate(), self.y.negate(), self.z.negate())
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn magnitude(self) -> Self {
        Self::new(self.x.magnitude(), self.y.magnitude(), self.z.magnitude())
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn largest(self) -> L {
        self.x.larger(self.y).larger(self.z)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn dot(self, other: Self) -> L {
        self.x.mul(other.x).add(self.y.mul(other.y)).add(self.z.mul(other.z))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn cross(self, other: Self) -> Self {
        Self::new(
            self.y.mul(other.z).sub(self.z.mul(other.y)),
            self.z.mul(other.x).sub(self.x.mul(other.z)),
            self.x.mul(other.y).sub(self.y.mul(other.x)),
        )
    }

    /// Which lanes are at most the other's in every coordinate.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn are_at_most(self, other: Self) -> Mask {
        self.x.is_at_most(other.x) & self.y.is_at_most(other.y) & self.z.is_at_most(other.z)
    }
}
