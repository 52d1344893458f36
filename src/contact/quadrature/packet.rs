use crate::contact::point_pair::{SurfacePoint, touched_of};
use crate::contact::quadrature::sample::{Sample, VERTEX, WHOLE};
use crate::math::Scalar;
use crate::mesh::{Mesh, NormalLanes};
use crate::simd::{LANE_COUNT, Lanes, Mask, set_lane, vector_in_lane};

/// Up to sixteen samples side by side.
pub(crate) struct SamplePacket<T: Scalar> {
    /// Positions, normals and areas, and which lanes hold a sample.
    pub(crate) lanes: NormalLanes<T>,
    /// Whether they are vertices, or else points on triangles.
    pub(crate) are_vertices: bool,
    /// The vertices, or the triangles.
    pub(crate) indices: [u32; LANE_COUNT],
    /// Barycentric, of points on triangles.
    pub(crate) weights: [[T; LANE_COUNT]; 3],
    /// As [`Contact::piece`](crate::contact::Contact::piece).
    pub(crate) pieces: [u32; LANE_COUNT],
    /// How far the other body's surface is, where that was measured before.
    pub(crate) known: KnownDistances<T>,
}

/// How far some of the samples of a packet are from the other body's surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KnownDistances<T> {
    pub(crate) lanes: Mask,
    pub(crate) distances: [T; LANE_COUNT],
}

impl<T: Scalar> SamplePacket<T> {
    pub(crate) fn new(are_vertices: bool) -> Self {
        Self {
            lanes: NormalLanes::empty(),
            are_vertices,
            indices: [0; LANE_COUNT],
            weights: [[T::zero(); LANE_COUNT]; 3],
            pieces: [if are_vertices { VERTEX } else { WHOLE }; LANE_COUNT],
            known: KnownDistances { lanes: 0, distances: [T::zero(); LANE_COUNT] },
        }
    }

    /// By lane three vertices; the triangles that touch the sample are those that have all three.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn touched(&self, own: &Mesh<T>) -> [[u32; LANE_COUNT]; 3] {
        let mut touched = [self.indices; 3];
        if self.are_vertices {
            return touched;
        }
        let triangles = own.topology().triangles();
        for (lane, &triangle) in self.indices.iter().enumerate() {
            let of_sample = touched_of(triangles[triangle as usize], [0, 1, 2].map(|k| self.weights[k][lane]));
            (0..3).for_each(|k| touched[k][lane] = of_sample[k]);
        }
        touched
    }

    /// Fills the packet with samples from `next` on; false where there are no more.
    pub(crate) fn take(&mut self, samples: &[Sample<T>], next: &mut usize) -> bool {
        let taken = &samples[*next..samples.len().min(*next + LANE_COUNT)];
        *next += taken.len();
        self.known.lanes = 0;
        for (lane, sample) in taken.iter().enumerate() {
            set_lane(&mut self.lanes.position, lane, &sample.point.position);
            set_lane(&mut self.lanes.normal, lane, &sample.normal);
            self.lanes.area[lane] = sample.area;
            self.indices[lane] = sample.point.triangle;
            set_lane(&mut self.weights, lane, &sample.point.weights.into());
            self.pieces[lane] = sample.piece;
            if let Some(distance) = sample.distance {
                self.known.lanes |= 1 << lane;
                self.known.distances[lane] = distance;
            }
        }
        self.lanes.found = ((1u32 << taken.len()) - 1) as Mask;
        !taken.is_empty()
    }

    /// The triangles on which the samples lie.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn triangles<L: Lanes<T>>(&self, own: &Mesh<T>) -> [u32; LANE_COUNT] {
        if self.are_vertices { own.topology().first_triangles::<T, L>(&self.indices) } else { self.indices }
    }

    /// A lane's sample, which lies on this triangle.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn sample(&self, triangle: u32, lane: usize, own: &Mesh<T>) -> Sample<T> {
        let (normal, area) = (vector_in_lane(&self.lanes.normal, lane), self.lanes.area[lane]);
        Sample { point: self.point(triangle, lane, own), normal, area, piece: self.pieces[lane], distance: None }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn point(&self, triangle: u32, lane: usize, own: &Mesh<T>) -> SurfacePoint<T> {
        let position = vector_in_lane(&self.lanes.position, lane);
        if self.are_vertices {
            let [second, third] = self.lanes.neighbours.each_ref().map(|neighbours| neighbours[lane]);
            let vertices = [self.indices[lane], second, third];
            return SurfacePoint { triangle, vertices, weights: [T::one(), T::zero(), T::zero()], position };
        }
        let weights = [self.weights[0][lane], self.weights[1][lane], self.weights[2][lane]];
        SurfacePoint { triangle, vertices: own.topology().triangles()[triangle as usize], weights, position }
    }
}
