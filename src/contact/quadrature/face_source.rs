use crate::contact::quadrature::cutter::Cutter;
use crate::contact::quadrature::packet::SamplePacket;
use crate::contact::quadrature::pieces::Pieces;
use crate::contact::quadrature::sample::{Sample, WHOLE};
use crate::math::{Aabb, Scalar, Vector3};
use crate::memory::Room;
use crate::mesh::{Mesh, NormalLanes};
use crate::query::Tracer;
use crate::simd::{LANE_COUNT, Lanes, Mask, Vectors, set_lane, vector_in_lane};

/// A group of triangles on its way into packets.
pub(crate) struct FaceSource<'a, T: Scalar> {
    pub(crate) cutter: Cutter<'a, T>,
    pub(crate) triangles: [u32; LANE_COUNT],
    pub(crate) lanes: NormalLanes<T>,
    /// Which of the triangles have rays that are not yet in a packet.
    pub(crate) left: Mask,
    /// Which need not be cut.
    pub(crate) short: Mask,
    /// How many triangles in the region have no normal.
    pub(crate) without_normal: u64,
}

/// A group with at least this many faces fills a packet well enough to go alone.
const ENOUGH: u32 = 8;

impl<'a, T: Scalar> FaceSource<'a, T> {
    pub(crate) fn new(cutter: Cutter<'a, T>) -> Self {
        let (triangles, lanes) = ([0; LANE_COUNT], NormalLanes::empty());
        Self { cutter, triangles, lanes, left: 0, short: 0, without_normal: 0 }
    }

    /// The next packet of samples; false where there are no more.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn fill<L: Lanes<T>>(
        &mut self,
        own: &Tracer<'_, T>,
        groups: &[u32],
        next_group: &mut usize,
        pieces: &mut Pieces<T>,
        packet: &mut SamplePacket<T>,
    ) -> bool {
        let mut count = 0;
        let thirds = Vector3::repeat(T::one() / T::of(3.0));
        packet.known.lanes = 0;
        while count < LANE_COUNT {
            if let Some(sample) = pieces.cut.pop() {
                packet.set_sample(count, &sample);
                count += 1;
            } else if self.left != 0 {
                let lane = self.left.trailing_zeros() as usize;
                self.left &= self.left - 1;
                if self.short >> lane & 1 == 0 {
                    self.cut(own.mesh(), lane, &mut pieces.cut);
                    continue;
                }
                let (lanes, faces) = (&mut packet.lanes, &self.lanes);
                set_lane(&mut lanes.position, count, &vector_in_lane(&faces.position, lane));
                set_lane(&mut lanes.normal, count, &vector_in_lane(&faces.normal, lane));
                lanes.area[count] = faces.area[lane];
                packet.indices[count] = self.triangles[lane];
                packet.pieces[count] = WHOLE;
                set_lane(&mut packet.weights, count, &thirds);
                count += 1;
            } else if let Some(&group) = groups.get(*next_group) {
                self.without_normal += self.next::<L>(own, group);
                *next_group += 1;
                // A group that nearly fills a packet goes as it is.
                if count == 0 && self.left & !self.short == 0 && self.left.count_ones() >= ENOUGH {
                    packet.lanes = self.lanes;
                    packet.lanes.found = std::mem::take(&mut self.left);
                    packet.indices = self.triangles;
                    packet.weights = [[thirds.x; LANE_COUNT]; 3];
                    packet.pieces = [WHOLE; LANE_COUNT];
                    return true;
                }
            } else {
                break;
            }
        }
        packet.lanes.found = ((1u32 << count) - 1) as Mask;
        count > 0
    }

    /// Turns to another group; gives how many of its triangles in the region have no normal.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn next<L: Lanes<T>>(&mut self, own: &Tracer<'_, T>, group: u32) -> u64 {
        let mut count = 0;
        own.triangles_of(group, |triangle| {
            self.triangles[count] = triangle;
            count += 1;
        });
        let mut corners = [[[T::zero(); LANE_COUNT]; 3]; 3];
        own.mesh().face_normals::<L>(&self.triangles[..count], &mut corners, &mut self.lanes);
        let Aabb { lower, upper } = self.cutter.region;
        let (lower, upper) = (Vectors::<T, L>::splat(lower), Vectors::splat(upper));
        let (a, b, c) = (Vectors::load(&corners[0]), Vectors::load(&corners[1]), Vectors::load(&corners[2]));
        let touching = a.smaller(b).smaller(c).are_at_most(upper)
            & lower.are_at_most(a.larger(b).larger(c))
            & ((1u32 << count) - 1) as Mask;
        let (ab, bc, ca) = (a.sub(b), b.sub(c), c.sub(a));
        let longest = ab.dot(ab).larger(bc.dot(bc)).larger(ca.dot(ca));
        let middle = Vectors::load(&self.lanes.position);
        let middles_inside = lower.are_at_most(middle) & middle.are_at_most(upper);
        self.short = !L::splat(self.cutter.longest_allowed).is_less(longest);
        self.left = touching & self.lanes.found & (middles_inside | !self.short);
        u64::from((touching & !self.lanes.found).count_ones())
    }

    /// The pieces of one triangle, the last first.
    pub(crate) fn cut(&mut self, mesh: &Mesh<T>, lane: usize, pieces: &mut Vec<Sample<T>>) {
        let (normal, area) = (vector_in_lane(&self.lanes.normal, lane), self.lanes.area[lane]);
        self.cutter.cut(mesh, self.triangles[lane], normal, area, &mut |sample| pieces.room_for(1).push(sample));
        pieces.reverse();
    }
}
