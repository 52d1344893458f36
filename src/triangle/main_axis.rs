use crate::math::Scalar;
use crate::simd::{LANE_COUNT, Lanes, Mask, Vectors};

/// The axes that become x, y and z for rays along x, y, z and against x, y, z: the order keeps the winding.
pub(crate) const AXES: [[u8; 3]; 6] = [[1, 2, 0], [2, 0, 1], [0, 1, 2], [2, 1, 0], [0, 2, 1], [1, 0, 2]];

/// Along which axis each of sixteen rays runs most; the first of several.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MainAxes {
    is_y: Mask,
    is_z: Mask,
    is_backward: Mask,
}

impl MainAxes {
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn new<T: Scalar, L: Lanes<T>>(direction: Vectors<T, L>) -> Self {
        let size = direction.magnitude();
        let is_z = size.x.larger(size.y).is_less(size.z);
        let is_y = size.x.is_less(size.y) & !is_z;
        let main = L::select(is_z, direction.z, L::select(is_y, direction.y, direction.x));
        Self { is_y, is_z, is_backward: main.is_less(L::splat(T::zero())) }
    }

    /// Each ray's place in [`AXES`].
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn places(&self) -> [u8; LANE_COUNT] {
        let mut places = [0; LANE_COUNT];
        let bit = |mask: Mask, lane: usize| (mask >> lane & 1) as u8;
        for lane in 0..LANE_COUNT {
            places[lane] = bit(self.is_y, lane) + 2 * bit(self.is_z, lane) + 3 * bit(self.is_backward, lane);
        }
        places
    }

    /// Vectors along the rays' own axes.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn turned<T: Scalar, L: Lanes<T>>(&self, vectors: Vectors<T, L>) -> Vectors<T, L> {
        let Vectors { x, y, z, .. } = vectors;
        let main = L::select(self.is_z, z, L::select(self.is_y, y, x));
        let first = L::select(self.is_z, x, L::select(self.is_y, z, y));
        let second = L::select(self.is_z, y, L::select(self.is_y, x, z));
        Vectors::new(L::select(self.is_backward, second, first), L::select(self.is_backward, first, second), main)
    }
}
