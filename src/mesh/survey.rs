use crate::math::{Aabb, Kernel, LANE_COUNT, Lanes, Mask, Scalar};

/// Whether all positions are finite, and the box around them.
pub(super) struct Survey<'a, T> {
    pub(super) positions: &'a [[T; 3]],
}

impl<T: Scalar> Kernel<T> for Survey<'_, T> {
    type Output = (bool, Aabb<T>);

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) -> (bool, Aabb<T>) {
        let (blocks, rest) = self.positions.as_chunks::<LANE_COUNT>();
        let mut aabb = Aabb::empty();
        let mut are_finite = rest.iter().flatten().all(|x| x.is_finite());
        rest.iter().for_each(|&position| aabb.include(&position.into()));
        // Sixteen positions fill three times sixteen lanes; the first lane holds an x, the next a y, and so on.
        let (endless, largest) = (L::splat(T::INFINITY), L::splat(T::LARGEST));
        let mut smallest = [endless, endless, endless];
        let mut greatest = [endless.negate(), endless.negate(), endless.negate()];
        let mut finite = Mask::MAX;
        for block in blocks {
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
