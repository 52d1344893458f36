use crate::math::Scalar;
use crate::simd::{LANE_COUNT, Mask};
use crate::triangle::Hit;

/// Where each ray of a packet meets a mesh first.
#[derive(Clone, Debug)]
// Whole rows of sixteen lie on lines of the cache.
#[repr(C, align(64))]
pub(crate) struct PacketHits<T: Scalar> {
    pub(crate) triangle: [u32; LANE_COUNT],
    pub(crate) t: [T; LANE_COUNT],
    pub(crate) weights: [[T; LANE_COUNT]; 3],
    /// Which rays have a hit; places of the others hold nothing of use.
    pub(crate) found: Mask,
    /// Which rays meet the triangle from inside.
    pub(crate) exits: Mask,
}

impl<T: Scalar> PacketHits<T> {
    pub(crate) fn empty() -> Self {
        let zeros = [T::zero(); LANE_COUNT];
        Self { found: 0, exits: 0, triangle: [0; LANE_COUNT], t: zeros, weights: [zeros; 3] }
    }

    /// The hit of one ray, if it has one.
    pub(crate) fn get(&self, lane: usize) -> Option<Hit<T>> {
        (self.found >> lane & 1 == 1).then(|| self.hit(lane))
    }

    /// The hit of a ray that has one.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn hit(&self, lane: usize) -> Hit<T> {
        Hit {
            triangle: self.triangle[lane],
            t: self.t[lane],
            weights: [0, 1, 2].map(|corner| self.weights[corner][lane]),
            is_exit: self.exits >> lane & 1 == 1,
        }
    }

    pub(crate) fn set(&mut self, lane: usize, hit: &Hit<T>) {
        let bit = 1 << lane;
        self.found |= bit;
        self.exits = if hit.is_exit { self.exits | bit } else { self.exits & !bit };
        (self.triangle[lane], self.t[lane]) = (hit.triangle, hit.t);
        (0..3).for_each(|corner| self.weights[corner][lane] = hit.weights[corner]);
    }
}
