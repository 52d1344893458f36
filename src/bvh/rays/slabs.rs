//! Boxes as rays meet them.

use crate::bvh::node::Node;
use crate::math::margins::{self, reaches_told_apart};
use crate::math::{Aabb, Scalar, Vector3};
use crate::simd::{LANE_COUNT, Lanes, Mask, Vectors, vector_in_lane};
use crate::triangle::{Ray, RayPacket};

/// The planes of boxes as sixteen rays meet them: a face at `x` is met at t = x · inverse + offset.
pub(crate) struct PacketSlabs<T: Scalar, L> {
    origin: Vectors<T, L>,
    inverse: Vectors<T, L>,
    /// For the lower and for the upper faces, each moved outward a little.
    offsets: [Vectors<T, L>; 2],
    /// A bound of how coarsely distances from the origins to the mesh are rounded.
    margin: L,
    /// Rays for which the above would overflow or underflow: taken to meet every box.
    pub(crate) meet_all: Mask,
}

impl<T: Scalar, L: Lanes<T>> PacketSlabs<T, L> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn new(packet: &RayPacket<T>, mesh_box: &Aabb<T>) -> Self {
        let (origin, inverse) = (Vectors::<T, L>::load(&packet.origin), Vectors::load(&packet.inverse));
        let below = Vectors::splat(&mesh_box.lower).sub(origin).magnitude();
        let above = Vectors::splat(&mesh_box.upper).sub(origin).magnitude();
        let reach = below.larger(above).largest();
        let rounding = L::splat(margins::margin(margins::BOX_FACE));
        // Products with a coordinate are rounded as coarsely as it is far from zero.
        let coordinates = reach.add(origin.magnitude().largest());
        let moved = coordinates.mul(rounding);
        let moved = Vectors::new(moved, moved, moved);
        // Where a direction has no part along an axis, the face lies finitely far away, but behind every end.
        let lengths = coordinates.larger(L::splat(T::one()));
        let limit = L::splat(T::LARGEST * T::of(0.5)).div(lengths);
        let limit = Vectors::new(limit, limit, limit);
        let inverse = inverse.smaller(limit).larger(limit.negate());
        let offsets = [origin.add(moved).times(inverse).negate(), origin.sub(moved).times(inverse).negate()];
        let longest = Vectors::<T, L>::load(&packet.direction).magnitude().largest();
        let [least, most] = reaches_told_apart();
        let told_apart =
            longest.mul(L::splat(least)).is_at_most(coordinates) & lengths.is_at_most(longest.mul(L::splat(most)));
        Self { origin, inverse, offsets, margin: reach.mul(rounding), meet_all: !told_apart }
    }

    /// Bit i: ray i meets this box, not beyond its end.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn meeting(&self, aabb: &Aabb<T>, end: L) -> Mask {
        self.entering(aabb, end).1
    }

    /// Where the rays enter this box, and which of them meet it, not beyond its end.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn entering(&self, aabb: &Aabb<T>, end: L) -> (L, Mask) {
        let (enters, leaves) = self.passing(aabb, end);
        // Such rays enter where they start.
        (L::select(self.meet_all, L::splat(T::zero()), enters), enters.is_at_most(leaves) | self.meet_all)
    }

    /// Where the rays enter this box, and where they leave it or end; of those that do not meet it, the first is beyond the
    /// second.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn passing(&self, aabb: &Aabb<T>, end: L) -> (L, L) {
        let at_lower = Vectors::splat(&aabb.lower).times_add(self.inverse, self.offsets[0]);
        let at_upper = Vectors::splat(&aabb.upper).times_add(self.inverse, self.offsets[1]);
        let (enters, leaves) = (at_lower.smaller(at_upper), at_lower.larger(at_upper));
        let enters = enters.largest().larger(L::splat(T::zero()));
        (enters, leaves.x.smaller(leaves.y).smaller(leaves.z).smaller(end))
    }

    /// The same, ray by ray.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn singles(&self) -> SingleSlabs<T> {
        let zeros = [[T::zero(); LANE_COUNT]; 3];
        let mut singles = SingleSlabs { inverse: zeros, offsets: [zeros; 2], meet_all: self.meet_all };
        self.inverse.store(&mut singles.inverse);
        self.offsets[0].store(&mut singles.offsets[0]);
        self.offsets[1].store(&mut singles.offsets[1]);
        singles
    }

    /// A box that holds the asked rays, and all triangles that the test may accept for them.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn box_around(
        &self,
        packet: &RayPacket<T>,
        end: &[T; LANE_COUNT],
        asked: Mask,
        mesh_box: &Aabb<T>,
    ) -> Aabb<T> {
        self.box_between(packet, self.origin, L::load(end), asked).unwrap_or(*mesh_box)
    }

    /// The same for the parts of the rays in the mesh's box: smaller where rays come from far away, or go far.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn box_inside(
        &self,
        packet: &RayPacket<T>,
        end: &[T; LANE_COUNT],
        asked: Mask,
        mesh_box: &Aabb<T>,
    ) -> Aabb<T> {
        let (enters, leaves) = self.passing(mesh_box, L::load(end));
        let asked = asked & (enters.is_at_most(leaves) | self.meet_all);
        if asked & self.meet_all != 0 {
            return *mesh_box;
        }
        let first = self.origin.add(Vectors::load(&packet.direction).scaled(enters));
        self.box_between(packet, first, leaves, asked).unwrap_or(*mesh_box)
    }

    /// A box that holds the rays from these points to their ends, if those are finite.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn box_between(&self, packet: &RayPacket<T>, first: Vectors<T, L>, end: L, asked: Mask) -> Option<Aabb<T>> {
        let end = self.origin.add(Vectors::load(&packet.direction).scaled(end));
        let is_finite = end.magnitude().are_at_most(Vectors::splat(&Vector3::repeat(T::LARGEST)));
        if asked & !is_finite != 0 {
            return None;
        }
        // The end is rounded as coarsely as its coordinates are.
        let largest = self.origin.magnitude().largest().larger(end.magnitude().largest());
        let grown = self.margin.add(largest.mul(L::splat(margins::margin(margins::END_POINT))));
        let grown = Vectors::new(grown, grown, grown);
        let (lower, upper) = (first.smaller(end).sub(grown), first.larger(end).add(grown));
        let endless = Vectors::splat(&Vector3::repeat(T::INFINITY));
        Some(Aabb {
            lower: Vectors::select(asked, lower, endless).smallest_lanes(),
            upper: Vectors::select(asked, upper, endless.negate()).greatest_lanes(),
        })
    }
}

/// [`PacketSlabs`] ray by ray.
#[repr(C, align(64))]
pub(crate) struct SingleSlabs<T: Scalar> {
    inverse: [[T; LANE_COUNT]; 3],
    offsets: [[[T; LANE_COUNT]; 3]; 2],
    meet_all: Mask,
}

impl<T: Scalar> SingleSlabs<T> {
    /// Those of one ray.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn of(&self, ray: usize) -> RaySlabs<T> {
        RaySlabs {
            inverse: vector_in_lane(&self.inverse, ray),
            offsets: self.offsets.each_ref().map(|offsets| vector_in_lane(offsets, ray)),
            meets_all: self.meet_all >> ray & 1 == 1,
        }
    }
}

/// The planes of boxes as one ray meets them.
pub(crate) struct RaySlabs<T: Scalar> {
    inverse: Vector3<T>,
    offsets: [Vector3<T>; 2],
    meets_all: bool,
}

impl<T: Scalar> RaySlabs<T> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn new(ray: &Ray<T>, mesh_box: &Aabb<T>) -> Self {
        let reach = |axis: usize| {
            let (below, above) = (mesh_box.lower[axis] - ray.origin[axis], mesh_box.upper[axis] - ray.origin[axis]);
            larger(below.abs(), above.abs())
        };
        let [x, y, z] = [0, 1, 2].map(|axis| ray.origin[axis].abs());
        let coordinates = larger(larger(reach(0), reach(1)), reach(2)) + larger(larger(x, y), z);
        let moved = coordinates * margins::margin(margins::BOX_FACE);
        let lengths = larger(coordinates, T::one());
        let limit = T::LARGEST * T::of(0.5) / lengths;
        let inverse = ray.direction.map(|d| (T::one() / d).clamp(-limit, limit));
        let (length, [least, most]) = (ray.direction.amax(), reaches_told_apart());
        let offset = |from: Vector3<T>| -from.component_mul(&inverse);
        Self {
            inverse,
            offsets: [offset(ray.origin.add_scalar(moved)), offset(ray.origin.add_scalar(-moved))],
            meets_all: coordinates < length * least || lengths > length * most,
        }
    }

    /// Where the ray enters the boxes of a node's children, and which of them it meets, not beyond its end.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn entering<L: Lanes<T>>(&self, node: &Node<T>, end: T) -> (L, Mask) {
        let (mut enters, mut leaves) = (L::splat(T::zero()), L::splat(end));
        if self.meets_all {
            return (enters, node.present());
        }
        let faces = [&node.lower, &node.upper];
        for axis in 0..3 {
            let inverse = L::splat(self.inverse[axis]);
            // It is known which of two faces comes first. No branch: directions are hard to foretell.
            let first = usize::from(self.inverse[axis] < T::zero());
            let (near, far) = (&faces[first][axis], &faces[1 - first][axis]);
            let offsets = [L::splat(self.offsets[first][axis]), L::splat(self.offsets[1 - first][axis])];
            enters = L::load(near).times_add(inverse, offsets[0]).larger(enters);
            leaves = L::load(far).times_add(inverse, offsets[1]).smaller(leaves);
        }
        (enters, enters.is_at_most(leaves) & node.present())
    }
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn larger<T: Scalar>(a: T, b: T) -> T {
    if a > b { a } else { b }
}
