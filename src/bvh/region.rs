use crate::bvh::node::BoxLanes;
use crate::bvh::tree::Bvh;
use crate::bvh::walk::{Children, Visitor, Way, first_of};
use crate::math::{Aabb, Scalar};
use crate::memory::Room;
use crate::mesh::Mesh;
use crate::simd::{Kernel, LANE_COUNT, Lanes, Vectors, lanes_of};

/// Finds the tiles whose boxes meet a region.
struct TilesInRegion<'a, T: Scalar> {
    tree: &'a Bvh<T>,
    region: &'a Aabb<T>,
    tiles: &'a mut Vec<u32>,
}

impl<T: Scalar> Kernel<T> for TilesInRegion<'_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let Self { tree, region, tiles } = self;
        Way::new(()).walk::<T, L>(&mut InRegion { tree, region: BoxLanes::new(region), tiles });
    }
}

struct InRegion<'a, T: Scalar, L> {
    tree: &'a Bvh<T>,
    region: BoxLanes<T, L>,
    tiles: &'a mut Vec<u32>,
}

impl<T: Scalar, L: Lanes<T>> Visitor<T, L> for InRegion<'_, T, L> {
    type Kept = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter(&mut self, node: u32, (): &mut ()) -> Children {
        let mut room = None;
        let node = self.tree.node(node as usize, &mut room);
        let mut left = node.meets(&self.region);
        if !node.is_leaf {
            return Children { first: node.first, left };
        }
        while let Some(place) = first_of(&mut left) {
            self.tiles.room_for(1).push(node.first + place);
        }
        Children::NONE
    }
}

impl<T: Scalar> Bvh<T> {
    /// The tiles that may have something in the region, in ascending order, into `tiles`, which is cleared first.
    pub(crate) fn tiles_in(&self, region: &Aabb<T>, tiles: &mut Vec<u32>) {
        tiles.clear();
        crate::simd::dispatch::<T, _>(TilesInRegion { tree: self, region, tiles });
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
}
