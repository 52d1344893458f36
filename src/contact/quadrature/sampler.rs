//! Samples of one body's surface, a packet at a time.

use crate::contact::quadrature::packet::SamplePacket;
use crate::contact::quadrature::sample::Sample;
use crate::contact::statistics::Statistics;
use crate::math::{Aabb, Scalar};
use crate::memory::Room;
use crate::query::Tracer;
use crate::simd::{Kernel, LANE_COUNT, Lanes, lanes_of};

/// Where rays start.
#[derive(Clone, Copy)]
pub(crate) enum Starts<'a, T: Scalar> {
    /// From the vertices of these groups.
    Groups(&'a [u32]),
    Samples(&'a [Sample<T>]),
}

/// Fills packets with the samples of one body inside a region.
pub(crate) struct Sampler<'a, T: Scalar> {
    own: &'a Tracer<'a, T>,
    starts: Starts<'a, T>,
    /// The next vertex or sample.
    next: usize,
    vertices: &'a mut Vec<u32>,
    /// How many vertices in the region have no normal.
    without_normal: u64,
}

impl<'a, T: Scalar> Sampler<'a, T> {
    /// `vertices`: scratch memory.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn new<L: Lanes<T>>(
        own: &'a Tracer<'a, T>,
        region: &Aabb<T>,
        starts: Starts<'a, T>,
        vertices: &'a mut Vec<u32>,
    ) -> Self {
        vertices.clear();
        if let Starts::Groups(groups) = starts {
            // A closure would be compiled without the lanes' instructions.
            for &group in groups {
                own.add_vertices_in::<L>(group, region, vertices);
            }
        }
        Self { own, starts, next: 0, vertices, without_normal: 0 }
    }

    /// An empty packet.
    pub(crate) fn packet(&self) -> SamplePacket<T> {
        SamplePacket::new(matches!(self.starts, Starts::Groups(_)))
    }

    /// Counts vertices that cast no ray.
    pub(crate) fn count(&self, statistics: &mut Statistics) {
        statistics.without_normal += self.without_normal;
    }

    /// Fills the packet with the next samples; false where there are no more.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn fill<L: Lanes<T>>(&mut self, packet: &mut SamplePacket<T>) -> bool {
        match self.starts {
            Starts::Samples(samples) => packet.take(samples, &mut self.next),
            Starts::Groups(_) => self.fill_from_vertices::<L>(packet),
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn fill_from_vertices<L: Lanes<T>>(&mut self, packet: &mut SamplePacket<T>) -> bool {
        let vertices = &self.vertices[self.next..self.vertices.len().min(self.next + LANE_COUNT)];
        if vertices.is_empty() {
            return false;
        }
        self.next += vertices.len();
        match vertices.first_chunk::<LANE_COUNT>() {
            Some(all) => packet.indices = *all,
            None => packet.indices[..vertices.len()].copy_from_slice(vertices),
        }
        self.own.mesh().vertex_normals::<L>(vertices, &mut packet.lanes);
        self.without_normal += u64::from(vertices.len() as u32 - packet.lanes.found.count_ones());
        true
    }
}

/// Adds all vertices of some groups that lie in a region to `samples`, by ascending number.
pub(crate) struct CollectVertices<'a, T: Scalar> {
    pub(crate) own: &'a Tracer<'a, T>,
    pub(crate) region: &'a Aabb<T>,
    pub(crate) groups: &'a [u32],
    pub(crate) vertices: &'a mut Vec<u32>,
    pub(crate) samples: &'a mut Vec<Sample<T>>,
}

impl<T: Scalar> Kernel<T> for CollectVertices<'_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let Self { own, region, groups, vertices, samples } = self;
        let mut sampler = Sampler::new::<L>(own, region, Starts::Groups(groups), vertices);
        sampler.vertices.sort_unstable();
        let mut packet = sampler.packet();
        while sampler.fill::<L>(&mut packet) {
            let triangles = packet.triangles::<L>(own.mesh());
            let sample = |lane: usize| packet.sample(triangles[lane], lane, own.mesh());
            samples.room_for(LANE_COUNT).extend(lanes_of(packet.lanes.found).map(sample));
        }
    }
}
