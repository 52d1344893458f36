//! Which triangles are steep: some triangle near them faces more than 60° away from them. Around any other triangle the surface
//! is a graph over the triangle's plane.

use crate::bvh::{Bvh, TILE_SIZE};
use crate::math::Scalar;
use crate::math::margins::FACING_ALIKE;
use crate::memory;
use crate::mesh::Mesh;
use crate::self_contact::certificate::block::{Block, are_apart};
use crate::self_contact::certificate::narrow::Narrow;
use crate::simd::{Kernel, Lanes, Mask, Vectors, lanes_of};

/// The normals of a tile's triangles, of unit length.
pub(crate) type Normals = [[f32; TILE_SIZE]; 3];

/// Makes the normals of all tiles.
pub(crate) struct MakeNormals<'a, T: Scalar> {
    pub(crate) tree: &'a Bvh<T>,
    pub(crate) mesh: &'a Mesh<T>,
    pub(crate) narrow: Narrow<T>,
    pub(crate) normals: &'a mut Vec<Normals>,
}

impl<T: Scalar> Kernel<T> for MakeNormals<'_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let Self { tree, mesh, narrow, normals } = self;
        memory::refill_with(normals, [[0.0; TILE_SIZE]; 3], tree.tiles.len());
        let unit = L::splat(narrow.inverse);
        for index in 0..tree.tiles.len() {
            let tile = &tree.tiles[index];
            let positions = mesh.gather::<L>(&tree.outlines[index].vertices);
            let a = positions.permuted(&tile.corners[0]);
            let p = positions.permuted(&tile.corners[1]).sub(a).scaled(unit);
            let q = positions.permuted(&tile.corners[2]).sub(a).scaled(unit);
            let normal = p.cross(q);
            let mut rows = [[T::zero(); TILE_SIZE]; 3];
            Vectors::store(normal.scaled(L::splat(T::one()).div(normal.dot(normal).sqrt())), &mut rows);
            for axis in 0..3 {
                for place in 0..TILE_SIZE {
                    normals[index][axis][place] = rows[axis][place].to_f64() as f32;
                }
            }
        }
    }
}

/// Finds, by tile, the triangles that have others within a distance that do not face as they do.
pub(crate) struct FindSteep<'a, T: Scalar> {
    pub(crate) tree: &'a Bvh<T>,
    pub(crate) blocks: &'a [Block],
    pub(crate) normals: &'a [Normals],
    pub(crate) tile_pairs: &'a [[u32; 2]],
    pub(crate) distance: f32,
    /// The steep triangles for a larger distance, among which these are; `None` where they are not known.
    pub(crate) among: Option<&'a [Mask]>,
    pub(crate) steep: &'a mut Vec<Mask>,
}

impl<T: Scalar> Kernel<f32> for FindSteep<'_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<f32>>(self) {
        let Self { tree, blocks, normals, tile_pairs, distance, among, steep } = self;
        memory::refill_with(steep, 0, blocks.len());
        for pair in tile_pairs {
            let [first, second] = pair.map(|tile| tile as usize);
            let (a, b) = (&blocks[first], &blocks[second]);
            if among.is_some_and(|among| among[first] == 0 || among[second] == 0) {
                continue;
            }
            if are_apart(&a.whole, &b.whole, distance) {
                continue;
            }
            let present = tree.tiles[second].present;
            let facing = Vectors::<f32, L>::load(&normals[second]);
            let (mut steep_of_a, mut steep_of_b) = (0, 0);
            for place in lanes_of(a.near::<L>(&b.whole, distance)) {
                let [x, y, z] = &normals[first];
                let along = facing.x.mul(L::splat(x[place]));
                let along = along.add(facing.y.mul(L::splat(y[place]))).add(facing.z.mul(L::splat(z[place])));
                // Written so that NaN faces away.
                let away = present & !L::splat(FACING_ALIKE).is_at_most(along);
                if away != 0 {
                    let others = away & b.near::<L>(&a.sides_of(place), distance);
                    steep_of_a |= Mask::from(others != 0) << place;
                    steep_of_b |= others;
                }
            }
            steep[first] |= steep_of_a;
            steep[second] |= steep_of_b;
        }
    }
}
