use super::border::{self, Inside};
use super::cutter::{CutPiece, Cutter};
use super::distance::{ContactLaw, distances_over_depths};
use super::face_source::{FaceSource, Starts};
use super::found::{Found, Origins, cosines, set_lane, vector};
use super::load::{CastSurfaceLanes, Turning};
use super::pair::Direction;
use super::samples::Sample;
use super::workspace::Pieces;
use super::{Contact, Statistics, SurfacePoint, past_folds, starts_outside};
use crate::math::{Aabb, Kernel, LANE_COUNT, Lanes, Mask, Scalar, Vector3, Vectors};
use crate::memory::Room;
use crate::mesh::{Mesh, NormalLanes};
use crate::octree::{Candidates, PacketHits, PointDistances};
use crate::ray::{Hit, RayPacket};

/// The rays from some of a body's groups of vertices or triangles through the other body, sixteen at a time through
/// both filters of the paper.
pub(super) struct Cast<'a, T: Scalar> {
    pub(super) direction: &'a Direction<'a, T>,
    pub(super) starts: Starts<'a>,
    pub(super) surface: &'a mut Turning<T>,
    pub(super) statistics: &'a mut Statistics,
    pub(super) contacts: &'a mut Vec<Contact<T>>,
    /// Room for the pieces of a triangle, and for what is inside of those that the other body's surface crosses.
    pub(super) pieces: &'a mut Pieces<T>,
    /// Room for the vertices in the overlap box.
    pub(super) vertices: &'a mut Vec<u32>,
    /// Room for the crossings of a ray.
    pub(super) crossings: &'a mut Vec<Hit<T>>,
}

impl<T: Scalar> Kernel<T> for Cast<'_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(mut self) {
        let pair = self.direction.pair;
        // Small functions that fill packets, and one loop that traces them: what is inlined here is large.
        let cutter = pair.cutter();
        let cutter = match pair.patch_area {
            Some(area) => cutter.map(|cutter| cutter.with_patches(area)),
            None => cutter,
        };
        let mut source = Source::new(cutter, pair.measures_distances());
        let from_vertices = source.faces.is_none();
        if from_vertices {
            self.list_vertices::<L>();
        }
        let mut rays = Rays::new(from_vertices);
        while self.fill::<L>(&mut source, &mut rays) {
            self.cast::<L>(&mut rays);
        }
        *self.surface = rays.surface.total();
        if let Some(faces) = source.faces {
            self.statistics.uncut_pieces += faces.cutter.uncut;
            self.statistics.patches += faces.patch_count;
        }
    }
}

/// So many faces of one group make a packet worth its while.
const ENOUGH: u32 = 8;

/// Rays on their way.
struct Rays<T: Scalar> {
    samples: NormalLanes<T>,
    origins: Origins<T>,
    surface: CastSurfaceLanes<T>,
    packet: RayPacket<T>,
    candidates: Candidates<T>,
    hits: PacketHits<T>,
    distances: PointDistances<T>,
    /// Which lanes stand for surface that the other body's may cross: it is coarse, and not yet the part inside.
    coarse: Mask,
    /// Which lanes stand for a part of their triangle, and the barycentric weights of its corners.
    cut: Mask,
    corner_weights: [[Vector3<T>; 3]; LANE_COUNT],
}

impl<T: Scalar> Rays<T> {
    fn new(from_vertices: bool) -> Self {
        Self {
            samples: NormalLanes::empty(),
            origins: Origins::new(from_vertices),
            surface: CastSurfaceLanes::new(),
            packet: RayPacket::empty(),
            candidates: Candidates::new(),
            hits: PacketHits::empty(),
            distances: PointDistances::new(),
            coarse: 0,
            cut: 0,
            corner_weights: [[Vector3::zeros(); 3]; LANE_COUNT],
        }
    }
}

impl<T: Scalar> Rays<T> {
    fn set_sample(&mut self, lane: usize, sample: &Sample<T>) {
        set_lane(&mut self.samples.position, lane, &sample.point.position);
        set_lane(&mut self.samples.normal, lane, &sample.normal);
        self.samples.area[lane] = sample.area;
        self.origins.indices[lane] = sample.point.triangle;
        set_lane(&mut self.origins.weights, lane, &sample.point.weights.into());
    }

    /// Which lanes start beside the region: coarse surface that reaches into it.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn beside<L: Lanes<T>>(&self, region: &Aabb<T>) -> Mask {
        if self.coarse == 0 {
            return 0;
        }
        let at = Vectors::<T, L>::load(&self.samples.position);
        let within = Vectors::splat(&region.lower).are_at_most(at) & at.are_at_most(Vectors::splat(&region.upper));
        self.coarse & !within
    }

    /// The piece that a lane stands for.
    fn piece(&self, lane: usize, own: &Mesh<T>) -> CutPiece<T> {
        let triangle = self.origins.indices[lane];
        let point = SurfacePoint {
            triangle,
            vertices: own.topology().triangles()[triangle as usize],
            weights: vector(&self.origins.weights, lane).into(),
            position: vector(&self.samples.position, lane),
        };
        let sample = Sample { point, normal: vector(&self.samples.normal, lane), area: self.samples.area[lane] };
        let whole = [Vector3::x(), Vector3::y(), Vector3::z()];
        let corner_weights = if self.cut >> lane & 1 == 1 { self.corner_weights[lane] } else { whole };
        CutPiece { sample, corner_weights }
    }
}

impl<T: Scalar> Cast<'_, T> {
    /// The next packet of samples; false where there are no more.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn fill<L: Lanes<T>>(&mut self, source: &mut Source<'_, T>, rays: &mut Rays<T>) -> bool {
        match &mut source.faces {
            None => self.fill_from_vertices::<L>(&mut source.next, rays),
            Some(faces) => self.fill_from_faces::<L>(&mut source.next, faces, rays),
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn list_vertices<L: Lanes<T>>(&mut self) {
        let Direction { pair, side } = *self.direction;
        self.vertices.clear();
        if let Starts::Groups(groups) = self.starts {
            groups.iter().for_each(|&group| pair.tracers[side].add_vertices_in::<L>(group, pair.region, self.vertices));
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn fill_from_vertices<L: Lanes<T>>(&mut self, next: &mut usize, rays: &mut Rays<T>) -> bool {
        let vertices = &self.vertices[*next..self.vertices.len().min(*next + LANE_COUNT)];
        if vertices.is_empty() {
            return false;
        }
        *next += vertices.len();
        rays.origins.indices[..vertices.len()].copy_from_slice(vertices);
        let Direction { pair, side } = *self.direction;
        pair.tracers[side].mesh().vertex_normals::<L>(vertices, &mut rays.samples);
        self.statistics.without_normal += u64::from(vertices.len() as u32 - rays.samples.found.count_ones());
        true
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn fill_from_faces<L: Lanes<T>>(
        &mut self,
        next_group: &mut usize,
        source: &mut FaceSource<'_, T>,
        rays: &mut Rays<T>,
    ) -> bool {
        let own = self.direction.pair.tracers[self.direction.side];
        let mut count = 0;
        let thirds = Vector3::repeat(T::one() / T::of(3.0));
        (rays.coarse, rays.cut) = (0, 0);
        if self.pieces.inside.len() >= LANE_COUNT {
            return self.fill_from_inside(rays);
        }
        while count < LANE_COUNT {
            if let Some(piece) = self.pieces.cut.pop() {
                rays.set_sample(count, &piece.sample);
                rays.corner_weights[count] = piece.corner_weights;
                rays.cut |= 1 << count;
                rays.coarse |= Mask::from(source.keeps_border) << count;
                count += 1;
            } else if source.left != 0 {
                let lane = source.left.trailing_zeros() as usize;
                source.left &= source.left - 1;
                if source.short >> lane & 1 == 0 {
                    source.cut(own.mesh(), lane, &mut self.pieces.cut);
                    continue;
                }
                let (samples, faces) = (&mut rays.samples, &source.lanes);
                set_lane(&mut samples.position, count, &vector(&faces.position, lane));
                set_lane(&mut samples.normal, count, &vector(&faces.normal, lane));
                samples.area[count] = faces.area[lane];
                rays.origins.indices[count] = source.triangles[lane];
                set_lane(&mut rays.origins.weights, count, &thirds);
                rays.coarse |= (source.coarse >> lane & 1) << count;
                count += 1;
            } else if *next_group < self.starts.len() {
                self.statistics.without_normal += source.next::<L>(own, self.starts, *next_group);
                *next_group += 1;
                // A group that nearly fills a packet goes as it is.
                if count == 0 && source.left & !source.short == 0 && source.left.count_ones() >= ENOUGH {
                    rays.samples = source.lanes;
                    rays.samples.found = std::mem::take(&mut source.left);
                    rays.origins.indices = source.triangles;
                    rays.origins.weights = [[thirds.x; LANE_COUNT]; 3];
                    rays.coarse = source.coarse & rays.samples.found;
                    return true;
                }
            } else if count == 0 {
                return self.fill_from_inside(rays);
            } else {
                break;
            }
        }
        rays.samples.found = ((1u32 << count) - 1) as Mask;
        count > 0
    }

    /// Of the parts inside the other body the last ones.
    fn fill_from_inside(&mut self, rays: &mut Rays<T>) -> bool {
        let mut count = 0;
        while let Some(sample) = self.pieces.inside.pop() {
            rays.set_sample(count, &sample);
            count += 1;
            if count == LANE_COUNT {
                break;
            }
        }
        rays.samples.found = ((1u32 << count) - 1) as Mask;
        count > 0
    }

    /// Traces the rays of the samples and keeps those that pass both filters.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn cast<L: Lanes<T>>(&mut self, rays: &mut Rays<T>) {
        let Direction { pair, side } = *self.direction;
        let other = pair.tracers[1 - side];
        let beside = rays.beside::<L>(pair.region);
        let Rays { samples, surface, packet, candidates, hits, coarse, .. } = rays;
        let present = samples.found & !beside;
        self.statistics.rays += u64::from(present.count_ones());
        surface.add::<L>(samples);
        packet.set_inward::<L>(present, &samples.position, &samples.normal, &pair.ray_regions[side]);
        other.nearest_of_packet::<L>(packet, candidates, hits);
        let goes_past_folds = pair.options.past_folds;
        let mut followed = 0;
        if goes_past_folds {
            followed = past_folds::follow(other, packet, hits, self.crossings);
            self.statistics.past_folds += u64::from(followed.count_ones());
        }
        let exits = hits.found & hits.exits;
        self.statistics.misses += u64::from((packet.present & !hits.found).count_ones());
        self.statistics.entry_hits += u64::from((hits.found & !exits).count_ones());
        let crossed = if *coarse != 0 { self.cut_at_surface::<L>(rays, exits & !followed) } else { 0 };
        let Rays { samples, origins, packet, candidates, hits, distances, .. } = rays;
        let exits = exits & !crossed;
        if exits == 0 {
            return;
        }
        let hidden = if pair.hides_behind_own_surface {
            self.hidden::<L>(packet, hits, exits, samples.outward, origins, candidates)
        } else {
            0
        };
        let accepted = exits & !hidden;
        let measured = if pair.options.law == ContactLaw::Pressure { accepted & !followed } else { 0 };
        let without_depth = L::load(&hits.t).is_at_most(L::splat(T::zero()));
        let by_normals = accepted & (!measured | without_depth);
        let mut cos_alpha = [T::zero(); LANE_COUNT];
        if by_normals != 0 {
            cos_alpha = cosines::<T, L>(packet, hits, by_normals, other.mesh());
        }
        distances_over_depths::<T, L>(other, packet, measured, hits, distances, &mut cos_alpha);
        let found = Found { packet, samples, origins, hits, cos_alpha };
        found.accept::<L>(accepted, self.direction, self.contacts);
    }

    /// Holds coarse surface against that of the other body, and keeps what lies inside where it is crossed. Gives which of
    /// the rays in `exits` are no contacts thereby: the part inside casts another.
    #[inline(never)]
    fn cut_at_surface<L: Lanes<T>>(&mut self, rays: &mut Rays<T>, exits: Mask) -> Mask {
        let Direction { pair, side } = *self.direction;
        let [own, other] = [pair.tracers[side], pair.tracers[1 - side]];
        let asked = rays.coarse & rays.samples.found;
        let corners_of = |piece: &CutPiece<T>| {
            let corners = own.mesh().corners(piece.sample.point.triangle);
            piece.corner_weights.map(|weights| corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z)
        };
        let mut reach = [T::zero(); LANE_COUNT];
        for lane in (0..LANE_COUNT).filter(|lane| asked >> lane & 1 == 1) {
            let piece = rays.piece(lane, own.mesh());
            reach[lane] = border::reach(&corners_of(&piece), &piece.sample.point.position);
        }
        other.distances_of_packet::<L>(&rays.samples.position, asked, &reach, &mut rays.distances);
        let mut crossed = 0;
        for lane in (0..LANE_COUNT).filter(|lane| asked >> lane & 1 == 1) {
            if rays.distances.distances[lane] >= reach[lane] {
                continue;
            }
            let piece = rays.piece(lane, own.mesh());
            let is_inside = exits >> lane & 1 == 1;
            let Some(nearest) = other.closest_point(&piece.sample.point.position, reach[lane]) else { continue };
            match border::inside_part(&piece, &corners_of(&piece), other, &nearest, is_inside) {
                Inside::Part(part) => {
                    self.pieces.inside.room_for(1).push(part);
                    crossed |= Mask::from(is_inside) << lane;
                }
                Inside::All | Inside::Nothing => {}
            }
        }
        self.statistics.border_pieces += u64::from(crossed.count_ones());
        crossed
    }

    /// Which of the rays leave their own body before the other.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn hidden<L: Lanes<T>>(
        &mut self,
        packet: &RayPacket<T>,
        hits: &PacketHits<T>,
        exits: Mask,
        outward: Mask,
        origins: &Origins<T>,
        candidates: &mut Candidates<T>,
    ) -> Mask {
        let Direction { pair, side } = *self.direction;
        let own = pair.tracers[side];
        let touched = origins.touched(own.mesh());
        let mut hidden = own.hidden_of_packet::<L>(packet, exits, &hits.t, &touched, candidates);
        let doubtful = exits & !hidden & !outward;
        if origins.are_vertices && doubtful != 0 {
            hidden |= starts_outside::entering(own, packet, doubtful, &hits.t, &origins.indices, self.crossings);
        }
        if pair.options.past_folds && hidden != 0 {
            let uncovered = past_folds::uncovered(own, packet, hidden, &hits.t, &touched, self.crossings);
            self.statistics.past_folds += u64::from(uncovered.count_ones());
            hidden &= !uncovered;
        }
        self.statistics.own_surface_hits += u64::from(hidden.count_ones());
        hidden
    }
}

/// Where the next rays come from.
struct Source<'a, T: Scalar> {
    /// The next vertex, group or sixteen patches.
    next: usize,
    /// Instead of vertices.
    faces: Option<FaceSource<'a, T>>,
}

impl<'a, T: Scalar> Source<'a, T> {
    fn new(cutter: Option<Cutter<'a, T>>, keeps_border: bool) -> Self {
        Self { next: 0, faces: cutter.map(|cutter| FaceSource::new(cutter, keeps_border)) }
    }
}

