use crate::bvh::node::{CHILD_COUNT, Node};
use crate::bvh::rays::packet::answer::Answer;
use crate::bvh::rays::packet::candidates::{Candidates, resolve, work_off};
use crate::bvh::rays::packet::search::Search;
use crate::bvh::rays::slabs::SingleSlabs;
use crate::bvh::walk::{Children, Visitor, Way, smallest_of};
use crate::math::Scalar;
use crate::simd::{Kernel, LANE_COUNT, Lanes, Lists, Mask, lanes_of};

/// If the rays of a packet meet fewer tiles than this, lists would have been faster: the next packet uses lists again.
const FEWEST_WALKED: u32 = 24;

/// Searches by a walk: each node's box is held against the rays that met its parent's. The nearest node goes first, and rays that
/// have met something nearer meanwhile are left out.
pub(crate) struct Walk<'a, 'b, T: Scalar, L, A> {
    pub(crate) search: &'a Search<'b, T, L>,
    pub(crate) list: &'a mut Candidates<T>,
    pub(crate) answer: &'a mut A,
}

impl<T: Scalar, L: Lanes<T>, A: Answer<T>> Kernel<T> for Walk<'_, '_, T, L, A> {
    type Output = ();

    /// Runs with the lanes of the search.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<Same: Lanes<T>>(self) {
        let Self { search, list, answer } = self;
        let (singles, rays, entry) = (search.slabs.singles(), search.asked, T::zero());
        let mut packet = PacketOnTheWay { search, list, answer, singles, rays, entry, listed: 0, tile_count: 0 };
        let nowhere = RaysOfChildren { rays: [0; CHILD_COUNT], entries: [entry; CHILD_COUNT] };
        Way::new(nowhere).walk(&mut packet);
        let PacketOnTheWay { list, answer, listed, tile_count, .. } = packet;
        resolve::<T, L, A>(search.mesh, search.packet, list, listed, answer);
        list.walks[usize::from(A::EXITS_ONLY)] = tile_count >= FEWEST_WALKED;
    }
}

struct PacketOnTheWay<'a, 'b, T: Scalar, L, A> {
    search: &'a Search<'b, T, L>,
    list: &'a mut Candidates<T>,
    answer: &'a mut A,
    singles: SingleSlabs<T>,
    /// The rays that meet the box of the node that comes next, and the least t at which one of them enters it.
    rays: Mask,
    entry: T,
    /// How many candidates are listed.
    listed: usize,
    /// How many tiles were met.
    tile_count: u32,
}

impl<T: Scalar, L: Lanes<T>, A: Answer<T>> Visitor<T, L> for PacketOnTheWay<'_, '_, T, L, A> {
    type Kept = RaysOfChildren<T>;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter(&mut self, node: u32, children: &mut Self::Kept) -> Children {
        let Self { search, list, answer, .. } = self;
        let is_open = L::splat(self.entry).is_at_most(L::load(answer.end())) | search.slabs.meet_all;
        let rays = self.rays & is_open & !answer.settled();
        if rays == 0 {
            return Children::NONE;
        }
        let mut room = None;
        let node = search.tree.node(node as usize, &mut room);
        let left = children.hold::<L, A>(search, &self.singles, node, rays, *answer);
        if !node.is_leaf {
            return Children { first: node.first, left };
        }
        self.tile_count += left.count_ones();
        let pair_count = list_pairs::<T, L, A>(search, list, node, left, &children.rays);
        self.listed = work_off(search, list, pair_count, self.listed, LANE_COUNT, *answer);
        Children::NONE
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn next(&mut self, children: &Self::Kept, left: &mut Mask) -> Option<u32> {
        let place = smallest_of(left, &children.entries)?;
        let child = place as usize % CHILD_COUNT;
        (self.rays, self.entry) = (children.rays[child], children.entries[child]);
        Some(place)
    }
}

/// Which rays meet a node's children, and where the first of them enters.
#[derive(Clone, Copy)]
struct RaysOfChildren<T> {
    rays: [Mask; CHILD_COUNT],
    /// Of nodes that are no leaves.
    entries: [T; CHILD_COUNT],
}

impl<T: Scalar> RaysOfChildren<T> {
    /// Holds the rays against the boxes of a node's children, and gives which of these are met: one box at a time against all
    /// rays, or one ray against all boxes, whichever are fewer.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn hold<L: Lanes<T>, A: Answer<T>>(
        &mut self,
        search: &Search<T, L>,
        singles: &SingleSlabs<T>,
        node: &Node<T>,
        rays: Mask,
        answer: &A,
    ) -> Mask {
        let near = node.meets::<L>(&search.around);
        let (mut met, endless) = (0, L::splat(T::INFINITY));
        if rays.count_ones() < near.count_ones() {
            let mut met_by = [0; LANE_COUNT];
            let mut entries = endless;
            for ray in lanes_of(rays) {
                let (enters, some) = singles.of(ray).entering::<L>(node, answer.end()[ray]);
                let some = some & near;
                met |= some;
                met_by[ray] = some;
                entries = L::select(some, enters.smaller(entries), entries);
            }
            entries.store(&mut self.entries);
            for child in lanes_of(met) {
                self.rays[child] = L::Lists::holding(&met_by, 1 << child);
            }
            return met;
        }
        let end = L::load(answer.end());
        for child in lanes_of(near) {
            let (enters, some) = search.slabs.entering(&node.child_box(child), end);
            self.rays[child] = some & rays;
            met |= Mask::from(self.rays[child] != 0) << child;
            if !node.is_leaf {
                self.entries[child] = L::select(self.rays[child], enters, endless).smallest();
            }
        }
        met
    }
}

/// Lists each of these tiles with the rays that meet its box. Where only exits count, tiles through which no ray can leave are
/// left out.
#[cfg_attr(not(debug_assertions), inline(always))]
fn list_pairs<T: Scalar, L: Lanes<T>, A: Answer<T>>(
    search: &Search<T, L>,
    list: &mut Candidates<T>,
    node: &Node<T>,
    tiles: Mask,
    rays: &[Mask; CHILD_COUNT],
) -> usize {
    let (mut tile_count, mut pair_count) = (0, 0);
    for child in lanes_of(tiles) {
        let tile = node.first as usize + child;
        if A::EXITS_ONLY && !search.may_count(tile, &mut list.room) {
            continue;
        }
        list.tiles[tile_count] = tile as u32;
        pair_count = L::Lists::append(&mut list.pairs, pair_count, (tile_count * LANE_COUNT) as u32, rays[child]);
        tile_count += 1;
    }
    pair_count
}
