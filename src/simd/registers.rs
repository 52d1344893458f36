//! What lanes of one register or several have in common.

/// An operation on two operands, register by register.
macro_rules! on_two {
    ($name:ident, $instruction:ident, [$($i:literal),*]) => {
        #[cfg_attr(not(debug_assertions), inline(always))]
        fn $name(self, other: Self) -> Self {
            // SAFETY: the kernel that runs this was chosen for a processor with these instructions.
            unsafe { Self([$($instruction(self.0[$i], other.0[$i])),*]) }
        }
    };
}

/// Arithmetic register by register, given the instructions' names.
macro_rules! arithmetic {
    (
        $scalar:ty, [$($i:literal),*], $width:literal; $splat:ident, $load:ident, $store:ident, $add:ident, $sub:ident,
        $mul:ident, $div:ident, $sqrt:ident, $mul_add:ident, $xor:ident, $min:ident, $max:ident
    ) => {
        $crate::simd::registers::on_two!(add, $add, [$($i),*]);
        $crate::simd::registers::on_two!(sub, $sub, [$($i),*]);
        $crate::simd::registers::on_two!(mul, $mul, [$($i),*]);
        $crate::simd::registers::on_two!(div, $div, [$($i),*]);
        $crate::simd::registers::on_two!(smaller, $min, [$($i),*]);
        $crate::simd::registers::on_two!(larger, $max, [$($i),*]);

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn splat(value: $scalar) -> Self {
            // SAFETY: the kernel that runs this was chosen for a processor with these instructions.
            let all = unsafe { $splat(value) };
            Self([$({ let _ = $i; all }),*])
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn load(from: &[$scalar; LANE_COUNT]) -> Self {
            // SAFETY: as above; sixteen numbers may be read.
            unsafe { Self([$($load(from[$i * $width..].as_ptr())),*]) }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn store(self, to: &mut [$scalar; LANE_COUNT]) {
            // SAFETY: as above; sixteen numbers may be written.
            unsafe { $($store(to[$i * $width..].as_mut_ptr(), self.0[$i]);)* }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn sqrt(self) -> Self {
            // SAFETY: the kernel that runs this was chosen for a processor with these instructions.
            unsafe { Self([$($sqrt(self.0[$i])),*]) }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn mul_add(self, factor: Self, term: Self) -> Self {
            // SAFETY: the kernel that runs this was chosen for a processor with these instructions.
            unsafe { Self([$($mul_add(self.0[$i], factor.0[$i], term.0[$i])),*]) }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn negate(self) -> Self {
            // SAFETY: the kernel that runs this was chosen for a processor with these instructions.
            unsafe { Self([$($xor(self.0[$i], $splat(-0.0))),*]) }
        }
    };
}

/// Comparisons register by register, given the instructions' names, and edge functions. For these the type has `spread`, which
/// lays points out to be looked up, and `at`, which looks up as many as a register holds.
macro_rules! comparisons {
    (
        [$($i:literal),*], $width:literal; $splat:ident, $sub:ident, $mul:ident, $min:ident, $max:ident, $less:expr,
        $at_most:expr, $blend:ident, $bits:ident
    ) => {
        #[cfg_attr(not(debug_assertions), inline(always))]
        fn is_less(self, other: Self) -> Mask {
            // SAFETY: the kernel that runs this was chosen for a processor with these instructions.
            unsafe { 0 $(| ($bits($less(self.0[$i], other.0[$i])) as Mask) << ($i * $width))* }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn is_at_most(self, other: Self) -> Mask {
            // SAFETY: the kernel that runs this was chosen for a processor with these instructions.
            unsafe { 0 $(| ($bits($at_most(self.0[$i], other.0[$i])) as Mask) << ($i * $width))* }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn where_less(self, limit: Self, this: Self, other: Self) -> Self {
            // SAFETY: the kernel that runs this was chosen for a processor with these instructions.
            unsafe { Self([$($blend(other.0[$i], this.0[$i], $less(self.0[$i], limit.0[$i]))),*]) }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn where_at_most(self, limit: Self, this: Self, other: Self) -> Self {
            // SAFETY: the kernel that runs this was chosen for a processor with these instructions.
            unsafe { Self([$($blend(other.0[$i], this.0[$i], $at_most(self.0[$i], limit.0[$i]))),*]) }
        }

        #[cfg_attr(not(debug_assertions), inline(always))]
        fn sides(points: [Self; 2], corners: &[[u8; LANE_COUNT]; 3]) -> [Mask; 2] {
            let points = Self::spread(points);
            let [mut above, mut below] = [0; 2];
            // One register after the other: there are not enough for all at once.
            // SAFETY: the kernel that runs this was chosen for a processor with these instructions.
            $(unsafe {
                let [ax, ay] = Self::at(&points, &corners[0], $i);
                let [bx, by] = Self::at(&points, &corners[1], $i);
                let [cx, cy] = Self::at(&points, &corners[2], $i);
                let u = $sub($mul(cx, by), $mul(cy, bx));
                let v = $sub($mul(ax, cy), $mul(ay, cx));
                let w = $sub($mul(bx, ay), $mul(by, ax));
                let zero = $splat(0.0);
                above |= ($bits($less(zero, $max($max(u, v), w))) as Mask) << ($i * $width);
                below |= ($bits($less($min($min(u, v), w), zero)) as Mask) << ($i * $width);
            })*
            [above, below]
        }
    };
}

pub(crate) use arithmetic;
pub(crate) use comparisons;
pub(crate) use on_two;
