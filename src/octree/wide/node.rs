use crate::math::{Aabb, LANE_COUNT, Lanes, Mask, Scalar, Vector3};

/// At most so many children belong to a node.
pub(super) const CHILD_COUNT: usize = 8;

/// Up to eight children's boxes, axis by axis.
#[derive(Clone, Debug)]
pub(super) struct Node<T: Scalar> {
    /// First the children's lower bounds, then their upper ones negated: so that one comparison asks for both. Places
    /// beyond the last child hold what no box meets.
    pub(super) bounds: [[T; LANE_COUNT]; 3],
    /// The first child; the others follow it.
    pub(super) first: u32,
    pub(super) count: u32,
    /// Whether the children are tiles.
    pub(super) is_leaf: bool,
}

impl<T: Scalar> Node<T> {
    pub(super) fn new(first: u32, count: usize, is_leaf: bool) -> Self {
        Self { bounds: [[T::INFINITY; LANE_COUNT]; 3], first, count: count as u32, is_leaf }
    }

    pub(super) fn set_box(&mut self, place: usize, aabb: &Aabb<T>) {
        for axis in 0..3 {
            self.bounds[axis][place] = aabb.lower[axis];
            self.bounds[axis][place + CHILD_COUNT] = -aabb.upper[axis];
        }
    }

    /// The box of one child.
    pub(super) fn child_box(&self, place: usize) -> Aabb<T> {
        let bounds = &self.bounds;
        let upper = place + CHILD_COUNT;
        Aabb {
            lower: Vector3::new(bounds[0][place], bounds[1][place], bounds[2][place]),
            upper: Vector3::new(-bounds[0][upper], -bounds[1][upper], -bounds[2][upper]),
        }
    }

    /// The box around all children.
    pub(super) fn aabb(&self) -> Aabb<T> {
        let smallest = |bounds: &[T]| bounds.iter().fold(T::INFINITY, |a, &b| if b < a { b } else { a });
        Aabb {
            lower: Vector3::from_fn(|axis, _| smallest(&self.bounds[axis][..CHILD_COUNT])),
            upper: Vector3::from_fn(|axis, _| -smallest(&self.bounds[axis][CHILD_COUNT..])),
        }
    }
}

/// A box to hold against the boxes of nodes.
pub(super) struct BoxQuery<T: Scalar> {
    bounds: [[T; LANE_COUNT]; 3],
}

impl<T: Scalar> BoxQuery<T> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn new(aabb: &Aabb<T>) -> Self {
        let mut bounds = [[T::zero(); LANE_COUNT]; 3];
        for (axis, bounds) in bounds.iter_mut().enumerate() {
            bounds[..CHILD_COUNT].fill(aabb.upper[axis]);
            bounds[CHILD_COUNT..].fill(-aabb.lower[axis]);
        }
        Self { bounds }
    }

    /// Bit i: the box meets that of child i.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn meets<L: Lanes<T>>(&self, node: &Node<T>) -> Mask {
        let x = L::load(&node.bounds[0]).is_at_most(L::load(&self.bounds[0]));
        let y = L::load(&node.bounds[1]).is_at_most(L::load(&self.bounds[1]));
        let z = L::load(&node.bounds[2]).is_at_most(L::load(&self.bounds[2]));
        let met = x & y & z;
        met & met >> CHILD_COUNT & ((1 << CHILD_COUNT) - 1)
    }
}
