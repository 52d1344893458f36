use crate::math::{Aabb, Scalar, Vector3, margins};
use crate::simd::{LANE_COUNT, Lanes, Mask, Vectors, set_lane, vector_in_lane};
use crate::triangle::main_axis::MainAxes;
use crate::triangle::ray::Ray;
use crate::triangle::watertight::ShearedRay;

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
    /// [`ShearedRay`] of each ray: the origin along the ray's own axes, the shear, and which axes these are.
    pub(crate) turned_origin: [[T; LANE_COUNT]; 3],
    pub(crate) shear: [[T; LANE_COUNT]; 3],
    pub(crate) axes: [u8; LANE_COUNT],
    /// Which lanes hold a ray.
    pub(crate) present: Mask,
}

impl<T: Scalar> RayPacket<T> {
    pub(crate) fn empty() -> Self {
        let zeros = [T::zero(); LANE_COUNT];
        Self {
            present: 0,
            origin: [zeros; 3],
            direction: [zeros; 3],
            t_max: zeros,
            inverse: [zeros; 3],
            turned_origin: [zeros; 3],
            shear: [zeros; 3],
            axes: [0; LANE_COUNT],
        }
    }

    /// Prepares the rays one by one, with the same bits: some of them are not finite.
    #[cold]
    fn prepare_one_by_one(&mut self) {
        for lane in 0..LANE_COUNT {
            let ray = self.ray(lane);
            let sheared = ShearedRay::new(&ray);
            let inverse = ray.direction.map(|d| (T::one() / d).clamp(-T::LARGEST, T::LARGEST));
            set_lane(&mut self.inverse, lane, &inverse);
            set_lane(&mut self.turned_origin, lane, &sheared.origin);
            set_lane(&mut self.shear, lane, &sheared.shear);
            self.axes[lane] = sheared.axes;
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn place(&mut self, rays: &[Ray<T>]) {
        self.present = ((1u32 << rays.len()) - 1) as Mask;
        // Lanes behind the last repeat it, so that nothing undefined is computed there.
        for lane in 0..LANE_COUNT {
            let Ray { origin, direction, t_max } = &rays[lane.min(rays.len() - 1)];
            set_lane(&mut self.origin, lane, origin);
            set_lane(&mut self.direction, lane, direction);
            self.t_max[lane] = *t_max;
        }
    }

    /// Takes up to sixteen rays.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn set_rays<L: Lanes<T>>(&mut self, rays: &[Ray<T>]) {
        self.place(rays);
        let (origin, direction) = (Vectors::<T, L>::load(&self.origin), Vectors::load(&self.direction));
        if direction.magnitude().are_at_most(Vectors::splat(&Vector3::repeat(T::LARGEST))) != Mask::MAX {
            return self.prepare_one_by_one();
        }
        clamped_inverse(direction).store(&mut self.inverse);
        let axes = MainAxes::new(direction);
        self.axes = axes.places();
        axes.turned(origin).store(&mut self.turned_origin);
        let turned = axes.turned(direction);
        let inverse = L::splat(T::one()).div(turned.z);
        Vectors::new(turned.x.div(turned.z), turned.y.div(turned.z), inverse).store(&mut self.shear);
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
            below.magnitude().larger(above.magnitude()).largest().mul(L::splat(margins::margin(margins::RAY_END)));
        let inverse = clamped_inverse(direction);
        inverse.store(&mut self.inverse);
        // Of a box's two faces across an axis, a ray from inside leaves by the one that lies ahead.
        let margin = Vectors::new(margin, margin, margin);
        let exits = below.sub(margin).times(inverse).larger(above.add(margin).times(inverse));
        exits.x.smaller(exits.y).smaller(exits.z).store(&mut self.t_max);

        // As `ShearedRay::new`; a unit vector's largest component is far from zero.
        let axes = MainAxes::new(direction);
        self.axes = axes.places();
        axes.turned(origin).store(&mut self.turned_origin);
        let (turned, inverse) = (axes.turned(direction), axes.turned(inverse).z);
        Vectors::new(turned.x.div(turned.z), turned.y.div(turned.z), inverse).store(&mut self.shear);
    }

    /// One of the rays.
    pub(crate) fn ray(&self, lane: usize) -> Ray<T> {
        let [origin, direction] = [&self.origin, &self.direction].map(|rows| vector_in_lane(rows, lane));
        Ray { origin, direction, t_max: self.t_max[lane] }
    }
}

/// Of each component; finite where that is zero.
#[cfg_attr(not(debug_assertions), inline(always))]
fn clamped_inverse<T: Scalar, L: Lanes<T>>(direction: Vectors<T, L>) -> Vectors<T, L> {
    let (ones, most) = (Vectors::splat(&Vector3::repeat(T::one())), Vectors::splat(&Vector3::repeat(T::LARGEST)));
    ones.divided_by(direction).smaller(most).larger(most.negate())
}
