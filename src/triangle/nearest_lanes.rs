use crate::math::{Scalar, Vector3};
use crate::simd::{LANE_COUNT, Lanes, Mask, Vectors, vector_in_lane};
use crate::triangle::closest_point::ClosestPoint;

/// The edges of sixteen triangles, their corners in ascending order of their vertices, and what depends on them alone.
struct EdgeLanes<T: Scalar, L> {
    ab: Vectors<T, L>,
    ac: Vectors<T, L>,
    bc: Vectors<T, L>,
    inverse_ab: L,
    inverse_ac: L,
    inverse_bc: L,
    lean: L,
    across: Vectors<T, L>,
    inverse_across: L,
}

/// The nearest points of the three edges and of the triangle's plane: where they lie, and their squared distances.
struct Feet<L> {
    along_ab: L,
    on_ab: L,
    along_ac: L,
    on_ac: L,
    along_bc: L,
    on_bc: L,
    second: L,
    third: L,
    inside: L,
}

impl<L> Feet<L> {
    /// Which triangles have the foot of the perpendicular inside.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn are_inside<T: Scalar>(&self) -> Mask
    where
        L: Lanes<T>,
    {
        let (zero, one) = (L::splat(T::zero()), L::splat(T::one()));
        zero.is_less(self.second) & zero.is_less(self.third) & self.second.add(self.third).is_less(one)
    }

    /// The squared distance of each triangle, given that of the nearest point of its edges.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn or_inside<T: Scalar>(&self, on_edges: L) -> L
    where
        L: Lanes<T>,
    {
        let (zero, one) = (L::splat(T::zero()), L::splat(T::one()));
        let nearer = self.second.add(self.third).where_less(one, self.inside.smaller(on_edges), on_edges);
        zero.where_less(self.second, zero.where_less(self.third, nearer, on_edges), on_edges)
    }
}

impl<T: Scalar, L: Lanes<T>> EdgeLanes<T, L> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn new(a: Vectors<T, L>, b: Vectors<T, L>, c: Vectors<T, L>) -> Self {
        let one = L::splat(T::one());
        let (ab, ac, bc) = (b.sub(a), c.sub(a), c.sub(b));
        let inverse_ab = one.div(ab.dot(ab));
        let lean = ac.dot(ab).mul(inverse_ab);
        let across = ac.sub(ab.scaled(lean));
        Self {
            ab,
            ac,
            bc,
            inverse_ab,
            inverse_ac: one.div(ac.dot(ac)),
            inverse_bc: one.div(bc.dot(bc)),
            lean,
            across,
            inverse_across: one.div(across.dot(across)),
        }
    }

    /// [`TrianglePoint::new`](crate::triangle::TrianglePoint::new) in every lane, to the bit, given two corners as seen from
    /// the point, and the squared distances of all three.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn feet(&self, a: Vectors<T, L>, b: Vectors<T, L>, [square_a, square_b, square_c]: [L; 3]) -> Feet<L> {
        let along_ab = a.dot(self.ab).negate().mul(self.inverse_ab);
        let foot_on_ab = a.add(self.ab.scaled(along_ab));
        let along_ac = a.dot(self.ac).negate().mul(self.inverse_ac);
        let along_bc = b.dot(self.bc).negate().mul(self.inverse_bc);
        let third = foot_on_ab.dot(self.across).negate().mul(self.inverse_across);
        let second = along_ab.sub(third.mul(self.lean));
        let foot = foot_on_ab.add(self.across.scaled(third));
        Feet {
            along_ab,
            on_ab: clamped_square(along_ab, foot_on_ab, square_a, square_b),
            along_ac,
            on_ac: clamped_square(along_ac, a.add(self.ac.scaled(along_ac)), square_a, square_c),
            along_bc,
            on_bc: clamped_square(along_bc, b.add(self.bc.scaled(along_bc)), square_b, square_c),
            second,
            third,
            inside: foot.dot(foot),
        }
    }
}

/// The squared distance of an edge's nearest point, given the foot of the perpendicular and the squared distances of its ends.
#[cfg_attr(not(debug_assertions), inline(always))]
fn clamped_square<T: Scalar, L: Lanes<T>>(along: L, foot: Vectors<T, L>, at_start: L, at_end: L) -> L {
    let (zero, one) = (L::splat(T::zero()), L::splat(T::one()));
    let between = zero.where_less(along, foot.dot(foot), at_start);
    one.where_at_most(along, at_end, between)
}

/// Sixteen triangles made ready to be held against points, one after the other.
pub(crate) struct NearTriangles<T: Scalar, L> {
    corners: [Vectors<T, L>; 3],
    edges: EdgeLanes<T, L>,
}

impl<T: Scalar, L: Lanes<T>> NearTriangles<T, L> {
    /// Of sixteen vertices, axis by axis, and the places of the triangles' corners among them in ascending order of the
    /// vertices' numbers; in the scale of a query point.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn new(positions: &[[T; LANE_COUNT]; 3], places: &[[u8; LANE_COUNT]; 3], factor: T) -> Self {
        let vertices = Vectors::<T, L>::load(positions).scaled(L::splat(factor));
        // No closures here: they would be compiled for any processor.
        let a = vertices.permuted(&places[0]);
        let b = vertices.permuted(&places[1]);
        let c = vertices.permuted(&places[2]);
        Self { corners: [a, b, c], edges: EdgeLanes::new(a, b, c) }
    }

    /// The squared distance of each triangle's nearest point to a scaled point.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn squares(&self, point: &Vector3<T>) -> L {
        let point = Vectors::splat(point);
        let [a, b, c] = self.corners;
        let (a, b, c) = (a.sub(point), b.sub(point), c.sub(point));
        let feet = self.edges.feet(a, b, [a.dot(a), b.dot(b), c.dot(c)]);
        let on_edges = feet.on_bc.smaller(feet.on_ac.smaller(feet.on_ab));
        feet.or_inside(on_edges)
    }
}

/// The nearest points of sixteen triangles, each to a point of its own.
#[derive(Clone, Debug)]
// Whole rows of sixteen lie on lines of the cache.
#[repr(C, align(64))]
pub(crate) struct TrianglePoints<T: Scalar> {
    /// At the corners in ascending order of their vertices.
    pub(crate) weights: [[T; LANE_COUNT]; 3],
    pub(crate) position: [[T; LANE_COUNT]; 3],
    pub(crate) distance: [T; LANE_COUNT],
}

impl<T: Scalar> TrianglePoints<T> {
    pub(crate) fn empty() -> Self {
        let zeros = [T::zero(); LANE_COUNT];
        Self { weights: [zeros; 3], position: [zeros; 3], distance: zeros }
    }

    /// [`TrianglePoint::resolved`](crate::triangle::TrianglePoint::resolved) in every lane, to the bit. The points are scaled.
    /// The corners, in ascending order of their vertices, are not.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn set<L: Lanes<T>>(
        &mut self,
        points: &[[T; LANE_COUNT]; 3],
        corners: [Vectors<T, L>; 3],
        [factor, inverse]: [T; 2],
    ) {
        let (zero, one, half) = (L::splat(T::zero()), L::splat(T::one()), L::splat(T::of(0.5)));
        let (points, factor) = (Vectors::<T, L>::load(points), L::splat(factor));
        let [at_a, at_b, at_c] = corners;
        let (a, b, c) = (at_a.scaled(factor), at_b.scaled(factor), at_c.scaled(factor));
        let edges = EdgeLanes::new(a, b, c);
        let (a, b, c) = (a.sub(points), b.sub(points), c.sub(points));
        let feet = edges.feet(a, b, [a.dot(a), b.dot(b), c.dot(c)]);

        let along_ab = clamped_along(feet.along_ab);
        let mut square = feet.on_ab;
        let mut weights = Vectors::new(one.sub(along_ab), along_ab, zero);
        let along_ac = clamped_along(feet.along_ac);
        let is_nearer = feet.on_ac.is_less(square);
        square = L::select(is_nearer, feet.on_ac, square);
        weights = Vectors::select(is_nearer, Vectors::new(one.sub(along_ac), zero, along_ac), weights);
        let along_bc = clamped_along(feet.along_bc);
        let is_nearer = feet.on_bc.is_less(square);
        square = L::select(is_nearer, feet.on_bc, square);
        weights = Vectors::select(is_nearer, Vectors::new(zero, one.sub(along_bc), along_bc), weights);
        let is_nearer = feet.are_inside() & feet.inside.is_less(square);
        square = L::select(is_nearer, feet.inside, square);
        let (second, third) = (feet.second, feet.third);
        weights = Vectors::select(is_nearer, Vectors::new(one.sub(second.add(third)), second, third), weights);
        weights.store(&mut self.weights);
        square.sqrt().mul(L::splat(inverse)).store(&mut self.distance);

        let (a, b, c) = (at_a.scaled(half), at_b.scaled(half), at_c.scaled(half));
        let on_third_edge = b.add(c.sub(b).scaled(weights.z)).divided(half);
        let on_others = a.add(b.sub(a).scaled(weights.y).add(c.sub(a).scaled(weights.z))).divided(half);
        let mut position = Vectors::select(weights.x.is_at_most(zero), on_third_edge, on_others);
        position = Vectors::select(one.is_at_most(weights.z), at_c, position);
        position = Vectors::select(one.is_at_most(weights.y), at_b, position);
        position = Vectors::select(one.is_at_most(weights.x), at_a, position);
        position.store(&mut self.position);
    }

    /// One of them; `places` are those of the corners, in ascending order of their vertices, in the triangle.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn get(&self, lane: usize, triangle: u32, places: [usize; 3]) -> ClosestPoint<T> {
        let mut weights = [T::zero(); 3];
        for corner in 0..3 {
            weights[places[corner]] = self.weights[corner][lane];
        }
        ClosestPoint {
            triangle,
            weights,
            position: vector_in_lane(&self.position, lane),
            distance: self.distance[lane],
        }
    }
}

/// Where along an edge its nearest point is, given where the foot of the perpendicular is.
#[cfg_attr(not(debug_assertions), inline(always))]
fn clamped_along<T: Scalar, L: Lanes<T>>(along: L) -> L {
    let (zero, one) = (L::splat(T::zero()), L::splat(T::one()));
    one.where_at_most(along, one, zero.where_less(along, along, zero))
}
