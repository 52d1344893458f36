//! Which vertices lie inside another part of their body: those with a winding number above 1 just under them, each by a ray.
//!
//! A ray costs what it passes, and sixteen that go the same way cost little more than one. So a ray goes along an axis, to the
//! side where the body's box is nearer, if all triangles around its vertex face along that axis, or all against it. Just before
//! and behind such a vertex the winding number differs by one, so one side tells the other. Where no axis will do, at edges and
//! corners, the ray goes along the inward normal.

use crate::bvh::Candidates;
use crate::math::Scalar;
use crate::memory::Room;
use crate::mesh::{Facing, NormalLanes};
use crate::query::Tracer;
use crate::simd::{Kernel, LANE_COUNT, Lanes, Mask, dispatch};
use crate::triangle::{Hit, RayPacket};

/// The result of the search, and its scratch memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct Inside<T: Scalar> {
    groups: Vec<u32>,
    /// All vertices of the surface, neighbours together.
    vertices: Vec<u32>,
    starts: Starts,
    crossings: Vec<Hit<T>>,
    /// Places in `vertices`.
    found: Vec<u32>,
}

/// By the way of their rays, the places of vertices, each with whether its ray goes outward.
#[derive(Clone, Debug, Default)]
struct Starts {
    /// By axis, against it and along it.
    along_axes: [[Vec<(u32, bool)>; 2]; 3],
    inward: Vec<(u32, bool)>,
}

impl<T: Scalar> Inside<T> {
    /// Finds the places of the vertices inside, in no order.
    pub(crate) fn find(&mut self, tracer: &Tracer<'_, T>) -> &[u32] {
        tracer.groups_in(tracer.mesh().aabb(), &mut self.groups);
        dispatch::<T, _>(Search { tracer, inside: self });
        &self.found
    }

    /// The vertex at a place.
    pub(crate) fn vertex_at(&self, place: u32) -> u32 {
        self.vertices[place as usize]
    }
}

struct Search<'a, T: Scalar> {
    tracer: &'a Tracer<'a, T>,
    inside: &'a mut Inside<T>,
}

impl<T: Scalar> Kernel<T> for Search<'_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let Self { tracer, inside } = self;
        let Inside { groups, vertices, starts, crossings, found } = inside;
        vertices.clear();
        for &group in groups.iter() {
            tracer.add_vertices_in::<L>(group, tracer.mesh().aabb(), vertices);
        }
        starts.choose::<T, L>(tracer, vertices);
        found.clear();
        let mut cast = Cast { tracer, vertices, crossings, found };
        for axis in 0..3 {
            for side in 0..2 {
                let starts = &starts.along_axes[axis][side];
                L::outlined(CastAll { cast: &mut cast, way: Some((axis, side)), starts });
            }
        }
        L::outlined(CastAll { cast: &mut cast, way: None, starts: &starts.inward });
    }
}

impl Starts {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn choose<T: Scalar, L: Lanes<T>>(&mut self, tracer: &Tracer<'_, T>, vertices: &[u32]) {
        self.along_axes.iter_mut().flatten().for_each(Vec::clear);
        self.inward.clear();
        let (mesh, mut lanes) = (tracer.mesh(), NormalLanes::empty());
        for (number, some) in vertices.chunks(LANE_COUNT).enumerate() {
            let Facing { along, against } = mesh.facing::<L>(some, &mut lanes);
            for lane in 0..some.len() {
                let is_set = |mask: Mask| mask >> lane & 1 == 1;
                if !is_set(lanes.found) {
                    continue;
                }
                let (mut shortest, mut way) = (T::INFINITY, None);
                for axis in 0..3 {
                    // The mean normal has to face outward from all triangles, so that both are on one side.
                    if is_set((along[axis] | against[axis]) & lanes.outward) {
                        let at = lanes.position[axis][lane];
                        let ways = [at - mesh.aabb().lower[axis], mesh.aabb().upper[axis] - at];
                        for side in 0..2 {
                            if ways[side] < shortest {
                                (shortest, way) = (ways[side], Some((axis, side)));
                            }
                        }
                    }
                }
                let place = (number * LANE_COUNT + lane) as u32;
                let (list, is_outward) = match way {
                    Some((axis, side)) => (&mut self.along_axes[axis][side], is_set(along[axis]) == (side == 1)),
                    None => (&mut self.inward, false),
                };
                list.room_for(1).push((place, is_outward));
            }
        }
    }
}

/// What rays are cast in, and the list of vertices found inside.
struct Cast<'a, T: Scalar> {
    tracer: &'a Tracer<'a, T>,
    vertices: &'a [u32],
    crossings: &'a mut Vec<Hit<T>>,
    found: &'a mut Vec<u32>,
}

/// The rays that go one way.
struct CastAll<'a, 'b, T: Scalar> {
    cast: &'a mut Cast<'b, T>,
    /// The axis and the side that the rays go to; `None` for inward normals.
    way: Option<(usize, usize)>,
    starts: &'a [(u32, bool)],
}

impl<T: Scalar> Kernel<T> for CastAll<'_, '_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let Self { cast: Cast { tracer, vertices, crossings, found }, way, starts } = self;
        let mesh = tracer.mesh();
        let (mut lanes, mut packet) = (NormalLanes::empty(), RayPacket::empty());
        let (mut list, mut numbers) = (Candidates::new(), [0; LANE_COUNT]);
        if let Some((axis, side)) = way {
            lanes.normal[axis] = [if side == 1 { -T::one() } else { T::one() }; LANE_COUNT];
        }
        for some in starts.chunks(LANE_COUNT) {
            let mut own = [0; LANE_COUNT];
            for lane in 0..LANE_COUNT {
                own[lane] = vertices[some[lane.min(some.len() - 1)].0 as usize];
            }
            if way.is_some() {
                mesh.gather::<L>(&own).store(&mut lanes.position);
                lanes.found = ((1u32 << some.len()) - 1) as Mask;
            } else {
                mesh.vertex_normals::<L>(&own[..some.len()], &mut lanes);
            }
            packet.set_inward::<L>(lanes.found, &lanes.position, &lanes.normal, mesh.aabb());
            tracer.windings_of_packet::<L>(&packet, &[own; 3], &mut list, crossings, &mut numbers);
            for lane in 0..some.len() {
                let (place, is_outward) = some[lane];
                // Its own surface lies between the two sides.
                if numbers[lane] + i32::from(is_outward) > 1 {
                    found.room_for(1).push(place);
                }
            }
        }
    }
}
