use crate::bvh::CHILD_COUNT;
use crate::bvh::rays::packet::answer::Answer;
use crate::bvh::rays::packet::candidates::{Candidates, work_off};
use crate::bvh::rays::packet::search::Search;
use crate::bvh::walk::{Children, Visitor, Way, first_of};
use crate::math::Scalar;
use crate::simd::{LANE_COUNT, Lanes, Lists, Mask};

/// Searches by lists: the box around the packet chooses nodes and tiles, then each tile's box chooses among the rays. Does
/// nothing, and gives false, where too many tiles are listed.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn search<T: Scalar, L: Lanes<T>, A: Answer<T>>(
    search: &Search<T, L>,
    list: &mut Candidates<T>,
    answer: &mut A,
) -> bool {
    if list.most_listed == 0 || list.walks[usize::from(A::EXITS_ONLY)] {
        return false;
    }
    let mut listing = Listing { search, list, count: 0 };
    Way::new(()).walk(&mut listing);
    let count = listing.count;
    if count > list.most_listed {
        return false;
    }
    let (end, mut pair_count) = (L::load(answer.end()), 0);
    for place in 0..count {
        let (tile, at) = (list.tiles[place] as usize, list.places[place] as usize);
        let aabb = search.tree.child_box(at / CHILD_COUNT, at % CHILD_COUNT);
        let rays = search.slabs.meeting(&aabb, end) & search.asked;
        if A::EXITS_ONLY && (rays == 0 || !search.may_count(tile, &mut list.room)) {
            continue;
        }
        pair_count = L::Lists::append(&mut list.pairs, pair_count, (place * LANE_COUNT) as u32, rays);
    }
    work_off(search, list, pair_count, 0, 1, answer);
    true
}

/// Lists the tiles that the box around the packet meets, until there are too many.
struct Listing<'a, 'b, T: Scalar, L> {
    search: &'a Search<'b, T, L>,
    list: &'a mut Candidates<T>,
    count: usize,
}

impl<T: Scalar, L: Lanes<T>> Visitor<T, L> for Listing<'_, '_, T, L> {
    type Kept = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter(&mut self, index: u32, (): &mut ()) -> Children {
        let mut room = None;
        let node = self.search.tree.node(index as usize, &mut room);
        let left = node.meets(&self.search.around);
        if !node.is_leaf {
            return Children { first: node.first, left };
        }
        L::Lists::append(&mut self.list.places, self.count, index * CHILD_COUNT as u32, left);
        self.count = L::Lists::append(&mut self.list.tiles, self.count, node.first, left);
        Children::NONE
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn next(&mut self, (): &(), left: &mut Mask) -> Option<u32> {
        if self.count > self.list.most_listed { None } else { first_of(left) }
    }
}
