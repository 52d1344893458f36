//! Rays from vertices whose inward normal is out of their own body at once, as it may be at sharp tips.

use crate::math::{LANE_COUNT, Mask, Scalar};
use crate::octree::Tracer;
use crate::ray::{Hit, RayPacket};

/// Which of the asked rays start outside their own body and meet it before their end.
#[cold]
pub(super) fn entering<T: Scalar>(
    own: &Tracer<'_, T>,
    packet: &RayPacket<T>,
    asked: Mask,
    end: &[T; LANE_COUNT],
    vertices: &[u32; LANE_COUNT],
    crossings: &mut Vec<Hit<T>>,
) -> Mask {
    let mesh = own.mesh();
    let mut enters = |lane: usize| {
        let (vertex, ray) = (vertices[lane], packet.ray(lane).until(end[lane]));
        let mut around = mesh.topology().triangles_around(vertex).iter();
        if around.all(|&triangle| mesh.scaled_normal(triangle).dot(&ray.direction) < T::zero()) {
            return false;
        }
        own.crossings(&ray, crossings);
        let is_around = |hit: &Hit<T>| mesh.topology().triangles()[hit.triangle as usize].contains(&vertex);
        let first = crossings.iter().find(|hit| !is_around(hit));
        first.is_some_and(|hit| !hit.is_exit && hit.t < ray.t_max)
    };
    (0..LANE_COUNT).filter(|&lane| asked >> lane & 1 == 1 && enters(lane)).fold(0, |mask, lane| mask | 1 << lane)
}
