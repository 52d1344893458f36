use crate::math::{Aabb, Scalar};
use crate::simd::{LANE_COUNT, Lanes, Mask, Vectors, set_lane, vector_in_lane};
use std::ops::Range;

/// A node has at most this many children.
pub(crate) const CHILD_COUNT: usize = LANE_COUNT;

/// Up to sixteen children's boxes, axis by axis; places beyond the last child hold boxes that nothing meets.
#[derive(Clone, Debug)]
// Whole rows of sixteen lie on lines of the cache.
#[repr(C, align(64))]
pub(crate) struct Node<T: Scalar> {
    pub(crate) lower: [[T; CHILD_COUNT]; 3],
    pub(crate) upper: [[T; CHILD_COUNT]; 3],
    /// The first child; the others follow it.
    pub(crate) first: u32,
    pub(crate) count: u32,
    /// Whether the children are tiles.
    pub(crate) is_leaf: bool,
    /// Whether the tiles' own boxes are not known, and the boxes here are wider.
    pub(crate) is_far: bool,
    /// Whether the boxes are those at the present positions; in a mesh that is moved by a pose, only some nodes are placed.
    pub(crate) is_placed: bool,
}

impl<T: Scalar> Node<T> {
    pub(crate) fn new(first: u32, count: usize, is_leaf: bool) -> Self {
        let (lower, upper) = ([[T::INFINITY; CHILD_COUNT]; 3], [[-T::INFINITY; CHILD_COUNT]; 3]);
        Self { lower, upper, first, count: count as u32, is_leaf, is_far: false, is_placed: true }
    }

    /// Which children are there.
    pub(crate) fn present(&self) -> Mask {
        ((1u32 << self.count) - 1) as Mask
    }

    /// The tiles under a leaf.
    pub(crate) fn tiles(&self) -> Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }

    pub(crate) fn set_box(&mut self, place: usize, aabb: &Aabb<T>) {
        set_lane(&mut self.lower, place, &aabb.lower);
        set_lane(&mut self.upper, place, &aabb.upper);
    }

    /// The box of one child.
    pub(crate) fn child_box(&self, place: usize) -> Aabb<T> {
        Aabb { lower: vector_in_lane(&self.lower, place), upper: vector_in_lane(&self.upper, place) }
    }

    /// The box around all children, without lanes.
    pub(crate) fn around_children(&self) -> Aabb<T> {
        let boxes = (0..self.count as usize).map(|place| self.child_box(place));
        boxes.fold(Aabb::empty(), |around, child| around.union(&child))
    }

    /// The lower and the upper corners of all children.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn corners<L: Lanes<T>>(&self) -> [Vectors<T, L>; 2] {
        [Vectors::load(&self.lower), Vectors::load(&self.upper)]
    }

    /// The box around all children.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn aabb<L: Lanes<T>>(&self) -> Aabb<T> {
        Aabb {
            lower: Vectors::<T, L>::load(&self.lower).smallest_lanes(),
            upper: Vectors::<T, L>::load(&self.upper).greatest_lanes(),
        }
    }

    /// Which children's boxes meet the box.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn meets<L: Lanes<T>>(&self, aabb: &BoxLanes<T, L>) -> Mask {
        Vectors::load(&self.lower).are_at_most(aabb.upper) & aabb.lower.are_at_most(Vectors::load(&self.upper))
    }
}

/// A box to hold against the boxes of nodes.
pub(crate) struct BoxLanes<T, L> {
    lower: Vectors<T, L>,
    upper: Vectors<T, L>,
}

impl<T: Scalar, L: Lanes<T>> BoxLanes<T, L> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn new(aabb: &Aabb<T>) -> Self {
        Self { lower: Vectors::splat(&aabb.lower), upper: Vectors::splat(&aabb.upper) }
    }
}
