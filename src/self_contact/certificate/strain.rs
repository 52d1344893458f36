//! How tiles have moved and been strained since a search, apart from the turn of the body as a whole.

use crate::bvh::{Bvh, Outline, TILE_SIZE};
use crate::math::{Aabb, Scalar, Vector3};
use crate::memory::{self, Room};
use crate::mesh::Mesh;
use crate::simd::{Kernel, Lanes, Mask, Vectors};
use nalgebra::{Matrix3, UnitQuaternion};

/// A body at the positions of a search, tile by tile.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rest<T: Scalar> {
    tiles: Vec<RestTile<T>>,
    /// The point that the tiles' positions are relative to.
    centre: Vector3<T>,
    /// The rotation that turns the present positions back.
    back: UnitQuaternion<T>,
}

#[derive(Clone, Debug)]
struct RestTile<T: Scalar> {
    positions: [[T; TILE_SIZE]; 3],
    /// The factors of the moves of a triangle's two edges in its strain, as a part of the strain that it is allowed.
    factors: [[T; TILE_SIZE]; 3],
}

/// A smaller turn, in radians, is not turned back; it counts as strain.
const LEAST_TURN: f64 = 1e-3;
/// About this many vertices tell how a body has turned.
const VERTICES_OF_TURN: usize = 64;

impl<T: Scalar> Rest<T> {
    /// Finds the turn that fits some vertices best. With another turn the bounds would hold too, only less tightly.
    pub(crate) fn follow_turn(&mut self, outlines: &[Outline<T>], mesh: &Mesh<T>) {
        let stride = outlines.len().div_ceil(VERTICES_OF_TURN);
        let samples = || {
            let tiles = self.tiles.iter().zip(outlines).step_by(stride);
            tiles.map(|(tile, outline)| {
                let [x, y, z] = tile.positions.each_ref().map(|row| row[0]);
                (Vector3::new(x, y, z), mesh.position(outline.vertices[0]))
            })
        };
        let count = T::of(samples().count() as f64);
        let add = |(a, b): (Vector3<T>, Vector3<T>), (c, d)| (a + c, b + d);
        let (then_sum, now_sum) = samples().fold((Vector3::zeros(), Vector3::zeros()), add);
        let (mut spread, mut turned) = (Matrix3::zeros(), Matrix3::zeros());
        for (then, now) in samples() {
            let (then, now) = (then - then_sum / count, now - now_sum / count);
            spread += then * then.transpose();
            turned += now * then.transpose();
        }
        let Some(inverse) = (Matrix3::from_diagonal_element(spread.trace()) - spread).try_inverse() else { return };
        for _ in 0..3 {
            let seen = self.back.to_rotation_matrix() * turned;
            let torque = Vector3::new(seen.m32 - seen.m23, seen.m13 - seen.m31, seen.m21 - seen.m12);
            let turn = inverse * torque;
            // Written so that NaN turns nothing.
            if !(turn.norm_squared() > T::of(LEAST_TURN * LEAST_TURN) && turn.norm_squared() < T::of(16.0)) {
                return;
            }
            self.back = UnitQuaternion::from_scaled_axis(-turn) * self.back;
            self.back.renormalize();
        }
    }
}

/// Keeps the present positions; triangles may be strained by the least that is allowed at their corners.
pub(crate) struct MakeRest<'a, T: Scalar> {
    pub(crate) tree: &'a Bvh<T>,
    pub(crate) mesh: &'a Mesh<T>,
    /// By vertex.
    pub(crate) allowed: &'a [T],
    pub(crate) rest: &'a mut Rest<T>,
}

impl<T: Scalar> Kernel<T> for MakeRest<'_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let Self { tree, mesh, allowed, rest } = self;
        let empty = RestTile { positions: [[T::zero(); TILE_SIZE]; 3], factors: [[T::zero(); TILE_SIZE]; 3] };
        (rest.centre, rest.back) = (mesh.aabb().centre(), UnitQuaternion::identity());
        memory::refill_with(&mut rest.tiles, empty, tree.tiles.len());
        // In units of the body, squares of areas neither overflow nor underflow.
        let unit = L::splat(T::one() / mesh.aabb().longest_side());
        for index in 0..tree.tiles.len() {
            let (tile, outline, rest_tile) = (&tree.tiles[index], &tree.outlines[index], &mut rest.tiles[index]);
            let seen = mesh.gather::<L>(&outline.vertices).sub(Vectors::splat(&rest.centre));
            seen.store(&mut rest_tile.positions);
            let mut row = [T::zero(); TILE_SIZE];
            for place in 0..TILE_SIZE {
                row[place] = allowed[outline.vertices[place] as usize];
            }
            let [first, second, third] = &tile.corners;
            let row = L::load(&row);
            let allowed = row.permute(first).smaller(row.permute(second)).smaller(row.permute(third));
            let a = seen.permuted(first);
            let (p, q) = (seen.permuted(second).sub(a).scaled(unit), seen.permuted(third).sub(a).scaled(unit));
            let normal = p.cross(q);
            // Along the first edge and across it.
            let square = p.dot(p);
            let (length, factor) = (square.sqrt(), unit.div(allowed));
            let across = factor.mul(length).div(normal.dot(normal).sqrt());
            factor.div(length).store(&mut rest_tile.factors[0]);
            across.store(&mut rest_tile.factors[1]);
            p.dot(q).div(square).mul(across).store(&mut rest_tile.factors[2]);
        }
    }
}

/// The box around the moves of each tile's vertices, without the turn of the whole.
pub(crate) struct FindMoves<'a, T: Scalar> {
    pub(crate) tree: &'a Bvh<T>,
    pub(crate) mesh: &'a Mesh<T>,
    pub(crate) rest: &'a Rest<T>,
    pub(crate) moves: &'a mut Vec<Aabb<T>>,
    /// The tiles with triangles that are strained by more than they may be, and which.
    pub(crate) strained: &'a mut Vec<(u32, Mask)>,
}

impl<T: Scalar> Kernel<T> for FindMoves<'_, T> {
    /// The box around all moves.
    type Output = Aabb<T>;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) -> Aabb<T> {
        let Self { tree, mesh, rest, moves, strained } = self;
        let rotation = rest.back.to_rotation_matrix();
        let rows = rotation.matrix().transpose();
        let [x, y, z]: [Vectors<T, L>; 3] = [
            Vectors::splat(&rows.column(0).into()),
            Vectors::splat(&rows.column(1).into()),
            Vectors::splat(&rows.column(2).into()),
        ];
        let centre = Vectors::splat(&mesh.aabb().centre());
        let one = L::splat(T::one());
        let mut whole = Aabb::empty();
        memory::refill_with(moves, whole, tree.tiles.len());
        strained.clear();
        strained.room_for(tree.tiles.len());
        for index in 0..tree.tiles.len() {
            let (tile, rest) = (&tree.tiles[index], &rest.tiles[index]);
            let seen = mesh.gather::<L>(&tree.outlines[index].vertices).sub(centre);
            let moved = Vectors::new(seen.dot(x), seen.dot(y), seen.dot(z)).sub(Vectors::load(&rest.positions));
            let aabb = Aabb { lower: moved.smallest_lanes(), upper: moved.greatest_lanes() };
            whole = whole.union(&aabb);
            moves[index] = aabb;
            let a = moved.permuted(&tile.corners[0]);
            let (p, q) = (moved.permuted(&tile.corners[1]).sub(a), moved.permuted(&tile.corners[2]).sub(a));
            let along = p.scaled(L::load(&rest.factors[0]));
            let across = q.scaled(L::load(&rest.factors[1])).sub(p.scaled(L::load(&rest.factors[2])));
            let held = along.dot(along).add(across.dot(across)).is_at_most(one);
            // Written so that NaN counts as strained.
            let beyond = tile.present & !held;
            if beyond != 0 {
                strained.push((index as u32, beyond));
            }
        }
        whole
    }
}
