use crate::bvh::Bvh;
use crate::bvh::node::BoxLanes;
use crate::bvh::rays::trace::STACK_SIZE;
use crate::math::{Aabb, Scalar};
use crate::memory::Room;
use crate::mesh::Mesh;
use crate::simd::{Kernel, LANE_COUNT, Lanes, Vectors, lanes_of};

/// Finds the tiles whose boxes meet a region.
pub(crate) struct TilesInRegion<'a, T: Scalar> {
    pub(crate) cells: &'a Bvh<T>,
    pub(crate) region: &'a Aabb<T>,
    pub(crate) tiles: &'a mut Vec<u32>,
}

impl<T: Scalar> Kernel<T> for TilesInRegion<'_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let region = BoxLanes::new(self.region);
        let mut stack = [0u32; STACK_SIZE];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let mut room = None;
            let node = self.cells.node(stack[waiting] as usize, &mut room);
            let mut met = node.meets::<L>(&region);
            if node.is_leaf {
                while met != 0 {
                    self.tiles.room_for(1).push(node.first + met.trailing_zeros());
                    met &= met - 1;
                }
            }
            // The first child last, so that it comes next: tiles come in ascending order.
            while met != 0 {
                let place = met.ilog2();
                stack[waiting] = node.first + place;
                waiting += 1;
                met &= !(1 << place);
            }
        }
    }
}

impl<T: Scalar> Bvh<T> {
    /// The tiles that may have something in the region, in ascending order, into `tiles`, which is cleared first.
    pub(crate) fn tiles_in(&self, region: &Aabb<T>, tiles: &mut Vec<u32>) {
        tiles.clear();
        crate::simd::dispatch::<T, _>(TilesInRegion { cells: self, region, tiles });
        debug_assert!(tiles.is_sorted());
    }

    /// Adds those of the tile's own vertices that lie in the region.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn add_vertices_in<L: Lanes<T>>(
        &self,
        mesh: &Mesh<T>,
        tile: u32,
        region: &Aabb<T>,
        vertices: &mut Vec<u32>,
    ) {
        let tile = tile as usize;
        let mut room = [[T::zero(); LANE_COUNT]; 3];
        let positions = Vectors::<T, L>::load(self.positions_of::<L>(tile, mesh, &mut room));
        let inside =
            Vectors::splat(&region.lower).are_at_most(positions) & positions.are_at_most(Vectors::splat(&region.upper));
        let of_tile = &self.outlines[tile].vertices;
        vertices.room_for(LANE_COUNT);
        lanes_of(inside & self.tiles[tile].owned).for_each(|lane| vertices.push(of_tile[lane]));
    }

    pub(crate) fn tile_count(&self) -> u32 {
        self.tiles.len() as u32
    }

    pub(crate) fn vertices_of(&self, tile: u32) -> &[u32] {
        &self.outlines[tile as usize].vertices
    }

    pub(crate) fn triangles_of(&self, tile: u32) -> &[u32] {
        self.tiles[tile as usize].triangles()
    }
}
