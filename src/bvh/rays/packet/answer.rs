use crate::bvh::rays::packet::hits::PacketHits;
use crate::math::Scalar;
use crate::simd::{LANE_COUNT, Lanes, Lists, Mask};
use crate::triangle::HitLanes;

/// The question that the rays of a packet ask.
pub(crate) trait Answer<T: Scalar> {
    /// Whether only hits from inside count.
    const EXITS_ONLY: bool;

    /// The `t` of each ray beyond which hits no longer change the answer.
    fn end(&self) -> &[T; LANE_COUNT];

    /// Which rays have their final answer.
    fn settled(&self) -> Mask;

    /// Which of a tile's triangles do not count for a ray, given the tile's vertices and each triangle's set of them.
    fn excluded<L: Lanes<T>>(&self, ray: usize, vertices: &[u32; LANE_COUNT], corners: &[[u8; LANE_COUNT]; 3]) -> Mask;

    /// Records the hit of one lane.
    fn add(&mut self, ray: usize, triangle: u32, hits: &HitLanes<T>, lane: usize);
}

/// The nearest hit of each ray.
pub(crate) struct Nearest<'a, T: Scalar> {
    /// The `t` of each ray's nearest hit so far, or else of its end.
    pub(crate) end: [T; LANE_COUNT],
    pub(crate) hits: &'a mut PacketHits<T>,
}

impl<T: Scalar> Answer<T> for Nearest<'_, T> {
    const EXITS_ONLY: bool = false;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn end(&self) -> &[T; LANE_COUNT] {
        &self.end
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn settled(&self) -> Mask {
        0
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn excluded<L: Lanes<T>>(&self, _: usize, _: &[u32; LANE_COUNT], _: &[[u8; LANE_COUNT]; 3]) -> Mask {
        0
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn add(&mut self, ray: usize, triangle: u32, found: &HitLanes<T>, lane: usize) {
        let (hits, t, bit) = (&mut *self.hits, found.t[lane], 1 << ray);
        let is_first = hits.found & bit == 0;
        if t < self.end[ray] || (t == self.end[ray] && (is_first || triangle < hits.triangle[ray])) {
            self.end[ray] = t;
            hits.found |= bit;
            hits.exits = hits.exits & !bit | (found.exits >> lane & 1) << ray;
            hits.triangle[ray] = triangle;
            hits.t[ray] = t;
            for corner in 0..3 {
                hits.weights[corner][ray] = found.weights[corner][lane];
            }
        }
    }
}

/// Which rays leave the mesh before their end.
pub(crate) struct Hidden<'a, T: Scalar> {
    pub(crate) end: &'a [T; LANE_COUNT],
    pub(crate) touched: &'a [[u32; LANE_COUNT]; 3],
    pub(crate) hidden: Mask,
}

impl<T: Scalar> Answer<T> for Hidden<'_, T> {
    const EXITS_ONLY: bool = true;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn end(&self) -> &[T; LANE_COUNT] {
        self.end
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn settled(&self) -> Mask {
        self.hidden
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn excluded<L: Lanes<T>>(&self, ray: usize, vertices: &[u32; LANE_COUNT], corners: &[[u8; LANE_COUNT]; 3]) -> Mask {
        excluded_around::<T, L>(self.touched.each_ref().map(|vertices| vertices[ray]), vertices, corners)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn add(&mut self, ray: usize, _: u32, found: &HitLanes<T>, lane: usize) {
        let leaves = found.exits >> lane & 1 == 1 && found.t[lane] < self.end[ray];
        self.hidden |= Mask::from(leaves) << ray;
    }
}

/// Which of a tile's triangles have all of three vertices, which may be the same.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn excluded_around<T: Scalar, L: Lanes<T>>(
    [a, b, c]: [u32; 3],
    vertices: &[u32; LANE_COUNT],
    corners: &[[u8; LANE_COUNT]; 3],
) -> Mask {
    // The last vertex of a tile is repeated, but triangles name its first place.
    let with_corner = |places: Mask| L::Lists::with_corner(corners, places.trailing_zeros() as u8);
    let first = L::Lists::equal(vertices, a);
    if b == a && c == a {
        return if first == 0 { 0 } else { with_corner(first) };
    }
    let (second, third) = (L::Lists::equal(vertices, b), L::Lists::equal(vertices, c));
    if first == 0 || second == 0 || third == 0 {
        return 0;
    }
    with_corner(first) & with_corner(second) & with_corner(third)
}
