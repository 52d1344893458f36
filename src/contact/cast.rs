use crate::contact::classify::{past_folds, starts_outside};
use crate::contact::options::ContactLaw;
use crate::contact::pair::Direction;
use crate::contact::point_pair::{Contact, ContactKind};
use crate::contact::quadrature::packet::SamplePacket;
use crate::contact::quadrature::sampler::{Sampler, Starts};
use crate::contact::statistics::Statistics;
use crate::contact::trace::Rays;
use crate::contact::weigh::distance::distances_over_depths;
use crate::contact::weigh::shares::{CastSurfaceLanes, Turning};
use crate::contact::weigh::{accept, cosines};
use crate::math::Scalar;
use crate::self_contact::rounding;
use crate::simd::{Kernel, LANE_COUNT, Lanes, Mask};
use crate::triangle::Hit;

/// Casts rays from some samples of one body through the other, sixteen at a time through both filters of the paper. Gives the
/// surface that casts.
pub(crate) struct Cast<'a, T: Scalar> {
    /// The kind of the contacts made.
    pub(crate) kind: ContactKind,
    pub(crate) direction: &'a Direction<'a, T>,
    pub(crate) starts: Starts<'a, T>,
    pub(crate) statistics: &'a mut Statistics,
    pub(crate) contacts: &'a mut Vec<Contact<T>>,
    /// Scratch memory for the vertices in the overlap box.
    pub(crate) vertices: &'a mut Vec<u32>,
    /// Scratch memory for the crossings of a ray.
    pub(crate) crossings: &'a mut Vec<Hit<T>>,
}

impl<T: Scalar> Kernel<T> for Cast<'_, T> {
    type Output = Turning<T>;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) -> Turning<T> {
        let Self { kind, direction, starts, statistics, contacts, vertices, crossings } = self;
        let Direction { pair, side } = *direction;
        let mut sampler = Sampler::new::<L>(pair.tracers[side], pair.region, starts, vertices);
        let (mut samples, mut rays, mut surface) = (sampler.packet(), Rays::new(), CastSurfaceLanes::new());
        let mut tracing = Tracing { kind, direction, statistics, contacts, crossings };
        // Packets are filled by a small function and traced in one loop, because the code inlined into the loop is large.
        while sampler.fill::<L>(&mut samples) {
            surface.add::<L>(&samples.lanes);
            tracing.trace::<L>(&samples, &mut rays);
        }
        sampler.count(tracing.statistics);
        surface.total()
    }
}

/// What happens to a packet once it is filled.
struct Tracing<'a, T: Scalar> {
    kind: ContactKind,
    direction: &'a Direction<'a, T>,
    statistics: &'a mut Statistics,
    contacts: &'a mut Vec<Contact<T>>,
    crossings: &'a mut Vec<Hit<T>>,
}

impl<T: Scalar> Tracing<'_, T> {
    /// Traces the rays, classifies their hits, and makes contacts of those that pass both filters.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn trace<L: Lanes<T>>(&mut self, samples: &SamplePacket<T>, rays: &mut Rays<T>) {
        let Direction { pair, side } = *self.direction;
        let other = pair.tracers[1 - side];
        let Rays { packet, candidates, hits, .. } = rays;
        let present = samples.lanes.found;
        self.statistics.rays += u64::from(present.count_ones());
        let (position, normal) = (&samples.lanes.position, &samples.lanes.normal);
        packet.set_inward::<L>(present, position, normal, &pair.ray_regions[side]);
        other.nearest_of_packet::<L>(packet, candidates, hits);
        let mut followed = 0;
        if pair.options.past_folds {
            followed = past_folds::follow(other, packet, hits, self.crossings);
            self.statistics.past_folds += u64::from(followed.count_ones());
        }
        let exits = hits.found & hits.exits;
        self.statistics.misses += u64::from((packet.present & !hits.found).count_ones());
        self.statistics.entry_hits += u64::from((hits.found & !exits).count_ones());
        if exits == 0 {
            return;
        }
        let hidden = if pair.hides_behind_own_surface { self.hidden::<L>(samples, rays, exits) } else { 0 };
        let accepted = exits & !hidden;
        let measured = if pair.options.law == ContactLaw::Pressure { accepted & !followed } else { 0 };
        let without_depth = L::load(&rays.hits.t).is_at_most(L::splat(T::zero()));
        let by_normals = accepted & (!measured | without_depth);
        let mut cos_alpha = [T::zero(); LANE_COUNT];
        if by_normals != 0 {
            cos_alpha = cosines::<T, L>(&rays.packet, &rays.hits, by_normals, other.mesh());
        }
        let Rays { packet, hits, distances, .. } = rays;
        distances_over_depths::<T, L>(other, packet, measured, &samples.known, hits, distances, &mut cos_alpha);
        accept::<T, L>(self.kind, self.direction, samples, rays, accepted, &cos_alpha, self.contacts);
    }

    /// Which of the rays leave their own body before the other. Rays from faces end a little beyond the other body: a ray that
    /// leaves both bodies through faces in one plane is hidden, whatever rounding says. Rays from vertices end exactly there,
    /// as the paper's do.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn hidden<L: Lanes<T>>(&mut self, samples: &SamplePacket<T>, rays: &mut Rays<T>, exits: Mask) -> Mask {
        let Direction { pair, side } = *self.direction;
        let own = pair.tracers[side];
        let touched = samples.touched(own.mesh());
        let Rays { packet, candidates, hits, .. } = rays;
        let mut ends = hits.t;
        if !samples.are_vertices {
            let rounding = rounding(own.mesh()) + rounding(pair.tracers[1 - side].mesh());
            ends.iter_mut().for_each(|end| *end += rounding);
        }
        let mut hidden = own.hidden_of_packet::<L>(packet, exits, &ends, &touched, candidates);
        let doubtful = exits & !hidden & !samples.lanes.outward;
        if samples.are_vertices && doubtful != 0 {
            hidden |= starts_outside::entering(own, packet, doubtful, &ends, &samples.indices, self.crossings);
        }
        if pair.options.past_folds && hidden != 0 {
            let uncovered = past_folds::uncovered(own, packet, hidden, &ends, &touched, self.crossings);
            self.statistics.past_folds += u64::from(uncovered.count_ones());
            hidden &= !uncovered;
        }
        self.statistics.own_surface_hits += u64::from(hidden.count_ones());
        hidden
    }
}
