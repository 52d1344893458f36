use super::{Node, Tile, Wide};
use crate::math::{Aabb, Kernel, LANE_COUNT, Lanes, Scalar, Vectors};
use crate::mesh::Mesh;

/// Renews the boxes, from the tiles upward. Tiles are to be loaded anew afterwards, those that are needed.
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
            let (lower, upper) = L::bounds(self.mesh.positions(), &tile.vertices);
            tile.aabb = Aabb { lower, upper };
            tile.is_loaded = false;
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

/// Loads the positions of tiles that are not.
pub(super) struct Load<'a, T: Scalar> {
    pub(super) cells: &'a mut Wide<T>,
    pub(super) mesh: &'a Mesh<T>,
    /// `None`: all tiles.
    pub(super) tiles: Option<&'a [u32]>,
}

impl<T: Scalar> Kernel<T> for Load<'_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let tiles = &mut self.cells.tiles;
        let count = self.tiles.map_or(tiles.len(), <[u32]>::len);
        for place in 0..count {
            let tile = &mut tiles[self.tiles.map_or(place, |chosen| chosen[place] as usize)];
            if !tile.is_loaded {
                Vectors::<T, L>::gather(self.mesh.positions(), &tile.vertices).store(&mut tile.positions);
                tile.is_loaded = true;
            }
        }
    }
}

impl<T: Scalar> Tile<T> {
    /// The positions of the vertices, loaded or not; `room` is for those that are not.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn positions<'a, L: Lanes<T>>(
        &'a self,
        mesh: &Mesh<T>,
        room: &'a mut [[T; LANE_COUNT]; 3],
    ) -> &'a [[T; LANE_COUNT]; 3] {
        if self.is_loaded {
            return &self.positions;
        }
        // Rays that leave the region for which tiles were loaded are few.
        Vectors::<T, L>::gather(mesh.positions(), &self.vertices).store(room);
        room
    }
}
