//! Sixteen lanes as a path has them, and what runs on them. A path is a set of instructions, such as AVX2.

use crate::simd::lane::{LANE_COUNT, Mask};
use crate::simd::one_by_one::{bounds_one_by_one, gather_one_by_one};
use nalgebra::{RealField, Vector3};

/// What a path does with lists of indices, whatever the numbers in its lanes. The bodies here go one by one, for processors
/// without instructions for it.
pub(crate) trait Lists {
    /// Sixteen of the list's entries.
    ///
    /// # Panics
    /// Where there is no entry of an index.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn gather_indices(list: &[u32], indices: &[u32; LANE_COUNT]) -> [u32; LANE_COUNT] {
        let mut entries = [0; LANE_COUNT];
        for i in 0..LANE_COUNT {
            entries[i] = list[indices[i] as usize];
        }
        entries
    }

    /// Writes first + i for every bit i that is set, behind the first `count` entries of the list, and gives the new count.
    /// Up to sixteen entries behind the first `count` may be overwritten.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn append(list: &mut [u32], mut count: usize, first: u32, mut bits: Mask) -> usize {
        while bits != 0 {
            list[count] = first + bits.trailing_zeros();
            count += 1;
            bits &= bits - 1;
        }
        count
    }

    /// Which of sixteen indices are this one.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn equal(indices: &[u32; LANE_COUNT], index: u32) -> Mask {
        (0..LANE_COUNT).fold(0, |mask, i| mask | Mask::from(indices[i] == index) << i)
    }

    /// Which of sixteen sets have all these bits.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn holding(sets: &[Mask; LANE_COUNT], bits: Mask) -> Mask {
        (0..LANE_COUNT).fold(0, |mask, i| mask | Mask::from(sets[i] & bits == bits) << i)
    }

    /// Which of sixteen triangles, given by the places of their corners, have a corner at this place.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn with_corner(corners: &[[u8; LANE_COUNT]; 3], place: u8) -> Mask {
        (0..LANE_COUNT).fold(0, |mask, i| mask | Mask::from(corners.iter().any(|of_all| of_all[i] == place)) << i)
    }
}

/// Sixteen numbers.
pub(crate) trait Lanes<T: RealField + Copy>: Copy {
    type Lists: Lists;
    /// Whether rays that a host gives together are traced sooner in packets than one by one.
    const PACKETS_PAY: bool = true;
    /// Whether the processor multiplies and adds in one instruction.
    const FUSES: bool = false;

    fn splat(value: T) -> Self;
    fn load(from: &[T; LANE_COUNT]) -> Self;
    fn store(self, to: &mut [T; LANE_COUNT]);
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    fn sqrt(self) -> Self;
    /// self · factor + term, rounded once.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// self · factor + term, rounded once or twice, whichever the processor does sooner: for bounds only, since paths
    /// differ.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn times_add(self, factor: Self, term: Self) -> Self {
        if Self::FUSES { self.mul_add(factor, term) } else { self.mul(factor).add(term) }
    }
    fn negate(self) -> Self;
    /// `if self < other { self } else { other }`.
    fn smaller(self, other: Self) -> Self;
    /// `if self > other { self } else { other }`.
    fn larger(self, other: Self) -> Self;
    /// Which lanes are less than the other's; none where either is NaN.
    fn is_less(self, other: Self) -> Mask;
    /// Which lanes are not above the other's; none where either is NaN.
    fn is_at_most(self, other: Self) -> Mask;
    /// Lane i of the result is lane `places[i]`, each below 16.
    fn permute(self, places: &[u8; LANE_COUNT]) -> Self;
    /// Of sixteen triangles in a plane, their corners given by their places among sixteen points: those with any edge
    /// function above zero, and those with any below.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sides([x, y]: [Self; 2], corners: &[[u8; LANE_COUNT]; 3]) -> [Mask; 2] {
        let (ax, ay) = (x.permute(&corners[0]), y.permute(&corners[0]));
        let (bx, by) = (x.permute(&corners[1]), y.permute(&corners[1]));
        let (cx, cy) = (x.permute(&corners[2]), y.permute(&corners[2]));
        let u = cx.mul(by).sub(cy.mul(bx));
        let v = ax.mul(cy).sub(ay.mul(cx));
        let w = bx.mul(ay).sub(by.mul(ax));
        let zero = Self::splat(T::zero());
        [zero.is_less(u.larger(v).larger(w)), u.smaller(v).smaller(w).is_less(zero)]
    }
    /// Lane i is this one's where bit i is set, else the other's.
    fn select(bits: Mask, this: Self, other: Self) -> Self;
    /// `if self < limit { this } else { other }`; cheaper than by a mask.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn where_less(self, limit: Self, this: Self, other: Self) -> Self {
        Self::select(self.is_less(limit), this, other)
    }
    /// `if self <= limit { this } else { other }`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn where_at_most(self, limit: Self, this: Self, other: Self) -> Self {
        Self::select(self.is_at_most(limit), this, other)
    }
    /// The coordinates of sixteen of the points.
    ///
    /// # Panics
    /// Where there is no point of an index.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn gather(points: &[Vector3<T>], indices: &[u32; LANE_COUNT]) -> [Self; 3] {
        let [x, y, z] = gather_one_by_one(points, indices);
        [Self::load(&x), Self::load(&y), Self::load(&z)]
    }
    /// The smallest and the greatest coordinates of sixteen of the points; none may be NaN.
    ///
    /// # Panics
    /// Where there is no point of an index.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn bounds(points: &[Vector3<T>], indices: &[u32; LANE_COUNT]) -> (Vector3<T>, Vector3<T>) {
        bounds_one_by_one(points, indices)
    }
    /// The smallest lane; none may be NaN.
    fn smallest(self) -> T;
    /// The largest lane; none may be NaN.
    fn greatest(self) -> T;
    /// Runs a kernel on this path as a function of its own: large code is then compiled once, however many places call it.
    #[inline(never)]
    fn outlined<K: Kernel<T>>(kernel: K) -> K::Output
    where
        T: HasLanes,
    {
        kernel.run::<Self>()
    }

    /// The absolute value, but for the sign of zero.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn magnitude(self) -> Self {
        self.larger(self.negate())
    }
}

/// The types of lanes for a number type, path by path.
pub trait HasLanes: RealField + Copy {
    /// For any processor of the kind that is compiled for.
    #[allow(private_bounds)]
    type Baseline: Lanes<Self>;
    /// For processors with AVX2 and FMA.
    #[allow(private_bounds)]
    type Avx2: Lanes<Self>;
    /// For processors with AVX-512.
    #[allow(private_bounds)]
    type Avx512: Lanes<Self>;
}

/// What is worth compiling once for each kind of processor. Everything that `run` calls should be inlined into it.
pub(crate) trait Kernel<T: HasLanes> {
    /// What it gives.
    type Output;

    fn run<L: Lanes<T>>(self) -> Self::Output;
}
