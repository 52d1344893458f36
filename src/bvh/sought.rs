//! Which triangle is sought as the nearest, and which has been found so far.

use crate::math::Scalar;
use crate::simd::{LANE_COUNT, Lanes, Lists, Mask};
use crate::triangle::QueryPoint;

/// The nearest triangle so far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest<T: Scalar> {
    /// Its squared distance, or else the largest that counts.
    pub(crate) square: T,
    pub(crate) triangle: Option<u32>,
}

impl<T: Scalar> Nearest<T> {
    /// None within the bound yet.
    pub(crate) fn within(query: &QueryPoint<T>, bound: T) -> Self {
        Self { square: query.square_of_bound(bound), triangle: None }
    }

    /// Of equally near triangles the first counts.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn keep_nearer(&mut self, square: T, triangle: u32) {
        let is_before = square < self.square || self.triangle.is_none_or(|known| triangle < known);
        if square <= self.square && is_before {
            (self.square, self.triangle) = (square, Some(triangle));
        }
    }
}

/// Which triangles are sought.
pub(crate) trait Sought: Copy {
    /// Which of sixteen vertices have triangles around them that are not sought.
    fn excluded<T: Scalar, L: Lanes<T>>(self, vertices: &[u32; LANE_COUNT]) -> Mask;

    /// Whether the triangle with these corners is sought.
    fn includes(self, corners: [u32; 3]) -> bool;
}

/// All triangles.
#[derive(Clone, Copy)]
pub(crate) struct All;

impl Sought for All {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn excluded<T: Scalar, L: Lanes<T>>(self, _: &[u32; LANE_COUNT]) -> Mask {
        0
    }

    fn includes(self, _: [u32; 3]) -> bool {
        true
    }
}

/// The triangles without a vertex of one part of the surface.
#[derive(Clone, Copy)]
pub(crate) struct Beyond<'a> {
    /// The part of each vertex.
    pub(crate) parts: &'a [u32],
    pub(crate) part: u32,
}

impl Sought for Beyond<'_> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn excluded<T: Scalar, L: Lanes<T>>(self, vertices: &[u32; LANE_COUNT]) -> Mask {
        L::Lists::equal(&L::Lists::gather_indices(self.parts, vertices), self.part)
    }

    fn includes(self, corners: [u32; 3]) -> bool {
        corners.iter().all(|&vertex| self.parts[vertex as usize] != self.part)
    }
}
