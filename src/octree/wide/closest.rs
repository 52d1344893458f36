// Lanes side by side read best, and are best made into SIMD, as plain loops over their index.
#![allow(clippy::needless_range_loop)]

use super::trace::LEVEL_COUNT;
use super::{CHILD_COUNT, Node, Tile, Wide};
use crate::closest::{NearTriangles, PointPacket, QueryPoint};
use crate::math::{Kernel, LANE_COUNT, Lanes, Mask, Scalar, Vectors};
use crate::mesh::Mesh;
use crate::octree::closest::{Nearest, Sought};

/// Who looks for what is near.
trait Seeker<T: Scalar> {
    /// The squared distance to boxes beyond which nothing counts.
    fn limit(&self) -> T;

    /// Looks at a tile, a child of a node.
    fn look<L: Lanes<T>>(&mut self, cells: &Wide<T>, mesh: &Mesh<T>, node: &Node<T>, place: usize);
}

/// The children of a node on the way down that are still to be visited.
#[derive(Clone, Copy)]
struct Level<T> {
    squares: [T; CHILD_COUNT],
    left: Mask,
    node: u32,
}

/// Visits the tiles near a point, the nearest child first at each node.
#[cfg_attr(not(debug_assertions), inline(always))]
fn walk<T: Scalar, L: Lanes<T>, S: Seeker<T>>(cells: &Wide<T>, mesh: &Mesh<T>, centre: &QueryPoint<T>, seeker: &mut S) {
    let mut levels = [Level { squares: [T::zero(); CHILD_COUNT], left: 0, node: 0 }; LEVEL_COUNT];
    levels[0].enter::<L>(cells, 0, centre);
    let mut depth = 0;
    loop {
        let level = &mut levels[depth];
        let squares = L::load(&level.squares);
        level.left &= squares.is_at_most(L::splat(seeker.limit()));
        if level.left == 0 {
            if depth == 0 {
                return;
            }
            depth -= 1;
            continue;
        }
        let squares = L::select(level.left, squares, L::splat(T::INFINITY));
        let nearest = squares.is_at_most(L::splat(squares.smallest())) & level.left;
        level.left &= !(nearest & nearest.wrapping_neg());
        let mut room = None;
        let node = cells.node(level.node as usize, &mut room);
        let place = nearest.trailing_zeros() as usize;
        if node.is_leaf {
            seeker.look::<L>(cells, mesh, node, place);
        } else {
            let child = node.first + place as u32;
            depth += 1;
            levels[depth].enter::<L>(cells, child, centre);
        }
    }
}

impl<T: Scalar> Level<T> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter<L: Lanes<T>>(&mut self, cells: &Wide<T>, node: u32, centre: &QueryPoint<T>) {
        self.node = node;
        let mut room = None;
        let node = cells.node(node as usize, &mut room);
        let factor = L::splat(centre.factor);
        let factor = Vectors::<T, L>::new(factor, factor, factor);
        let centre = Vectors::splat(&centre.position);
        // Scaling is exact, so that it makes no difference whether it is rounded by itself.
        let below = Vectors::load(&node.lower).times_add(factor, centre.negate());
        let above = Vectors::load(&node.upper).negate().times_add(factor, centre);
        let apart = below.larger(above).larger(Vectors::zeros());
        apart.dot(apart).store(&mut self.squares);
        self.left = ((1u32 << node.count) - 1) as Mask;
    }
}

/// The search for the triangle nearest to one point.
pub(super) struct Closest<'a, T: Scalar, S> {
    pub(super) cells: &'a Wide<T>,
    pub(super) mesh: &'a Mesh<T>,
    pub(super) query: &'a QueryPoint<T>,
    pub(super) nearest: &'a mut Nearest<T>,
    pub(super) sought: S,
}

impl<T: Scalar, S: Sought> Kernel<T> for Closest<'_, T, S> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let limit = self.query.square_of_boxes(self.nearest.square);
        let cylinder_limit = self.query.square_of_cylinders(self.nearest.square);
        let mut one = One { query: self.query, nearest: self.nearest, limit, cylinder_limit, sought: self.sought };
        walk::<T, L, _>(self.cells, self.mesh, self.query, &mut one);
    }
}

/// One point.
struct One<'a, T: Scalar, S> {
    query: &'a QueryPoint<T>,
    nearest: &'a mut Nearest<T>,
    limit: T,
    cylinder_limit: T,
    sought: S,
}

impl<T: Scalar, S: Sought> Seeker<T> for One<'_, T, S> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn limit(&self) -> T {
        self.limit
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn look<L: Lanes<T>>(&mut self, cells: &Wide<T>, mesh: &Mesh<T>, node: &Node<T>, place: usize) {
        let index = node.first as usize + place;
        if cells.is_loaded(index) && !cells.cylinders[index].is_near(self.query, self.cylinder_limit) {
            return;
        }
        let sought = cells.sought::<L, S>(self.sought, index);
        if sought == 0 {
            return;
        }
        let mut room = [[T::zero(); LANE_COUNT]; 3];
        let positions = cells.positions_of::<L>(index, mesh, &mut room);
        let triangles = NearTriangles::<T, L>::new(positions, &cells.ascending[index], self.query.factor);
        let squares = triangles.squares(&self.query.position);
        if keep_nearest::<T, L>(cells, index, sought, squares, self.nearest) {
            self.limit = self.query.square_of_boxes(self.nearest.square);
            self.cylinder_limit = self.query.square_of_cylinders(self.nearest.square);
        }
    }
}

/// Points are neighbours if they are at most this many widths of a tile away from their middle. The mesh has a size of about 1.
const MOST_SPREAD: f64 = 64.0;

/// The search for the triangles nearest to a packet's points.
pub(super) struct ClosestOfPacket<'a, T: Scalar, S> {
    pub(super) cells: &'a Wide<T>,
    pub(super) mesh: &'a Mesh<T>,
    pub(super) packet: &'a mut PointPacket<T>,
    pub(super) sought: S,
}

impl<T: Scalar, S: Sought> Kernel<T> for ClosestOfPacket<'_, T, S> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let Self { cells, mesh, packet, sought } = self;
        let centre = packet.centre;
        if packet.spread::<L>() * T::of(cells.tiles.len() as f64).sqrt() <= T::of(MOST_SPREAD) {
            walk::<T, L, _>(cells, mesh, &centre, &mut Many { packet, sought });
        } else {
            packet.centre_limit = -T::one();
        }
        if packet.centre_limit < T::zero() {
            let present = packet.present;
            for lane in (0..LANE_COUNT).filter(|lane| present >> lane & 1 == 1) {
                let (query, mut nearest) = (packet.query(lane), nearest_of(packet, lane));
                L::outlined(Closest { cells, mesh, query: &query, nearest: &mut nearest, sought });
                keep(packet, lane, &nearest);
            }
        }
    }
}

/// What is known of one of the points.
#[cfg_attr(not(debug_assertions), inline(always))]
fn nearest_of<T: Scalar>(packet: &PointPacket<T>, lane: usize) -> Nearest<T> {
    let known = (packet.found >> lane & 1 == 1).then_some(packet.triangle[lane]);
    Nearest { square: packet.square[lane], triangle: known }
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn keep<T: Scalar>(packet: &mut PointPacket<T>, lane: usize, nearest: &Nearest<T>) {
    if let Some(triangle) = nearest.triangle {
        (packet.square[lane], packet.triangle[lane]) = (nearest.square, triangle);
        packet.found |= 1 << lane;
    }
}

/// The points of a packet.
struct Many<'a, T: Scalar, S> {
    packet: &'a mut PointPacket<T>,
    sought: S,
}

impl<T: Scalar, S: Sought> Seeker<T> for Many<'_, T, S> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn limit(&self) -> T {
        self.packet.centre_limit
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn look<L: Lanes<T>>(&mut self, cells: &Wide<T>, mesh: &Mesh<T>, node: &Node<T>, place: usize) {
        let packet = &mut *self.packet;
        let mut near = packet.near::<L>(&node.child_box(place));
        let index = node.first as usize + place;
        let count = near.count_ones();
        if near != 0 && cells.is_loaded(index) {
            near &= cells.cylinders[index].near::<L>(packet);
        }
        if near == 0 {
            return packet.count_looks(count);
        }
        let sought = cells.sought::<L, S>(self.sought, index);
        if sought == 0 {
            return packet.count_looks(count);
        }
        let mut room = [[T::zero(); LANE_COUNT]; 3];
        let positions = cells.positions_of::<L>(index, mesh, &mut room);
        let triangles = NearTriangles::<T, L>::new(positions, &cells.ascending[index], packet.centre.factor);
        let mut is_nearer = false;
        while near != 0 {
            let lane = near.trailing_zeros() as usize;
            near &= near - 1;
            let squares = triangles.squares(&packet.point(lane));
            let mut nearest = nearest_of(packet, lane);
            if keep_nearest::<T, L>(cells, index, sought, squares, &mut nearest) {
                keep(packet, lane, &nearest);
                is_nearer = true;
            }
        }
        if is_nearer {
            packet.renew_limits::<L>();
        }
        packet.count_looks(count);
    }
}

impl<T: Scalar> Wide<T> {
    /// Which of a tile's triangles are sought.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sought<L: Lanes<T>, S: Sought>(&self, sought: S, tile: usize) -> Mask {
        let Tile { present, vertex_sets, .. } = &self.tiles[tile];
        let excluded = sought.excluded::<T, L>(&self.outlines[tile].vertices);
        let mut own = 0;
        if excluded != 0 {
            for place in 0..LANE_COUNT {
                own |= Mask::from(vertex_sets[place] & excluded != 0) << place;
            }
        }
        present & !own
    }
}

/// Keeps the nearest of a tile's triangles that are sought, if it is nearer than what is known; gives whether it is.
#[cfg_attr(not(debug_assertions), inline(always))]
fn keep_nearest<T: Scalar, L: Lanes<T>>(
    cells: &Wide<T>,
    index: usize,
    sought: Mask,
    squares: L,
    nearest: &mut Nearest<T>,
) -> bool {
    let tile = &cells.tiles[index];
    let squares = L::select(sought, squares, L::splat(T::INFINITY));
    let smallest = squares.smallest();
    if smallest > nearest.square {
        return false;
    }
    let mut of_these = squares.is_at_most(L::splat(smallest)) & sought;
    while of_these != 0 {
        nearest.keep_nearer(smallest, tile.triangles[of_these.trailing_zeros() as usize]);
        of_these &= of_these - 1;
    }
    true
}
