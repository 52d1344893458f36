use super::{Mesh, RING_LENGTH, VertexNormal};
use crate::math::{Scalar, Vector3, direction, length, margins};
use crate::simd::{LANE_COUNT, Lanes, Lists, Mask, Vectors, lanes_of, set_lane};

/// Sixteen points with their normals, coordinate by coordinate.
#[derive(Clone, Copy, Debug)]
// Whole rows of sixteen lie on lines of the cache.
#[repr(C, align(64))]
pub(crate) struct NormalLanes<T: Scalar> {
    pub(crate) position: [[T; LANE_COUNT]; 3],
    /// Outward, of unit length.
    pub(crate) normal: [[T; LANE_COUNT]; 3],
    pub(crate) area: [T; LANE_COUNT],
    /// Where the points are vertices, the first two vertices around each, which form a triangle with it.
    pub(crate) neighbours: [[u32; LANE_COUNT]; 2],
    /// Which lanes have a normal; the others hold nothing of use.
    pub(crate) found: Mask,
    /// Which normals are known to face outward from each triangle around them.
    pub(crate) outward: Mask,
}

impl<T: Scalar> NormalLanes<T> {
    pub(crate) fn empty() -> Self {
        let zeros = [T::zero(); LANE_COUNT];
        let neighbours = [[0; LANE_COUNT]; 2];
        Self { found: 0, outward: 0, position: [zeros; 3], normal: [zeros; 3], area: zeros, neighbours }
    }
}

/// A visitor of the triangles around sixteen vertices side by side, in their order around each vertex.
pub(crate) trait Fan<T: Scalar> {
    /// The next triangle of each vertex, between two edges; `is_triangle` where there is one, `is_safe` where the square of
    /// its normal has lost nothing.
    fn add<L: Lanes<T>>(&mut self, edges: [Vectors<T, L>; 2], normal: Vectors<T, L>, is_safe: Mask, is_triangle: Mask);
}

/// A visitor that does nothing.
struct NormalsAlone;

impl<T: Scalar> Fan<T> for NormalsAlone {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn add<L: Lanes<T>>(&mut self, _: [Vectors<T, L>; 2], _: Vectors<T, L>, _: Mask, _: Mask) {}
}

impl<T: Scalar> Mesh<T> {
    /// The normal at a vertex, from the positions of this step; `None` where the surrounding triangles have no area
    /// or cancel out.
    pub fn vertex_normal(&self, vertex: u32) -> Option<VertexNormal<T>> {
        let base = self.position(vertex);
        let (mut sum, mut doubled_area) = (Vector3::zeros(), T::zero());
        for pair in self.topology().ring(vertex).windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|other| self.position(other) - base);
            let normal = a.cross(&b);
            sum += normal;
            doubled_area += length(&normal);
        }
        Some(VertexNormal { normal: direction(&sum)?, area: doubled_area / T::of(6.0) })
    }

    /// [`vertex_normal`](Self::vertex_normal) of up to sixteen vertices, to the bit.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn vertex_normals<L: Lanes<T>>(&self, vertices: &[u32], found: &mut NormalLanes<T>) {
        self.vertex_normals_and::<L>(vertices, found, &mut NormalsAlone);
    }

    /// The same, and shows the triangles around each vertex to `fan`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn vertex_normals_and<L: Lanes<T>>(
        &self,
        vertices: &[u32],
        found: &mut NormalLanes<T>,
        fan: &mut impl Fan<T>,
    ) {
        let count = vertices.len().min(LANE_COUNT);
        let own = match vertices.first_chunk::<LANE_COUNT>() {
            Some(all) => *all,
            None => std::array::from_fn(|lane| *vertices.get(lane).unwrap_or(&vertices[0])),
        };
        let (rings, ring_start) = self.topology().rings();
        let starts = L::Lists::gather_indices(ring_start, &own);
        let ends = L::Lists::gather_indices(ring_start, &own.map(|vertex| vertex + 1));
        let mut longest = 0;
        for (start, end) in starts.iter().zip(&ends) {
            longest = longest.max(end - start);
        }
        let base = self.gather::<L>(&own);
        base.store(&mut found.position);
        let zero = L::splat(T::zero());
        let (least, greatest) = (L::splat(T::SAFE_SQUARES.0), L::splat(T::SAFE_SQUARES.1));
        let (mut sum, mut doubled_area, mut smallest) = (Vectors::zeros(), zero, L::splat(T::INFINITY));
        let mut unsafe_squares = 0;
        let (mut before, mut has_length_before) = (Vectors::zeros(), 0);
        for place in 0..longest as usize {
            let mut others = own;
            if place < RING_LENGTH {
                others = L::Lists::gather_indices(rings, &starts.map(|start| start + place as u32));
            } else {
                for (other, vertex) in others.iter_mut().zip(own) {
                    // Beyond a ring's end stands the vertex itself: an edge of no length adds nothing.
                    *other = *self.topology().ring(vertex).get(place).unwrap_or(&vertex);
                }
            }
            if let Some(neighbours) = found.neighbours.get_mut(place) {
                *neighbours = others;
            }
            let edge = self.gather::<L>(&others).sub(base);
            let has_length = zero.is_less(edge.magnitude().largest());
            let normal = before.cross(edge);
            let square = normal.dot(normal);
            let is_safe = least.is_at_most(square) & square.is_at_most(greatest);
            let is_triangle = has_length & has_length_before;
            fan.add([before, edge], normal, is_safe, is_triangle);
            unsafe_squares |= !is_safe & is_triangle;
            sum = sum.add(normal);
            let doubled = square.sqrt();
            doubled_area = doubled_area.add(doubled);
            smallest = L::select(zero.is_less(square), smallest.smaller(doubled), smallest);
            (before, has_length_before) = (edge, has_length);
        }
        let square = sum.dot(sum);
        unsafe_squares |= !(least.is_at_most(square) & square.is_at_most(greatest));
        let along = square.sqrt();
        sum.divided(along).store(&mut found.normal);
        doubled_area.div(L::splat(T::of(6.0))).store(&mut found.area);
        found.found = ((1u32 << count) - 1) as Mask;
        // A triangle that faces the other way adds its |n| to Σ|n| and nothing to |Σ n|.
        let missing =
            doubled_area.sub(along).add(doubled_area.mul(L::splat(margins::margin(margins::SUM_AROUND_VERTEX))));
        found.outward = missing.is_less(smallest.mul(L::splat(T::of(margins::LEAST_NORMAL)))) & !unsafe_squares;
        for lane in lanes_of(unsafe_squares & found.found) {
            self.find_alone(lane, own[lane], found);
        }
    }

    /// Finds the normal of one lane by [`vertex_normal`](Self::vertex_normal), which copes with squares too large or too small.
    #[cold]
    fn find_alone(&self, lane: usize, vertex: u32, found: &mut NormalLanes<T>) {
        match self.vertex_normal(vertex) {
            Some(VertexNormal { normal, area }) => {
                set_lane(&mut found.normal, lane, &normal);
                found.area[lane] = area;
            }
            None => found.found &= !(1 << lane),
        }
    }
}
