use crate::bvh::node::BoxLanes;
use crate::bvh::rays::exit_culling::DirectionBounds;
use crate::bvh::rays::slabs::PacketSlabs;
use crate::bvh::tree::Bvh;
use crate::math::Scalar;
use crate::mesh::Mesh;
use crate::simd::{LANE_COUNT, Lanes, Mask};
use crate::triangle::RayPacket;

/// What a search is given, and what holds for the packet as a whole.
pub(crate) struct Search<'a, T: Scalar, L> {
    pub(crate) tree: &'a Bvh<T>,
    pub(crate) mesh: &'a Mesh<T>,
    pub(crate) packet: &'a RayPacket<T>,
    pub(crate) asked: Mask,
    pub(crate) slabs: PacketSlabs<T, L>,
    /// A box that holds all of the asked rays.
    pub(crate) around: BoxLanes<T, L>,
    /// Only where nothing but exits counts.
    pub(crate) directions: Option<DirectionBounds<T, L>>,
}

impl<T: Scalar, L: Lanes<T>> Search<'_, T, L> {
    /// Whether a hit on the tile may count. Where only exits count, none does if no ray can leave through the tile.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn may_count(&self, tile: usize, room: &mut [[T; LANE_COUNT]; 3]) -> bool {
        match &self.directions {
            Some(directions) => directions.may_leave(self.tree, tile, self.mesh, room),
            None => true,
        }
    }
}
