use crate::math::{Aabb, Scalar, Vector3};
use crate::simd::{Kernel, LANE_COUNT, Lanes, Mask};

/// The positions of a mesh's vertices, wherever and however they lie.
pub(crate) trait PositionSource<T: Scalar> {
    fn count(&self) -> usize;

    fn position(&self, vertex: usize) -> [T; 3];

    /// The positions of sixteen vertices in a row.
    fn block(&self, first: usize) -> [[T; 3]; LANE_COUNT];
}

impl<T: Scalar> PositionSource<T> for [[T; 3]] {
    fn count(&self) -> usize {
        self.len()
    }

    #[inline]
    fn position(&self, vertex: usize) -> [T; 3] {
        self[vertex]
    }

    #[inline]
    fn block(&self, first: usize) -> [[T; 3]; LANE_COUNT] {
        *self[first..].first_chunk().expect("sixteen vertices")
    }
}

/// Positions that a function gives by number.
pub(crate) struct Numbered<F> {
    pub(crate) count: usize,
    pub(crate) position: F,
}

impl<T: Scalar, F: Fn(usize) -> Vector3<T>> PositionSource<T> for Numbered<F> {
    fn count(&self) -> usize {
        self.count
    }

    #[inline]
    fn position(&self, vertex: usize) -> [T; 3] {
        (self.position)(vertex).into()
    }

    #[inline]
    fn block(&self, first: usize) -> [[T; 3]; LANE_COUNT] {
        std::array::from_fn(|i| self.position(first + i))
    }
}

/// Whether all positions are finite, and the box around them.
pub(crate) struct FiniteBounds<'a, P: ?Sized> {
    pub(crate) positions: &'a P,
}

impl<T: Scalar, P: PositionSource<T> + ?Sized> Kernel<T> for FiniteBounds<'_, P> {
    type Output = (bool, Aabb<T>);

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) -> (bool, Aabb<T>) {
        let count = self.positions.count();
        let in_blocks = count - count % LANE_COUNT;
        let mut aabb = Aabb::empty();
        let mut are_finite = true;
        for vertex in in_blocks..count {
            let position = self.positions.position(vertex);
            are_finite &= position.iter().all(|x| x.is_finite());
            aabb.include(&position.into());
        }
        // Sixteen positions fill three times sixteen lanes; the first lane holds an x, the next a y, and so on.
        let (endless, largest) = (L::splat(T::INFINITY), L::splat(T::LARGEST));
        let mut smallest = [endless, endless, endless];
        let mut greatest = [endless.negate(), endless.negate(), endless.negate()];
        let mut finite = Mask::MAX;
        for first in (0..in_blocks).step_by(LANE_COUNT) {
            let block = self.positions.block(first);
            let (lanes, _) = block.as_flattened().as_chunks::<LANE_COUNT>();
            for part in 0..3 {
                let values = L::load(&lanes[part]);
                finite &= values.magnitude().is_at_most(largest);
                smallest[part] = values.smaller(smallest[part]);
                greatest[part] = values.larger(greatest[part]);
            }
        }
        are_finite &= finite == Mask::MAX;
        let mut values = [T::zero(); LANE_COUNT];
        for part in 0..3 {
            let axis = |lane: usize| (part * LANE_COUNT + lane) % 3;
            smallest[part].store(&mut values);
            for (lane, &value) in values.iter().enumerate() {
                aabb.lower[axis(lane)] = aabb.lower[axis(lane)].min(value);
            }
            greatest[part].store(&mut values);
            for (lane, &value) in values.iter().enumerate() {
                aabb.upper[axis(lane)] = aabb.upper[axis(lane)].max(value);
            }
        }
        (are_finite, aabb)
    }
}
