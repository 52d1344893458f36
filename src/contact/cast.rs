use super::cutter::Cutter;
use super::distance::{ContactLaw, distances_over_depths};
use super::found::{Found, Origins, cosines, vector};
use super::load::{CastSurfaceLanes, Turning};
use super::pair::Direction;
use super::samples::Sample;
use super::{Contact, Statistics, past_folds, starts_outside};
use crate::math::{Aabb, Kernel, LANE_COUNT, Lanes, Mask, Scalar, Vector3, Vectors, direction, length};
use crate::memory::Room;
use crate::mesh::{Mesh, NormalLanes, Standing};
use crate::octree::{Candidates, PacketHits, PointDistances, Tracer};
use crate::ray::{Hit, RayPacket};

/// The rays from some of a body's groups of vertices or triangles through the other body, sixteen at a time through
/// both filters of the paper.
pub(super) struct Cast<'a, T: Scalar> {
    pub(super) direction: &'a Direction<'a, T>,
    pub(super) starts: Starts<'a>,
    pub(super) surface: &'a mut Turning<T>,
    pub(super) statistics: &'a mut Statistics,
    pub(super) contacts: &'a mut Vec<Contact<T>>,
    /// Room for the pieces of a triangle.
    pub(super) pieces: &'a mut Vec<Sample<T>>, // must be empty
    /// Room for the vertices in the overlap box.
    pub(super) vertices: &'a mut Vec<u32>,
    /// Room for the crossings of a ray.
    pub(super) crossings: &'a mut Vec<Hit<T>>,
}

/// Where rays start.
#[derive(Clone, Copy)]
pub(super) enum Starts<'a> {
    /// From the vertices or triangles of these groups.
    Groups(&'a [u32]),
    /// From the triangles at these places, each for its patch.
    Patches(&'a Standing, &'a [u32]),
}

impl Starts<'_> {
    /// In how many steps they are taken.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Groups(groups) => groups.len(),
            Self::Patches(_, places) => places.len().div_ceil(LANE_COUNT),
        }
    }
}

impl<T: Scalar> Kernel<T> for Cast<'_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(mut self) {
        let pair = self.direction.pair;
        // Small functions that fill packets, and one loop that traces them: what is inlined here is large.
        let cutter = pair.cutter();
        let mut source = Source::new(match pair.patch_area {
            Some(area) => cutter.map(|cutter| cutter.with_patches(area)),
            None => cutter,
        });
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
        }
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
        let Origins { indices: triangles, weights, .. } = &mut rays.origins;
        while count < LANE_COUNT {
            if let Some(piece) = self.pieces.pop() {
                set_lane(&mut rays.samples.position, count, &piece.point.position);
                set_lane(&mut rays.samples.normal, count, &piece.normal);
                rays.samples.area[count] = piece.area;
                triangles[count] = piece.point.triangle;
                set_lane(weights, count, &piece.point.weights.into());
                count += 1;
            } else if source.left != 0 {
                let lane = source.left.trailing_zeros() as usize;
                source.left &= source.left - 1;
                if source.short >> lane & 1 == 0 {
                    source.cut(own.mesh(), lane, self.pieces);
                    continue;
                }
                let (samples, faces) = (&mut rays.samples, &source.lanes);
                set_lane(&mut samples.position, count, &vector(&faces.position, lane));
                set_lane(&mut samples.normal, count, &vector(&faces.normal, lane));
                samples.area[count] = faces.area[lane];
                triangles[count] = source.triangles[lane];
                set_lane(weights, count, &thirds);
                count += 1;
            } else if *next_group < self.starts.len() {
                self.statistics.without_normal += source.next::<L>(own, self.starts, *next_group);
                *next_group += 1;
                // A group that nearly fills a packet goes as it is.
                if count == 0 && source.left & !source.short == 0 && source.left.count_ones() >= ENOUGH {
                    rays.samples = source.lanes;
                    rays.samples.found = std::mem::take(&mut source.left);
                    *triangles = source.triangles;
                    *weights = [[thirds.x; LANE_COUNT]; 3];
                    return true;
                }
            } else {
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
        let Rays { samples, origins, surface, packet, candidates, hits, distances } = rays;
        self.statistics.rays += u64::from(samples.found.count_ones());
        surface.add::<L>(samples);
        packet.set_inward::<L>(samples.found, &samples.position, &samples.normal, &pair.ray_regions[side]);
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

#[cfg_attr(not(debug_assertions), inline(always))]
fn set_lane<T: Scalar>([x, y, z]: &mut [[T; LANE_COUNT]; 3], lane: usize, vector: &Vector3<T>) {
    (x[lane], y[lane], z[lane]) = (vector.x, vector.y, vector.z);
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

/// A group of triangles on its way into packets.
struct FaceSource<'a, T: Scalar> {
    cutter: Cutter<'a, T>,
    triangles: [u32; LANE_COUNT],
    lanes: NormalLanes<T>,
    /// Which of the triangles have rays that are not yet in a packet.
    left: Mask,
    /// Which need not be cut.
    short: Mask,
    /// How many stood for others too.
    patch_count: u64,
}

impl<'a, T: Scalar> FaceSource<'a, T> {
    fn new(cutter: Cutter<'a, T>) -> Self {
        Self { cutter, triangles: [0; LANE_COUNT], lanes: NormalLanes::empty(), left: 0, short: 0, patch_count: 0 }
    }

    /// Turns to another group, or the next sixteen patches; gives how many of the triangles in the region have no normal.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn next<L: Lanes<T>>(&mut self, own: &Tracer<'_, T>, starts: Starts<'_>, number: usize) -> u64 {
        let mut count = 0;
        let mut add = |triangle| {
            self.triangles[count] = triangle;
            count += 1;
        };
        let mut patches = None;
        match starts {
            Starts::Groups(groups) => own.triangles_of(groups[number], add),
            Starts::Patches(standing, places) => {
                let places = &places[number * LANE_COUNT..places.len().min((number + 1) * LANE_COUNT)];
                places.iter().for_each(|&place| add(standing.triangle(place)));
                patches = Some((standing, places));
            }
        }
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
        if let Some((standing, places)) = patches {
            self.stand_for_patches::<L>(own.mesh(), standing, places, middles_inside & touching);
        }
        self.left = touching & self.lanes.found & (middles_inside | !self.short);
        u64::from((touching & !self.lanes.found).count_ones())
    }

    /// Gives the triangles the normals and areas of the patches that they stand for: of the sum of area · normal, so that
    /// an even pressure pushes a patch just as its triangles.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn stand_for_patches<L: Lanes<T>>(
        &mut self,
        mesh: &Mesh<T>,
        standing: &Standing,
        places: &[u32],
        mut wanted: Mask,
    ) {
        while wanted != 0 {
            let lane = wanted.trailing_zeros() as usize;
            wanted &= wanted - 1;
            let border = standing.border(places[lane]);
            if border.is_empty() {
                continue;
            }
            self.patch_count += 1;
            self.short |= 1 << lane;
            let vector = mesh.doubled_area_within::<L>(border) * T::of(0.5);
            match direction(&vector) {
                Some(normal) => {
                    set_lane(&mut self.lanes.normal, lane, &normal);
                    self.lanes.area[lane] = length(&vector);
                    self.lanes.found |= 1 << lane;
                }
                None => self.lanes.found &= !(1 << lane),
            }
        }
    }

    /// The pieces of one triangle, the last first.
    fn cut(&mut self, mesh: &Mesh<T>, lane: usize, pieces: &mut Vec<Sample<T>>) {
        let (normal, area) = (vector(&self.lanes.normal, lane), self.lanes.area[lane]);
        self.cutter.cut(mesh, self.triangles[lane], normal, area, &mut |piece| pieces.room_for(1).push(piece));
        pieces.reverse();
    }
}
