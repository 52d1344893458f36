//! Rays from vertices whose inward normal points out of their own body at once, as it may at sharp tips.

use crate::math::Scalar;
use crate::query::Tracer;
use crate::simd::{LANE_COUNT, Mask, lanes_of};
use crate::triangle::{Hit, RayPacket};

/// Which of the rays in these lanes start outside their own body and meet it before their end.
#[cold]
pub(crate) fn entering<T: Scalar>(
    own: &Tracer<'_, T>,
    packet: &RayPacket<T>,
    lanes: Mask,
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
    lanes_of(lanes).filter(|&lane| enters(lane)).fold(0, |mask, lane| mask | 1 << lane)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vector3;
    use crate::mesh::test_mesh::boxes;
    use crate::query::Octree;
    use crate::triangle::Ray;

    /// A box with another within it and one beside it. From the corner at (4, 0, 0) a ray leads out of the first and into
    /// the one beside it at t = 2, or into the first and on into the one within.
    #[test]
    fn rays_enter_that_start_outside_and_meet_their_body_before_their_end() {
        let mesh = boxes(&[[[0.0; 3], [4.0; 3]], [[1.0; 3], [3.0; 3]], [[6.0, 0.0, 0.0], [10.0, 4.0, 4.0]]]);
        let octree = Octree::new(&mesh);
        let tracer = octree.tracer(&mesh).expect("it is new");
        let (out, into) = (Vector3::new(1.0, 0.1, 0.2), Vector3::new(-1.0, 1.2, 1.1));
        let rays: Vec<_> = (0..LANE_COUNT)
            .map(|lane| Ray::new(Vector3::new(4.0, 0.0, 0.0), if lane % 2 == 0 { out } else { into }))
            .collect();
        let mut packet = RayPacket::empty();
        packet.set_rays::<<f64 as crate::simd::HasLanes>::Baseline>(&rays);
        let mut end = [9.0; LANE_COUNT];
        (end[2], end[4]) = (1.9, 2.1);
        for lanes in [0, 1, 0b11, 0b1_0101, 0b1111_1100, 0xaaaa, Mask::MAX] {
            let expected = lanes & 0x5555 & !0b100;
            let entered = entering(&tracer, &packet, lanes, &end, &[1; LANE_COUNT], &mut Vec::new());
            assert_eq!(entered, expected, "{lanes:b}");
        }
    }
}
