use crate::bvh::CHILD_COUNT;
use crate::bvh::rays::packet::Search;
use crate::bvh::rays::packet::answer::Answer;
use crate::bvh::rays::packet::candidates::{Candidates, TILES_AT_ONCE, work_off};
use crate::bvh::rays::trace::STACK_SIZE;
use crate::math::Scalar;
use crate::simd::{LANE_COUNT, Lanes};

/// The box around the packet chooses nodes and tiles, then each tile's box chooses among the rays. Stops, and gives false,
/// where too many tiles are listed: before any hit has been added, since no list that is not the last is shorter.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn search<T: Scalar, L: Lanes<T>, A: Answer<T>>(
    search: &Search<T, L>,
    list: &mut Candidates<T>,
    answer: &mut A,
) -> bool {
    let Search { cells, slabs, .. } = search;
    if list.most_listed == 0 || list.walks[usize::from(A::EXITS_ONLY)] {
        return false;
    }
    let mut stack = [0u32; STACK_SIZE];
    let mut waiting = 1;
    while waiting > 0 {
        let mut tile_count = 0;
        while waiting > 0 && tile_count <= TILES_AT_ONCE - CHILD_COUNT {
            waiting -= 1;
            let index = stack[waiting];
            let mut room = None;
            let node = cells.node(index as usize, &mut room);
            let met = node.meets::<L>(&search.around);
            if node.is_leaf {
                L::append(&mut list.places, tile_count, index * CHILD_COUNT as u32, met);
                tile_count = L::append(&mut list.tiles, tile_count, node.first, met);
            } else {
                waiting = L::append(&mut stack, waiting, node.first, met);
            }
        }
        if waiting > 0 && tile_count > list.most_listed {
            return false;
        }
        let (end, mut pair_count) = (L::load(answer.end()), 0);
        for place in 0..tile_count {
            let (tile, at) = (list.tiles[place] as usize, list.places[place] as usize);
            let aabb = cells.child_box(at / CHILD_COUNT, at % CHILD_COUNT);
            let rays = slabs.meeting(&aabb, end) & search.asked;
            if A::EXITS_ONLY && (rays == 0 || !search.may_count(tile, &mut list.room)) {
                continue;
            }
            pair_count = L::append(&mut list.pairs, pair_count, (place * LANE_COUNT) as u32, rays);
        }
        work_off(search, list, pair_count, 0, 1, answer);
    }
    true
}
