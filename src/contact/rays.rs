use super::SurfacePoint;
use super::cutter::CutPiece;
use super::found::{Origins, set_lane, vector};
use super::load::CastSurfaceLanes;
use super::samples::Sample;
use crate::math::{Aabb, LANE_COUNT, Lanes, Mask, Scalar, Vector3, Vectors};
use crate::mesh::{Mesh, NormalLanes};
use crate::octree::{Candidates, PacketHits, PointDistances};
use crate::ray::RayPacket;

/// Up to sixteen samples, and their rays on their way.
pub(super) struct Rays<T: Scalar> {
    pub(super) samples: NormalLanes<T>,
    pub(super) origins: Origins<T>,
    pub(super) surface: CastSurfaceLanes<T>,
    pub(super) packet: RayPacket<T>,
    pub(super) candidates: Candidates<T>,
    pub(super) hits: PacketHits<T>,
    pub(super) distances: PointDistances<T>,
    /// Which lanes stand for a piece of their triangle, and the barycentric weights of its corners.
    pub(super) cut: Mask,
    pub(super) corner_weights: [[Vector3<T>; 3]; LANE_COUNT],
}

impl<T: Scalar> Rays<T> {
    pub(super) fn new(from_vertices: bool) -> Self {
        Self {
            samples: NormalLanes::empty(),
            origins: Origins::new(from_vertices),
            surface: CastSurfaceLanes::new(),
            packet: RayPacket::empty(),
            candidates: Candidates::new(),
            hits: PacketHits::empty(),
            distances: PointDistances::new(),
            cut: 0,
            corner_weights: [[Vector3::zeros(); 3]; LANE_COUNT],
        }
    }

    pub(super) fn set_sample(&mut self, lane: usize, sample: &Sample<T>) {
        set_lane(&mut self.samples.position, lane, &sample.point.position);
        set_lane(&mut self.samples.normal, lane, &sample.normal);
        self.samples.area[lane] = sample.area;
        self.origins.indices[lane] = sample.point.triangle;
        set_lane(&mut self.origins.weights, lane, &sample.point.weights.into());
        self.origins.pieces[lane] = sample.piece;
    }

    /// Which lanes start beside the region: their pieces only reach into it.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn beside<L: Lanes<T>>(&self, region: &Aabb<T>) -> Mask {
        if self.cut == 0 {
            return 0;
        }
        let at = Vectors::<T, L>::load(&self.samples.position);
        let within = Vectors::splat(&region.lower).are_at_most(at) & at.are_at_most(Vectors::splat(&region.upper));
        self.cut & !within
    }

    /// The piece that a lane in `cut` stands for.
    pub(super) fn piece(&self, lane: usize, own: &Mesh<T>) -> CutPiece<T> {
        let triangle = self.origins.indices[lane];
        let point = SurfacePoint {
            triangle,
            vertices: own.topology().triangles()[triangle as usize],
            weights: vector(&self.origins.weights, lane).into(),
            position: vector(&self.samples.position, lane),
        };
        let (normal, area) = (vector(&self.samples.normal, lane), self.samples.area[lane]);
        let sample = Sample { point, normal, area, piece: self.origins.pieces[lane] };
        CutPiece { sample, corner_weights: self.corner_weights[lane] }
    }
}
