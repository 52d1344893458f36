use super::{Node, Tile, Wide};
use crate::math::{Aabb, Kernel, Lanes, Scalar, Vectors};
use crate::mesh::Mesh;

/// Renews the boxes, from the tiles upward.
pub(super) struct Refit<'a, T: Scalar> {
    pub(super) cells: &'a mut Wide<T>,
    pub(super) mesh: &'a Mesh<T>,
}

impl<T: Scalar> Kernel<T> for Refit<'_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let Wide { tiles, nodes } = self.cells;
        for tile in tiles.iter_mut() {
            tile.load::<L>(self.mesh);
        }
        for index in (0..nodes.len()).rev() {
            let Node { first, count, is_leaf, .. } = nodes[index];
            for place in 0..count as usize {
                let child = first as usize + place;
                let aabb = if is_leaf { tiles[child].aabb } else { nodes[child].aabb::<L>() };
                nodes[index].set_box(place, &aabb);
            }
        }
    }
}

impl<T: Scalar> Tile<T> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn load<L: Lanes<T>>(&mut self, mesh: &Mesh<T>) {
        let positions = Vectors::<T, L>::gather(mesh.positions(), &self.vertices);
        positions.store(&mut self.positions);
        self.aabb = Aabb { lower: positions.smallest_lanes(), upper: positions.greatest_lanes() };
    }
}
