use crate::bvh::{Bvh, TILE_SIZE};
use crate::math::Scalar;
use crate::self_contact::certificate::narrow::{Narrow, Sides};
use crate::simd::{Lanes, Lists, Mask, Vectors, lanes_of};

/// The boxes of a tile's triangles, side by side; places beyond the last triangle hold boxes that are near nothing.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    /// Around all of them.
    pub(crate) whole: Sides,
    sides: [[f32; TILE_SIZE]; 6],
    vertices: [[u32; TILE_SIZE]; 3],
}

/// Whether two boxes are farther apart than `distance` along some axis.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn are_apart(a: &Sides, b: &Sides, distance: f32) -> bool {
    let mut are_apart = false;
    for side in 0..6 {
        are_apart |= a[side] + b[(side + 3) % 6] > distance;
    }
    are_apart
}

/// Which lanes have the same coordinates.
#[cfg_attr(not(debug_assertions), inline(always))]
fn are_equal<T: Scalar, L: Lanes<T>>(a: Vectors<T, L>, b: Vectors<T, L>) -> Mask {
    a.are_at_most(b) & b.are_at_most(a)
}

impl Block {
    pub(crate) const EMPTY: Self =
        Self { whole: [f32::INFINITY; 6], sides: [[f32::INFINITY; TILE_SIZE]; 6], vertices: [[0; TILE_SIZE]; 3] };

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn fill<T: Scalar, L: Lanes<T>>(
        &mut self,
        tree: &Bvh<T>,
        tile: usize,
        positions: Vectors<T, L>,
        narrow: &Narrow<T>,
    ) {
        let (tile, all_vertices) = (&tree.tiles[tile], &tree.outlines[tile].vertices);
        // No closures here: they would be compiled for any processor.
        let a = positions.permuted(&tile.corners[0]);
        let b = positions.permuted(&tile.corners[1]);
        let c = positions.permuted(&tile.corners[2]);
        // No ray meets a triangle of which two corners are one point.
        let merged = are_equal(a, b) | are_equal(b, c) | are_equal(c, a);
        let (mut lower, mut upper) = ([[T::zero(); TILE_SIZE]; 3], [[T::zero(); TILE_SIZE]; 3]);
        a.smaller(b).smaller(c).store(&mut lower);
        a.larger(b).larger(c).store(&mut upper);
        let Self { whole, sides, vertices } = self;
        for axis in 0..3 {
            for place in 0..TILE_SIZE {
                sides[axis][place] = narrow.lower(axis, lower[axis][place]);
                sides[axis + 3][place] = narrow.upper(axis, upper[axis][place]);
            }
        }
        for place in lanes_of(!tile.present | merged) {
            sides.iter_mut().for_each(|side| side[place] = f32::INFINITY);
        }
        *whole = [f32::INFINITY; 6];
        for side in 0..6 {
            for place in 0..TILE_SIZE {
                whole[side] = if sides[side][place] < whole[side] { sides[side][place] } else { whole[side] };
            }
        }
        for corner in 0..3 {
            for place in 0..TILE_SIZE {
                vertices[corner][place] = all_vertices[tile.corners[corner][place] as usize % TILE_SIZE];
            }
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn sides_of(&self, place: usize) -> Sides {
        let [a, b, c, d, e, f] = &self.sides;
        [a[place], b[place], c[place], d[place], e[place], f[place]]
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn vertices_of(&self, place: usize) -> [u32; 3] {
        let [a, b, c] = &self.vertices;
        [a[place], b[place], c[place]]
    }

    /// Which triangles' boxes are at most `distance` from `other` along every axis.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn near<L: Lanes<f32>>(&self, other: &Sides, distance: f32) -> Mask {
        let mut near = !0;
        for side in 0..6 {
            let gap = L::load(&self.sides[side]).add(L::splat(other[(side + 3) % 6]));
            near &= gap.is_at_most(L::splat(distance));
        }
        near
    }

    /// Which triangles have one of these vertices.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn sharing<L: Lanes<f32>>(&self, vertices: [u32; 3]) -> Mask {
        let mut sharing = 0;
        for own in &self.vertices {
            for vertex in vertices {
                sharing |= L::Lists::equal(own, vertex);
            }
        }
        sharing
    }
}
