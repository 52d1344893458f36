//! Where the rays of a packet meet the tiles: by lists of all tiles that the box around the packet meets or, where these
//! are many, by a walk that holds the nodes' boxes against the rays themselves. Both give the same hits.

pub(crate) mod answer;
pub(crate) mod candidates;
pub(crate) mod hits;
pub(crate) mod lists;
pub(crate) mod search;
#[cfg(all(test, target_arch = "x86_64"))]
pub(crate) mod tests;
pub(crate) mod walk;
pub(crate) mod windings;

use crate::bvh::node::BoxLanes;
use crate::bvh::rays::exit_culling::DirectionBounds;
use crate::bvh::rays::packet::answer::{Answer, Hidden, Nearest};
use crate::bvh::rays::packet::candidates::Candidates;
use crate::bvh::rays::packet::hits::PacketHits;
use crate::bvh::rays::packet::search::Search;
use crate::bvh::rays::packet::walk::Walk;
use crate::bvh::rays::packet::windings::Windings;
use crate::bvh::rays::slabs::PacketSlabs;
use crate::bvh::tree::Bvh;
use crate::math::{Aabb, Scalar};
use crate::mesh::Mesh;
use crate::simd::{Kernel, LANE_COUNT, Lanes, Mask};
use crate::triangle::RayPacket;

impl<T: Scalar> Bvh<T> {
    /// The nearest hit of each ray.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn nearest<L: Lanes<T>>(
        &self,
        mesh: &Mesh<T>,
        packet: &RayPacket<T>,
        list: &mut Candidates<T>,
        hits: &mut PacketHits<T>,
    ) {
        hits.found = 0;
        let answer = &mut Nearest { end: packet.t_max, hits };
        let (asked, end) = (packet.present, &packet.t_max);
        L::outlined(PacketSearch { tree: self, mesh, packet, asked, end, list, answer });
    }

    /// Which of the rays in `asked` leave the mesh strictly before `end`, through other triangles than those that have all
    /// their ray's `touched` vertices.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn hidden<L: Lanes<T>>(
        &self,
        mesh: &Mesh<T>,
        packet: &RayPacket<T>,
        asked: Mask,
        end: &[T; LANE_COUNT],
        touched: &[[u32; LANE_COUNT]; 3],
        list: &mut Candidates<T>,
    ) -> Mask {
        let mut answer = Hidden { end, touched, hidden: 0 };
        L::outlined(PacketSearch { tree: self, mesh, packet, asked, end, list, answer: &mut answer });
        answer.hidden & asked
    }

    /// How often the mesh winds around where the rays start, by every crossing of the rays up to their ends, in whatever order
    /// they come: see [`Tracer::windings_of_packet`](crate::query::Tracer).
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn windings<L: Lanes<T>>(
        &self,
        mesh: &Mesh<T>,
        packet: &RayPacket<T>,
        touched: &[[u32; LANE_COUNT]; 3],
        list: &mut Candidates<T>,
        numbers: &mut [i32; LANE_COUNT],
    ) {
        *numbers = [0; LANE_COUNT];
        let (asked, end) = (packet.present, &packet.t_max);
        let answer = &mut Windings { mesh, packet, touched, numbers };
        L::outlined(PacketSearch { tree: self, mesh, packet, asked, end, list, answer });
    }
}

/// The search of a packet's asked rays up to their ends.
struct PacketSearch<'a, T: Scalar, A> {
    tree: &'a Bvh<T>,
    mesh: &'a Mesh<T>,
    packet: &'a RayPacket<T>,
    asked: Mask,
    end: &'a [T; LANE_COUNT],
    list: &'a mut Candidates<T>,
    answer: &'a mut A,
}

impl<T: Scalar, A: Answer<T>> Kernel<T> for PacketSearch<'_, T, A> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let Self { tree, mesh, packet, asked, end, list, answer } = self;
        if asked == 0 {
            return;
        }
        let slabs = PacketSlabs::<T, L>::new(packet, mesh.aabb());
        let mut around = slabs.box_around(packet, end, asked, mesh.aabb());
        // A host's rays may lie mostly outside the mesh's box, and then the box around them tells little.
        if !A::EXITS_ONLY && reaches_out(&around, mesh.aabb()) {
            around = slabs.box_inside(packet, end, asked, mesh.aabb());
        }
        // No closure: it would be compiled for any processor.
        let directions = if A::EXITS_ONLY { Some(DirectionBounds::<T, L>::new(packet, asked, &around)) } else { None };
        let around = BoxLanes::new(&around);
        let search = Search { tree, mesh, packet, asked, slabs, around, directions };
        if !lists::search(&search, list, answer) {
            L::outlined(Walk { search: &search, list, answer });
        }
    }
}

/// Whether a box holds all of the mesh's, or much besides.
#[cfg_attr(not(debug_assertions), inline(always))]
fn reaches_out<T: Scalar>(around: &Aabb<T>, mesh_box: &Aabb<T>) -> bool {
    let far = (mesh_box.upper - mesh_box.lower) * T::of(0.125);
    let [lower, upper] = [mesh_box.lower - far, mesh_box.upper + far];
    around == mesh_box || (0..3).any(|axis| around.lower[axis] < lower[axis] || upper[axis] < around.upper[axis])
}
