use super::Search;
use super::answer::Answer;
use super::candidates::{Candidates, work_off};
use crate::math::{LANE_COUNT, Lanes, Mask, Scalar};

/// A node that some rays of a packet may meet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Waiting<T> {
    /// The least t at which one of them enters its box.
    pub(super) entry: T,
    pub(super) node: u32,
    pub(super) rays: Mask,
}

/// Each node's box is held against the rays that met its parent's; the nearest goes first, and rays that have met something
/// nearer meanwhile are left out.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn search<T: Scalar, L: Lanes<T>, A: Answer<T>>(
    search: &Search<T, L>,
    list: &mut Candidates<T>,
    answer: &mut A,
) {
    let Search { cells, mesh, slabs, asked, .. } = search;
    list.waiting[0] = Waiting { entry: T::zero(), node: 0, rays: *asked };
    let mut count = 1;
    while count > 0 {
        count -= 1;
        let Waiting { entry, node, rays } = list.waiting[count];
        let end = L::load(answer.end());
        let rays = rays & !answer.settled() & (L::splat(entry).is_at_most(end) | slabs.meet_all);
        if rays == 0 {
            continue;
        }
        let node = &cells.nodes[node as usize];
        let mut met = node.meets::<L>(&search.around);
        if node.is_leaf {
            let (mut tile_count, mut pair_count) = (0, 0);
            while met != 0 {
                let place = met.trailing_zeros() as usize;
                met &= met - 1;
                let (tile, some) = (node.first as usize + place, slabs.meeting(&node.child_box(place), end) & rays);
                if some == 0 || A::EXITS_ONLY && !search.directions.may_leave(cells, tile, mesh, &mut list.room) {
                    continue;
                }
                list.tiles[tile_count] = tile as u32;
                pair_count = L::append(&mut list.pairs, pair_count, (tile_count * LANE_COUNT) as u32, some);
                tile_count += 1;
            }
            work_off(search, list, pair_count, answer);
        } else {
            let first = count;
            while met != 0 {
                let place = met.trailing_zeros() as usize;
                met &= met - 1;
                let (enters, some) = slabs.entering(&node.child_box(place), end);
                let some = some & rays;
                if some == 0 {
                    continue;
                }
                let entry = match some & slabs.meet_all {
                    0 => L::select(some, enters, L::splat(T::INFINITY)).smallest(),
                    _ => T::zero(),
                };
                let mut at = count;
                while at > first && list.waiting[at - 1].entry < entry {
                    list.waiting[at] = list.waiting[at - 1];
                    at -= 1;
                }
                list.waiting[at] = Waiting { entry, node: node.first + place as u32, rays: some };
                count += 1;
            }
        }
    }
}
