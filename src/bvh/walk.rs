//! The one way through the tree: from the root down, at each node to those of its children that count.

use crate::bvh::CHILD_COUNT;
use crate::math::Scalar;
use crate::simd::{Lanes, Mask};

/// 2³² tiles have no more than this many levels of nodes.
const LEVEL_COUNT: usize = 8;

/// What a walk looks for.
pub(crate) trait Visitor<T: Scalar, L: Lanes<T>> {
    /// What is kept of a node's children while they wait.
    type Kept: Copy;

    /// Looks at a node, and says which of its children are to be visited. The tiles of a leaf are looked at here, so it has none.
    fn enter(&mut self, node: u32, kept: &mut Self::Kept) -> Children;

    /// Takes the child to be visited next from those that are left; `None` where no child counts any more.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn next(&mut self, _: &Self::Kept, left: &mut Mask) -> Option<u32> {
        first_of(left)
    }
}

/// The children of a node that are still to be visited.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Children {
    /// The node's first child.
    pub(crate) first: u32,
    /// Bit i: child first + i is to be visited.
    pub(crate) left: Mask,
}

impl Children {
    pub(crate) const NONE: Self = Self { first: 0, left: 0 };
}

/// The nodes on the way from the root to where a walk is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way<K>([(Children, K); LEVEL_COUNT]);

impl<K: Copy> Way<K> {
    /// Room for a walk that keeps something like this.
    pub(crate) fn new(kept: K) -> Self {
        Self([(Children::NONE, kept); LEVEL_COUNT])
    }

    /// Leads a visitor through the tree.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn walk<T: Scalar, L: Lanes<T>>(&mut self, visitor: &mut impl Visitor<T, L, Kept = K>) {
        let (mut depth, mut node) = (0, 0);
        loop {
            let (children, kept) = &mut self.0[depth];
            *children = visitor.enter(node, kept);
            node = loop {
                let (children, kept) = &mut self.0[depth];
                if let Some(place) = visitor.next(kept, &mut children.left) {
                    depth += 1;
                    break children.first + place;
                }
                if depth == 0 {
                    return;
                }
                depth -= 1;
            };
        }
    }
}

/// Takes the first child that is left.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn first_of(left: &mut Mask) -> Option<u32> {
    let place = left.trailing_zeros();
    *left &= left.wrapping_sub(1);
    (place < Mask::BITS).then_some(place)
}

/// Takes the child that is left with the smallest key, of equal ones the first. Few are left at a time: lanes would not pay.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn smallest_of<T: Scalar>(left: &mut Mask, keys: &[T; CHILD_COUNT]) -> Option<u32> {
    let mut others = *left;
    let mut smallest = first_of(&mut others)?;
    if others == 0 {
        *left = 0;
        return Some(smallest);
    }
    let mut least = keys[smallest as usize % CHILD_COUNT];
    while let Some(place) = first_of(&mut others) {
        let key = keys[place as usize % CHILD_COUNT];
        (smallest, least) = if key < least { (place, key) } else { (smallest, least) };
    }
    *left &= !(1 << smallest);
    Some(smallest)
}
