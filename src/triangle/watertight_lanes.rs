use crate::math::Scalar;
use crate::simd::{LANE_COUNT, Lanes, Mask, Vectors, vector_in_lane};
use crate::triangle::main_axis::{AXES, MainAxes};
use crate::triangle::ray::Hit;
use crate::triangle::ray_packet::RayPacket;
use crate::triangle::watertight::{ShearedRay, intersect_projected};

/// The corners of sixteen triangles, each with the ray to be tested against it: coordinate by coordinate, in the order
/// of the ray's own axes.
#[derive(Clone, Debug)]
// Whole rows of sixteen lie on lines of the cache.
#[repr(C, align(64))]
pub(crate) struct TriangleLanes<T: Scalar> {
    corners: [[[T; LANE_COUNT]; 3]; 3],
    origin: [[T; LANE_COUNT]; 3],
    shear: [[T; LANE_COUNT]; 3],
}

/// Hits of sixteen rays with a triangle each.
#[derive(Clone, Debug)]
// Whole rows of sixteen lie on lines of the cache.
#[repr(C, align(64))]
pub(crate) struct HitLanes<T: Scalar> {
    pub(crate) t: [T; LANE_COUNT],
    pub(crate) weights: [[T; LANE_COUNT]; 3],
    /// Which lanes have a hit; the others hold nothing of use.
    pub(crate) found: Mask,
    /// Which rays leave.
    pub(crate) exits: Mask,
}

impl<T: Scalar> HitLanes<T> {
    pub(crate) fn empty() -> Self {
        let zeros = [T::zero(); LANE_COUNT];
        Self { found: 0, exits: 0, t: zeros, weights: [zeros; 3] }
    }
}

impl<T: Scalar> TriangleLanes<T> {
    pub(crate) fn empty() -> Self {
        let zeros = [[T::zero(); LANE_COUNT]; 3];
        Self { corners: [zeros; 3], origin: zeros, shear: zeros }
    }

    /// Takes the rays of a packet, given by their lanes, and a triangle for each.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn set<L: Lanes<T>>(
        &mut self,
        packet: &RayPacket<T>,
        rays: &[u8; LANE_COUNT],
        corners: [Vectors<T, L>; 3],
    ) {
        let axes = MainAxes::new(Vectors::<T, L>::load(&packet.direction).permuted(rays));
        Vectors::<T, L>::load(&packet.turned_origin).permuted(rays).store(&mut self.origin);
        Vectors::<T, L>::load(&packet.shear).permuted(rays).store(&mut self.shear);
        for corner in 0..3 {
            axes.turned(corners[corner]).store(&mut self.corners[corner]);
        }
    }

    /// [`ShearedRay::intersect`] in every lane, to the bit.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn intersect<L: Lanes<T>>(&self, hits: &mut HitLanes<T>) {
        let (origin, shear) = (Vectors::<T, L>::load(&self.origin), Vectors::load(&self.shear));
        let a = project(Vectors::load(&self.corners[0]), origin, shear);
        let b = project(Vectors::load(&self.corners[1]), origin, shear);
        let c = project(Vectors::load(&self.corners[2]), origin, shear);
        let (u, v, w) = (edge_function(c, b), edge_function(a, c), edge_function(b, a));
        let (zero, largest) = (L::splat(T::zero()), L::splat(T::LARGEST));
        let all_right = zero.is_at_most(u) & zero.is_at_most(v) & zero.is_at_most(w);
        let all_left = u.is_at_most(zero) & v.is_at_most(zero) & w.is_at_most(zero);
        let determinant = u.add(v).add(w);
        let exits = determinant.is_less(zero);
        let has_area = (exits | zero.is_less(determinant)) & determinant.magnitude().is_at_most(largest);
        let weights = Vectors::new(u, v, w).divided(determinant);
        let t = weights.x.mul(a.z).add(weights.y.mul(b.z)).add(weights.z.mul(c.z));
        let is_ahead = zero.is_at_most(t) & t.is_at_most(largest);
        hits.found = (all_right | all_left) & has_area & is_ahead;
        hits.exits = exits;
        t.store(&mut hits.t);
        weights.store(&mut hits.weights);
    }
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn project<T: Scalar, L: Lanes<T>>(
    corner: Vectors<T, L>,
    origin: Vectors<T, L>,
    shear: Vectors<T, L>,
) -> Vectors<T, L> {
    let from_origin = corner.sub(origin);
    Vectors::new(
        from_origin.x.sub(shear.x.mul(from_origin.z)),
        from_origin.y.sub(shear.y.mul(from_origin.z)),
        shear.z.mul(from_origin.z),
    )
}

/// That of `watertight.rs`, to the bit.
#[cfg_attr(not(debug_assertions), inline(always))]
fn edge_function<T: Scalar, L: Lanes<T>>(p: Vectors<T, L>, q: Vectors<T, L>) -> L {
    let right = p.y.mul(q.x);
    let right_error = p.y.negate().mul_add(q.x, right);
    p.x.mul_add(q.y, right.negate()).add(right_error)
}

impl<T: Scalar> RayPacket<T> {
    /// Which triangles of a group have an edge function above zero, and which one below, as one of the rays sees them. The group
    /// has up to sixteen triangles, given by the places of their corners among up to sixteen vertices. The ray meets no triangle
    /// with both, and can only enter one with the first. A rounded edge function that is not zero has the exact one's sign, so
    /// no triangle that [`ShearedRay::intersect`] accepts is left out.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn sides<L: Lanes<T>>(
        &self,
        ray: usize,
        positions: &[[T; LANE_COUNT]; 3],
        corners: &[[u8; LANE_COUNT]; 3],
    ) -> [Mask; 2] {
        let origin = Vectors::splat(&vector_in_lane(&self.turned_origin, ray));
        let shear = [L::splat(self.shear[0][ray]), L::splat(self.shear[1][ray])];
        L::sides(sheared(self.axes[ray], origin, shear, positions).0, corners)
    }
}

impl<T: Scalar> ShearedRay<T> {
    /// Which triangles of such a group the ray may meet, and the vertices as it sees them. No triangle that
    /// [`intersect`](Self::intersect) accepts is left out.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn may_meet<L: Lanes<T>>(
        &self,
        positions: &[[T; LANE_COUNT]; 3],
        corners: &[[u8; LANE_COUNT]; 3],
    ) -> (Mask, Vectors<T, L>) {
        let shear = [L::splat(self.shear.x), L::splat(self.shear.y)];
        let ([x, y], along) = sheared(self.axes, Vectors::splat(&self.origin), shear, positions);
        let [right, left] = L::sides([x, y], corners);
        (!(right & left), Vectors::new(x, y, L::splat(self.shear.z).mul(along)))
    }
}

/// The corners of up to sixteen triangles as one ray sees them.
pub(crate) struct ProjectedTriangles<T> {
    corners: [[[T; LANE_COUNT]; 3]; 3],
}

impl<T: Scalar> ProjectedTriangles<T> {
    /// Given the vertices, and the places of the triangles' corners among them.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn new<L: Lanes<T>>(vertices: Vectors<T, L>, places: &[[u8; LANE_COUNT]; 3]) -> Self {
        let mut corners = [[[T::zero(); LANE_COUNT]; 3]; 3];
        for corner in 0..3 {
            vertices.permuted(&places[corner]).store(&mut corners[corner]);
        }
        Self { corners }
    }

    /// [`ShearedRay::intersect`] with one of them, to the bit.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn intersect(&self, place: usize, triangle: u32) -> Option<Hit<T>> {
        intersect_projected(&self.corners.each_ref().map(|corner| vector_in_lane(corner, place)), triangle)
    }
}

/// Where the ray sees the points: across it, and how far along its main axis.
#[cfg_attr(not(debug_assertions), inline(always))]
fn sheared<T: Scalar, L: Lanes<T>>(
    axes: u8,
    origin: Vectors<T, L>,
    shear: [L; 2],
    positions: &[[T; LANE_COUNT]; 3],
) -> ([L; 2], L) {
    let [x, y, z] = AXES[usize::from(axes)].map(usize::from);
    let along = L::load(&positions[z]).sub(origin.z);
    let right = L::load(&positions[x]).sub(origin.x).sub(shear[0].mul(along));
    let up = L::load(&positions[y]).sub(origin.y).sub(shear[1].mul(along));
    ([right, up], along)
}
