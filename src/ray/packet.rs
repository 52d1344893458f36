// Lanes side by side read best, and are best made into SIMD, as plain loops over their index.
#![allow(clippy::needless_range_loop)]

use super::{Ray, ShearedRay};
use crate::math::{Aabb, LANE_COUNT, Lanes, Mask, Scalar, Vector3, Vectors};

/// Up to sixteen rays side by side, each made ready for boxes and for the watertight triangle test.
#[derive(Clone, Debug)]
// Whole rows of sixteen lie on lines of the cache.
#[repr(C, align(64))]
pub(crate) struct RayPacket<T: Scalar> {
    pub(crate) origin: [[T; LANE_COUNT]; 3],
    pub(crate) direction: [[T; LANE_COUNT]; 3],
    pub(crate) t_max: [T; LANE_COUNT],
    /// 1 / direction, with a finite stand-in for 1/0 that keeps 0 · ∞ out of the planes of boxes.
    pub(crate) inverse: [[T; LANE_COUNT]; 3],
    pub(crate) sheared: [ShearedRay<T>; LANE_COUNT],
    /// Which lanes hold a ray.
    pub(crate) present: Mask,
}

impl<T: Scalar> RayPacket<T> {
    pub(crate) fn empty() -> Self {
        let zeros = [T::zero(); LANE_COUNT];
        let nowhere = ShearedRay::new(&Ray::new(Vector3::zeros(), Vector3::zeros()));
        Self {
            present: 0,
            origin: [zeros; 3],
            direction: [zeros; 3],
            t_max: zeros,
            inverse: [zeros; 3],
            sheared: [nowhere; LANE_COUNT],
        }
    }

    /// Takes up to sixteen rays.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn set(&mut self, rays: &[Ray<T>]) {
        self.present = ((1u32 << rays.len()) - 1) as Mask;
        // Places behind the last repeat it, so that nothing undefined is computed there.
        for lane in 0..LANE_COUNT {
            let ray = &rays[lane.min(rays.len() - 1)];
            for axis in 0..3 {
                self.origin[axis][lane] = ray.origin[axis];
                self.direction[axis][lane] = ray.direction[axis];
                self.inverse[axis][lane] = (T::one() / ray.direction[axis]).clamp(-T::LARGEST, T::LARGEST);
            }
            self.t_max[lane] = ray.t_max;
            self.sheared[lane] = ShearedRay::new(ray);
        }
    }

    /// Makes rays from points along the opposite of their unit normals, each cut where it leaves the box: see
    /// [`Ray::exit_from`].
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn set_inward<L: Lanes<T>>(
        &mut self,
        present: Mask,
        position: &[[T; LANE_COUNT]; 3],
        normal: &[[T; LANE_COUNT]; 3],
        region: &Aabb<T>,
    ) {
        self.present = present;
        self.origin = *position;
        let origin = Vectors::<T, L>::load(position);
        let direction = Vectors::<T, L>::load(normal).negate();
        direction.store(&mut self.direction);

        let below = Vectors::splat(&region.lower).sub(origin);
        let above = Vectors::splat(&region.upper).sub(origin);
        let margin =
            below.magnitude().larger(above.magnitude()).largest().mul(L::splat(T::ROUNDING_UNIT * T::of(64.0)));
        let x = exit_along(direction.x, below.x.sub(margin), above.x.add(margin));
        let y = exit_along(direction.y, below.y.sub(margin), above.y.add(margin));
        let z = exit_along(direction.z, below.z.sub(margin), above.z.add(margin));
        x.smaller(y).smaller(z).store(&mut self.t_max);

        let (one, largest) = (L::splat(T::one()), L::splat(T::LARGEST));
        let smallest = largest.negate();
        Vectors::new(
            one.div(direction.x).smaller(largest).larger(smallest),
            one.div(direction.y).smaller(largest).larger(smallest),
            one.div(direction.z).smaller(largest).larger(smallest),
        )
        .store(&mut self.inverse);
        self.shear(direction);
    }

    /// [`ShearedRay::new`] of all rays.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn shear<L: Lanes<T>>(&mut self, direction: Vectors<T, L>) {
        let size = direction.magnitude();
        let larger = size.x.larger(size.y);
        let is_y = size.x.is_less(size.y);
        let is_z = larger.is_less(size.z);
        let Vectors { x, y, z, .. } = direction;
        // The component along the main axis, and those of the two axes that follow it.
        let main = L::if_less(larger, size.z, z, L::if_less(size.x, size.y, y, x));
        let first = L::if_less(larger, size.z, x, L::if_less(size.x, size.y, z, y));
        let second = L::if_less(larger, size.z, y, L::if_less(size.x, size.y, x, z));
        let zero = L::splat(T::zero());
        let is_backward = main.is_less(zero);
        let mut shears = [[T::zero(); LANE_COUNT]; 3];
        Vectors::new(
            L::if_less(main, zero, second, first).div(main),
            L::if_less(main, zero, first, second).div(main),
            L::splat(T::one()).div(main),
        )
        .store(&mut shears);
        for lane in 0..LANE_COUNT {
            let bit = |mask: Mask| usize::from(mask >> lane & 1);
            let main = if bit(is_z) == 1 { 2 } else { bit(is_y) };
            let axes = AXES[bit(is_backward)][main];
            let [x, y, z] = axes.map(usize::from);
            self.sheared[lane] = ShearedRay::from_parts(
                Vector3::new(self.origin[x][lane], self.origin[y][lane], self.origin[z][lane]),
                axes,
                Vector3::new(shears[0][lane], shears[1][lane], shears[2][lane]),
            );
        }
    }

    /// One of the rays.
    pub(crate) fn ray(&self, lane: usize) -> Ray<T> {
        Ray {
            origin: Vector3::new(self.origin[0][lane], self.origin[1][lane], self.origin[2][lane]),
            direction: Vector3::new(self.direction[0][lane], self.direction[1][lane], self.direction[2][lane]),
            t_max: self.t_max[lane],
        }
    }
}

/// The axes that become x, y and z, for rays along and against each main axis: the order keeps the winding.
const AXES: [[[u8; 3]; 3]; 2] = [[[1, 2, 0], [2, 0, 1], [0, 1, 2]], [[2, 1, 0], [0, 2, 1], [1, 0, 2]]];

/// Where rays leave a box along one axis, given the distances to its faces.
#[cfg_attr(not(debug_assertions), inline(always))]
fn exit_along<T: Scalar, L: Lanes<T>>(direction: L, below: L, above: L) -> L {
    let zero = L::splat(T::zero());
    let endless = L::splat(T::INFINITY);
    let forward = L::if_less(zero, direction, above.div(direction), endless);
    L::if_less(direction, zero, below.div(direction), forward)
}
