use crate::bvh::tree::Bvh;
use crate::math::{Aabb, Scalar, Vector3, margins};
use crate::mesh::Mesh;
use crate::simd::{LANE_COUNT, Lanes, Mask, Vectors};
use crate::triangle::RayPacket;

/// The box around the directions of some rays. It tells through which tiles none of the rays can leave the body. Nearly all tiles
/// around the points where rays start are such: rays always meet their boxes.
pub(crate) struct DirectionBounds<T: Scalar, L> {
    lower: Vectors<T, L>,
    upper: Vectors<T, L>,
    /// The largest size of a component.
    largest: T,
    /// How long the rays are, at most, along any axis.
    reach: T,
}

impl<T: Scalar, L: Lanes<T>> DirectionBounds<T, L> {
    /// Of the `asked` rays; `around` is a box that holds them all.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn new(packet: &RayPacket<T>, asked: Mask, around: &Aabb<T>) -> Self {
        let directions = Vectors::<T, L>::load(&packet.direction);
        let endless = Vectors::splat(&Vector3::repeat(T::INFINITY));
        let lower = Vectors::select(asked, directions, endless).smallest_lanes();
        let upper = Vectors::select(asked, directions, endless.negate()).greatest_lanes();
        Self {
            lower: Vectors::splat(&lower),
            upper: Vectors::splat(&upper),
            largest: upper.max().max(-lower.min()),
            reach: around.longest_side(),
        }
    }

    /// Whether any of the rays may meet one of the tile's triangles from inside.
    ///
    /// A triangle is met from inside where normal · direction > 0. The largest that this can be in the box of directions is
    /// held against its own rounding error and that of the triangle test, whose corners are rounded as coarsely as they are
    /// far from the origin.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn may_leave(
        &self,
        tree: &Bvh<T>,
        tile: usize,
        mesh: &Mesh<T>,
        room: &mut [[T; LANE_COUNT]; 3],
    ) -> bool {
        let positions = Vectors::<T, L>::load(tree.positions_of::<L>(tile, mesh, room));
        let (tile, aabb) = (&tree.tiles[tile], &tree.outlines[tile].aabb);
        let (a, b, c) = (
            positions.permuted(&tile.corners[0]),
            positions.permuted(&tile.corners[1]),
            positions.permuted(&tile.corners[2]),
        );
        let normal = b.sub(a).cross(c.sub(a));
        let greatest = normal.times(self.lower).larger(normal.times(self.upper));
        let along = greatest.x.add(greatest.y).add(greatest.z);
        let size = aabb.longest_side();
        let rounding = margins::margin::<T>(margins::LEAVING) * (size + self.reach);
        let margin = self.largest * (rounding * (size + rounding) + T::SAFE_SQUARES.0);
        !along.is_less(L::splat(-margin)) & tile.present != 0
    }
}
