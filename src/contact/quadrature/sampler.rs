//! Samples of one body's surface, a packet at a time.

use crate::contact::quadrature::cutter::Cutter;
use crate::contact::quadrature::packet::SamplePacket;
use crate::contact::quadrature::sample::{MeasuredSample, Sample};
use crate::contact::statistics::Statistics;
use crate::math::{Aabb, Scalar};
use crate::memory::{self, Room};
use crate::query::Tracer;
use crate::simd::{Kernel, LANE_COUNT, Lanes};

/// Where rays start.
#[derive(Clone, Copy)]
pub(crate) enum Starts<'a, T: Scalar> {
    /// From the vertices of these groups.
    Groups(&'a [u32]),
    /// From these.
    Samples(&'a [Sample<T>]),
    /// From these, in the middles of elements.
    Measured(&'a [MeasuredSample<T>]),
}

impl<T: Scalar> Starts<'_, T> {
    /// How many steps it takes to go through them.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Groups(groups) => groups.len(),
            Self::Samples(samples) => samples.len().div_ceil(LANE_COUNT),
            Self::Measured(samples) => samples.len().div_ceil(LANE_COUNT),
        }
    }
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
    /// `vertices` is scratch memory.
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

    /// A packet for these samples.
    pub(crate) fn packet(&self) -> SamplePacket<T> {
        SamplePacket::new(matches!(self.starts, Starts::Groups(_)))
    }

    /// Counts vertices that cast no ray.
    pub(crate) fn count(&self, statistics: &mut Statistics) {
        statistics.without_normal += self.without_normal;
    }

    /// The next packet of samples; false where there are no more.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn fill<L: Lanes<T>>(&mut self, packet: &mut SamplePacket<T>) -> bool {
        match self.starts {
            Starts::Samples(samples) => packet.take(samples, &mut self.next),
            Starts::Measured(samples) => packet.take_measured(samples, &mut self.next),
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

/// All samples at once, into `samples`: by vertex or triangle, and of a triangle the first half before the second. Without a
/// cutter they are vertices.
pub(crate) struct Collect<'a, T: Scalar> {
    pub(crate) own: &'a Tracer<'a, T>,
    pub(crate) region: &'a Aabb<T>,
    pub(crate) cutter: Option<Cutter<'a, T>>,
    pub(crate) groups: &'a [u32],
    pub(crate) vertices: &'a mut Vec<u32>,
    pub(crate) order: &'a mut Vec<Place>,
    pub(crate) samples: &'a mut Vec<Sample<T>>,
}

/// By what a sample is sorted, and where it is in a list.
pub(crate) type Place = ((u32, u32), u32);

impl<T: Scalar> Kernel<T> for Collect<'_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let Self { own, region, cutter, groups, vertices, order, samples } = self;
        samples.clear();
        if let Some(mut cutter) = cutter {
            cutter.cut_groups(own, groups, samples);
        } else {
            let mut sampler = Sampler::new::<L>(own, region, Starts::Groups(groups), vertices);
            let mut packet = sampler.packet();
            while sampler.fill::<L>(&mut packet) {
                let found = packet.lanes.found;
                let lanes = (0..LANE_COUNT).filter(|lane| found >> lane & 1 == 1);
                samples.room_for(LANE_COUNT).extend(lanes.map(|lane| packet.sample(lane, own.mesh())));
            }
        }
        // In an order that does not depend on the layout of the tree.
        memory::refill(order, samples.iter().map(Sample::place).zip(0..));
        sort(samples, order);
    }
}

/// Sorts samples by their places alone, which are much smaller, and only then moves each once.
fn sort<T: Scalar>(samples: &mut [Sample<T>], order: &mut [((u32, u32), u32)]) {
    order.sort_unstable();
    for start in 0..order.len() {
        // Around a ring of samples, each of which belongs where the next one is now.
        let (mut place, first) = (start, samples[start]);
        loop {
            let from = std::mem::replace(&mut order[place].1, place as u32) as usize;
            if from == start {
                samples[place] = first;
                break;
            }
            samples[place] = samples[from];
            place = from;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::point_pair::SurfacePoint;
    use crate::math::Vector3;

    /// Of one triangle the first half comes before the second, and halves of halves between them.
    #[test]
    fn samples_come_by_triangle_and_piece() {
        let sample = |(triangle, piece): (u32, u32)| {
            let point = SurfacePoint {
                triangle,
                vertices: [0; 3],
                weights: [0.0; 3],
                position: Vector3::repeat(f64::from(piece)),
            };
            Sample { point, normal: Vector3::z(), area: 1.0, piece }
        };
        let expected = [(0, 1), (2, 4), (2, 5), (2, 3), (7, 2), (7, 6), (7, 7), (9, 1), (1 << 31, 1)];
        for turn in 0..500usize {
            let mut left = expected.to_vec();
            let mut state = turn;
            let mut samples = Vec::new();
            while !left.is_empty() {
                samples.push(sample(left.swap_remove(state % left.len())));
                state /= 3;
            }
            let mut order: Vec<_> = samples.iter().map(Sample::place).zip(0..).collect();
            sort(&mut samples, &mut order);
            assert!(samples.iter().map(|sample| (sample.point.triangle, sample.piece)).eq(expected));
            assert!(samples.iter().all(|sample| sample.point.position.x == f64::from(sample.piece)));
        }
    }
}
