//! The certificate that a body touches itself nowhere: pairs of near tiles, each with a clearance, by how much its triangles may
//! come nearer. It holds while no pair has lapsed, that is, moved by more than its clearance or been strained too much.

pub(crate) mod block;
pub(crate) mod descent;
pub(crate) mod narrow;
pub(crate) mod reach;
pub(crate) mod steep;
pub(crate) mod strain;
#[cfg(test)]
pub(crate) mod tests;

use crate::bvh::{Bvh, TILE_SIZE};
use crate::math::{Aabb, Scalar, Vector3, length};
use crate::memory::{self, Room};
use crate::mesh::Mesh;
use crate::query::{Octree, Tree};
use crate::self_contact::certificate::block::{Block, are_apart};
use crate::self_contact::certificate::descent::Descent;
use crate::self_contact::certificate::narrow::Narrow;
use crate::self_contact::certificate::reach::{Lapse, Reach};
use crate::self_contact::certificate::steep::{FindSteep, MakeNormals, Normals};
use crate::self_contact::certificate::strain::{FindMoves, MakeRest, Rest};
use crate::self_contact::near_triangles::sweep;
use crate::simd::{Kernel, Lanes, Mask, Vectors, dispatch, lanes_of};

/// The tiles that are near each other, and what the search for them needs; kept by the caller, so that a steady step
/// allocates nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct NearTiles<T: Scalar> {
    tile_pairs: Vec<[u32; 2]>,
    /// How much nearer the triangles of each pair may come.
    clearances: Vec<T>,
    /// A pair with a larger clearance does not rely on little strain.
    sheltered: T,
    /// A tile that a path between sheltered triangles leads over has a pair of at most this clearance with the tiles at its ends.
    surrounding: T,
    blocks: Vec<Block>,
    normals: Vec<Normals>,
    /// By tile the steep triangles, by the nearer surroundings and by the wider ones.
    steep: Vec<Mask>,
    steep_wide: Vec<Mask>,
    rest: Rest<T>,
    /// By tile the box around its vertices' moves.
    moves: Vec<Aabb<T>>,
    /// The tiles with triangles that are strained by more than they may be, and which triangles these are.
    strained: Vec<(u32, Mask)>,
    /// By tile; only where any are strained.
    surroundings: Vec<Surroundings>,
    /// The pairs that have lapsed.
    lapsed: Vec<[u32; 2]>,
    /// The tiles of these pairs, and by tile its place among them or [`NO_BLOCK`].
    lapsed_tiles: Vec<u32>,
    block_places: Vec<u32>,
    /// For the layout without tiles: the triangles' boxes in the order of their lower sides along one axis.
    sorted: Vec<(Aabb<T>, u32)>,
}

/// Whether anything is strained in a tile, and in the tiles near it.
#[derive(Clone, Copy, Debug, Default)]
struct Surroundings {
    is_strained: bool,
    is_near_strained: bool,
}

/// If more than this part of the tiles are strained, all has lapsed.
const MOST_STRAINED: f64 = 1.0 / 16.0;

/// Of a tile in no pair that has lapsed.
const NO_BLOCK: u32 = u32::MAX;

impl<T: Scalar> Octree<T> {
    /// Offers each two triangles that have no vertex in common and are near each other, and perhaps others, and whether both
    /// are steep. `offer` gives how much nearer they may come, or `None` to end the search. Triangles of which two corners
    /// are one point are left out: no ray meets them. Gives false where `offer` ended the search or there were too many pairs.
    ///
    /// A triangle is steep if a triangle near it faces more than 60° away from it. With a margin, two triangles that are not both
    /// steep are *sheltered*: they are offered only where they nearly touch. The surface around them is a graph of slopes below
    /// 60° over a plane, so a path leads from one to the other that is at most twice as long as they are apart. They come no
    /// nearer than a quarter of their distance while no triangle on the path is strained by more than three eighths, and
    /// [`find_lapsed`](Self::find_lapsed) holds triangles to less.
    pub(crate) fn search_near(
        &self,
        mesh: &Mesh<T>,
        reach: &Reach<T>,
        near: &mut NearTiles<T>,
        mut offer: impl FnMut(u32, u32, bool) -> Option<T>,
    ) -> bool {
        let Tree::Bvh(tree) = &self.tree else {
            return sweep(mesh, reach.touch, &mut near.sorted, |a, b| offer(a, b, true).is_some());
        };
        let Reach { touch, margin, most_pairs, .. } = *reach;
        near.sheltered = reach.wide_margin();
        near.surrounding = reach.of_surroundings()[1] - touch;
        let NearTiles { blocks, tile_pairs, clearances, normals, steep, steep_wide, .. } = near;
        let narrow = Narrow::new(mesh);
        let tiles = 0..tree.tile_count();
        dispatch::<T, _>(MakeBlocks { tree, tiles, mesh, is_current: true, narrow, blocks });
        tile_pairs.clear();
        let distance = reach.of_tiles();
        Descent { tree, distance, tile_pairs, most_pairs }.within_all();
        clearances.clear();
        if tile_pairs.len() > most_pairs {
            tile_pairs.clear();
            return false;
        }
        steep.clear();
        if margin > T::zero() {
            dispatch::<T, _>(MakeNormals { tree, mesh, narrow, normals });
            let [distance, wide] = reach.of_surroundings().map(|distance| narrow.distance(distance));
            let (tree, among, found) = (tree, None, &mut *steep_wide);
            dispatch::<f32, _>(FindSteep { tree, blocks, normals, tile_pairs, distance: wide, among, steep: found });
            let among = Some(&**steep_wide);
            dispatch::<f32, _>(FindSteep { tree, blocks, normals, tile_pairs, distance, among, steep });
        }
        let clearance = |pair: &[u32; 2]| {
            if margin == T::zero() {
                return margin;
            }
            let [a, b] = pair.map(|tile| &tree.outlines[tile as usize].aabb);
            let gap = (a.lower - b.upper).sup(&(b.lower - a.upper)).sup(&Vector3::zeros());
            let is_sheltered = pair.iter().any(|&tile| steep_wide[tile as usize] == 0);
            (length(&gap) - touch).max(if is_sheltered { reach.wide_margin() } else { margin })
        };
        memory::append(clearances, tile_pairs.iter().map(clearance));
        let [close, far] = [reach.of_sheltered(), touch + margin].map(|distance| narrow.distance(distance));
        let block_of = |tile: u32| tile as usize;
        let offer = |place: usize, a: u32, b: u32, is_steep: bool| {
            let clearance = offer(a, b, is_steep);
            if let Some(clearance) = clearance
                && (is_steep || clearance < reach.of_sheltered() - touch)
            {
                clearances[place] = clearances[place].min(clearance);
            }
            clearance.is_some()
        };
        dispatch::<f32, _>(TilePairs { tree, blocks, block_of, tile_pairs, close, far, steep, offer })
    }

    /// Keeps the positions of a search. `allowed`: by vertex how far the triangles around it may be strained.
    pub(crate) fn keep(&self, mesh: &Mesh<T>, allowed: &[T], near: &mut NearTiles<T>) {
        if let Tree::Bvh(tree) = &self.tree {
            dispatch::<T, _>(MakeRest { tree, mesh, allowed, rest: &mut near.rest });
        }
    }

    /// Finds the pairs of tiles listed by [`search_near`](Self::search_near) that have *lapsed*: that have come nearer by more
    /// than they may since positions were kept, or lie where triangles are strained by more than they may be. Finds none, and
    /// says that all have lapsed, where vertices have moved against each other by more than `most`. A turn of the whole does not
    /// count. The octree need not follow the mesh.
    pub(crate) fn find_lapsed(&self, mesh: &Mesh<T>, most: T, near: &mut NearTiles<T>) -> Lapse<T> {
        let Tree::Bvh(tree) = &self.tree else { return Lapse::unknown() };
        let NearTiles { rest, moves, strained, surroundings, lapsed, tile_pairs, clearances, .. } = near;
        let (sheltered, surrounding) = (near.sheltered, near.surrounding);
        lapsed.clear();
        rest.follow_turn(&tree.outlines, mesh);
        let whole = dispatch::<T, _>(FindMoves { tree, mesh, rest, moves, strained });
        let spread = length(&(whole.upper - whole.lower));
        // Written so that NaN is too much.
        let is_little = spread <= most;
        if !is_little || strained.len() as f64 > tree.tiles.len() as f64 * MOST_STRAINED {
            return Lapse { spread, part: 1.0 };
        }
        let is_any_strained = !strained.is_empty();
        if is_any_strained {
            memory::refill_with(surroundings, Surroundings::default(), tree.tiles.len());
            strained.iter().for_each(|&(tile, _)| surroundings[tile as usize].is_strained = true);
            for (&[first, second], &clearance) in tile_pairs.iter().zip(clearances.iter()) {
                let [first, second] = [first as usize, second as usize];
                // Without branches: which pairs are near is hard to foretell.
                let is_near = clearance <= surrounding;
                surroundings[first].is_near_strained |= is_near & surroundings[second].is_strained;
                surroundings[second].is_near_strained |= is_near & surroundings[first].is_strained;
            }
        }
        let has_moved = |first: u32, second: u32, clearance: T| {
            let (a, b) = (&moves[first as usize], &moves[second as usize]);
            // The largest difference of two moves, one in each box.
            let farthest = (a.upper - b.lower).sup(&(b.upper - a.lower));
            farthest.norm_squared() > clearance * clearance
        };
        // A path between two triangles that leads over a strained one is near it from end to end.
        let is_strained = |first: u32, second: u32, clearance: T| {
            let is_near = |tile: u32| surroundings[tile as usize].is_near_strained;
            clearance <= sheltered && is_near(first) && is_near(second)
        };
        let has_lapsed = |&(&[first, second], &clearance): &(&[u32; 2], &T)| {
            clearance <= spread && has_moved(first, second, clearance)
                || is_any_strained && is_strained(first, second, clearance)
        };
        let pairs = tile_pairs.iter().zip(clearances.iter());
        memory::append(lapsed, pairs.filter(has_lapsed).map(|(pair, _)| *pair));
        Lapse { spread, part: lapsed.len() as f64 / tile_pairs.len() as f64 }
    }

    /// The triangles that [`find_lapsed`](Self::find_lapsed) found strained by more than they may be: they may touch others
    /// around a common vertex.
    pub(crate) fn strained<'a>(&'a self, near: &'a NearTiles<T>) -> impl Iterator<Item = u32> + 'a {
        let tree = if let Tree::Bvh(tree) = &self.tree { Some(tree) } else { None };
        let strained = tree.into_iter().flat_map(|tree| near.strained.iter().map(move |of_tile| (tree, of_tile)));
        strained.flat_map(|(tree, &(tile, mask))| {
            let triangles = &tree.tiles[tile as usize].triangles;
            lanes_of(mask).map(|place| triangles[place])
        })
    }

    /// Offers, from the pairs that [`find_lapsed`](Self::find_lapsed) has found, each two triangles that have no vertex in common
    /// and whose boxes are at most `distance` apart along every axis, until `offer` gives false. The octree need not follow the
    /// mesh.
    pub(crate) fn search_lapsed(
        &self,
        mesh: &Mesh<T>,
        distance: T,
        near: &mut NearTiles<T>,
        mut offer: impl FnMut(u32, u32) -> bool,
    ) {
        let Tree::Bvh(tree) = &self.tree else { return };
        let NearTiles { blocks, lapsed, lapsed_tiles, block_places, .. } = near;
        lapsed_tiles.clear();
        memory::refill_with(block_places, NO_BLOCK, tree.tiles.len());
        lapsed_tiles.room_for(tree.tiles.len());
        for &tile in lapsed.as_flattened() {
            let place = &mut block_places[tile as usize];
            if *place == NO_BLOCK {
                *place = lapsed_tiles.len() as u32;
                lapsed_tiles.push(tile);
            }
        }
        let narrow = Narrow::new(mesh);
        let tiles = lapsed_tiles.iter().copied();
        dispatch::<T, _>(MakeBlocks { tree, tiles, mesh, is_current: self.stamp == mesh.stamp(), narrow, blocks });
        let block_of = |tile: u32| block_places[tile as usize] as usize;
        let close = narrow.distance(distance);
        let offer = |_: usize, a: u32, b: u32, _: bool| offer(a, b);
        let (tile_pairs, steep) = (&*lapsed, &[]);
        dispatch::<f32, _>(TilePairs { tree, blocks, block_of, tile_pairs, close, far: close, steep, offer });
    }
}

/// Makes the blocks of tiles, in place of what was there.
struct MakeBlocks<'a, T: Scalar, I> {
    tree: &'a Bvh<T>,
    tiles: I,
    mesh: &'a Mesh<T>,
    /// Whether the tiles follow the mesh.
    is_current: bool,
    narrow: Narrow<T>,
    blocks: &'a mut Vec<Block>,
}

impl<T: Scalar, I: Iterator<Item = u32>> Kernel<T> for MakeBlocks<'_, T, I> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let mut count = 0;
        for tile in self.tiles {
            if self.blocks.len() == count {
                self.blocks.room_for(1).push(Block::EMPTY);
            }
            let positions = if self.is_current {
                let mut room = [[T::zero(); TILE_SIZE]; 3];
                Vectors::load(self.tree.positions_of::<L>(tile as usize, self.mesh, &mut room))
            } else {
                self.mesh.gather(&self.tree.outlines[tile as usize].vertices)
            };
            self.blocks[count].fill::<T, L>(self.tree, tile as usize, positions, &self.narrow);
            count += 1;
        }
        self.blocks.truncate(count);
    }
}

/// Offers the near triangles of pairs of tiles.
struct TilePairs<'a, T: Scalar, B, O> {
    tree: &'a Bvh<T>,
    blocks: &'a [Block],
    /// Where a tile's block is.
    block_of: B,
    tile_pairs: &'a [[u32; 2]],
    /// Triangles are offered that are at most this far apart.
    close: f32,
    /// The same for two steep triangles.
    far: f32,
    /// By tile; empty where none is.
    steep: &'a [Mask],
    /// Gets the place of the pair, two triangles and whether both are steep; gives whether to go on.
    offer: O,
}

impl<T: Scalar, B: Fn(u32) -> usize, O: FnMut(usize, u32, u32, bool) -> bool> Kernel<f32> for TilePairs<'_, T, B, O> {
    /// Whether it came to the end.
    type Output = bool;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<f32>>(mut self) -> bool {
        for (pair, &[first, second]) in self.tile_pairs.iter().enumerate() {
            let mut a = &self.blocks[(self.block_of)(first)];
            let mut b = &self.blocks[(self.block_of)(second)];
            let (mut a_tile, mut b_tile) = (&self.tree.tiles[first as usize], &self.tree.tiles[second as usize]);
            let (mut a_steep, mut b_steep) = match self.steep {
                [] => (0, 0),
                steep => (steep[first as usize], steep[second as usize]),
            };
            if a_steep == 0 || b_steep == 0 {
                (a_steep, b_steep) = (0, 0);
            }
            if are_apart(&a.whole, &b.whole, if a_steep == 0 { self.close } else { self.far }) {
                continue;
            }
            let is_same = first == second;
            let mut candidates = a_tile.present;
            if !is_same {
                candidates = a.near::<L>(&b.whole, self.close);
                let mut others = b.near::<L>(&a.whole, self.close);
                if a_steep != 0 {
                    candidates |= a_steep & a.near::<L>(&b.whole, self.far);
                    others |= b_steep & b.near::<L>(&a.whole, self.far);
                }
                // The fewer candidates are held against all of the other tile.
                if others.count_ones() < candidates.count_ones() {
                    (a, b, a_tile, b_tile, candidates) = (b, a, b_tile, a_tile, others);
                    (a_steep, b_steep) = (b_steep, a_steep);
                }
            }
            for place in lanes_of(candidates) {
                let steep = if a_steep >> place & 1 == 0 { 0 } else { b_steep };
                let mut others = b.near::<L>(&a.sides_of(place), self.close);
                if steep != 0 {
                    others |= steep & b.near::<L>(&a.sides_of(place), self.far);
                }
                // Within one tile each pair comes once.
                others &= if is_same { !1 << place } else { !0 };
                if others != 0 {
                    others &= !b.sharing::<L>(a.vertices_of(place));
                }
                for other in lanes_of(others) {
                    let is_steep = steep >> other & 1 != 0;
                    if !(self.offer)(pair, a_tile.triangles[place], b_tile.triangles[other], is_steep) {
                        return false;
                    }
                }
            }
        }
        true
    }
}
