use super::border::CutAtSurface;
use super::cutter::Cutter;
use super::distance::{ContactLaw, distances_over_depths};
use super::face_source::{FaceSource, Starts};
use super::found::{Found, Origins, cosines, set_lane, vector};
use super::load::Turning;
use super::pair::Direction;
use super::rays::Rays;
use super::samples::WHOLE;
use super::workspace::Pieces;
use super::{Contact, Statistics, past_folds, starts_outside};
use crate::math::{Kernel, LANE_COUNT, Lanes, Mask, Scalar, Vector3};
use crate::octree::{Candidates, PacketHits};
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
        // Where memory ended on the way, some are left.
        self.pieces.clear();
        // Small functions that fill packets, and one loop that traces them: what is inlined here is large.
        let cutter = pair.cutter();
        let cutter = match pair.patch_area {
            Some(area) => cutter.map(|cutter| cutter.with_patches(area)),
            None => cutter,
        };
        let cutter = if pair.measures_distances() { cutter.map(Cutter::with_border) } else { cutter };
        let mut source = Source::new(cutter);
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
        rays.cut = 0;
        if self.pieces.inside.len() >= LANE_COUNT {
            return self.fill_from_inside(rays);
        }
        while count < LANE_COUNT {
            if let Some(piece) = self.pieces.cut.pop() {
                rays.set_sample(count, &piece.sample);
                rays.corner_weights[count] = piece.corner_weights;
                rays.cut |= 1 << count;
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
                rays.origins.pieces[count] = WHOLE;
                set_lane(&mut rays.origins.weights, count, &thirds);
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
                    rays.origins.pieces = [WHOLE; LANE_COUNT];
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
        let Rays { samples, surface, packet, candidates, hits, cut, .. } = rays;
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
        let crossed = if *cut != 0 && pair.measures_distances() {
            let inside = &mut self.pieces.inside;
            L::outlined(CutAtSurface { direction: self.direction, rays, exits: exits & !followed, inside })
        } else {
            0
        };
        self.statistics.border_pieces += u64::from(crossed.count_ones());
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
    fn new(cutter: Option<Cutter<'a, T>>) -> Self {
        Self { next: 0, faces: cutter.map(FaceSource::new) }
    }
}
