//! How deep the middles of elements lie, sixteen at a time.

use crate::bvh::{Candidates, PacketHits};
use crate::contact::classify::past_folds;
use crate::contact::pair::Pair;
use crate::contact::quadrature::element::{Element, Frame, Side};
use crate::math::{Scalar, Vector3, direction, margins};
use crate::query::PointDistances;
use crate::simd::{LANE_COUNT, Lanes, Mask, set_lane};
use crate::triangle::{Hit, RayPacket};

/// Asks how deep the middles of elements lie.
pub(crate) struct Measurement<'a, 'b, T: Scalar> {
    pair: &'a Pair<'b, T>,
    frame: &'a Frame<T>,
    rays: RayPacket<T>,
    hits: PacketHits<T>,
    candidates: Candidates<T>,
    distances: PointDistances<T>,
}

impl<'a, 'b, T: Scalar> Measurement<'a, 'b, T> {
    pub(crate) fn new(pair: &'a Pair<'b, T>, frame: &'a Frame<T>) -> Self {
        let (rays, hits) = (RayPacket::empty(), PacketHits::empty());
        Self { pair, frame, rays, hits, candidates: Candidates::new(), distances: PointDistances::new() }
    }

    /// Measures one body's elements; gives how many rays it took.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn run<L: Lanes<T>>(
        &mut self,
        body: usize,
        elements: &mut [Element<T>],
        crossings: &mut Vec<Hit<T>>,
    ) -> u64 {
        let (mut next, mut ray_count) = (0, 0);
        loop {
            let (mut places, mut count) = ([0; LANE_COUNT], 0);
            while count < LANE_COUNT && next < elements.len() {
                if usize::from(elements[next].body) == body {
                    places[count] = next;
                    count += 1;
                }
                next += 1;
            }
            if count == 0 {
                return ray_count;
            }
            ray_count += self.measure::<L>(body, &places[..count], elements, crossings);
        }
    }

    /// Measures up to sixteen elements: by rays on which side of the surface they are, where that is not known, and then how far
    /// the surface is, no farther than where the ray meets it, and outside no farther than the element reaches.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn measure<L: Lanes<T>>(
        &mut self,
        body: usize,
        places: &[usize],
        elements: &mut [Element<T>],
        crossings: &mut Vec<Hit<T>>,
    ) -> u64 {
        let Self { pair, frame, rays, hits, candidates, distances } = self;
        let other = pair.tracers[1 - body];
        let (mut positions, mut normals) = ([[T::zero(); LANE_COUNT]; 3], [[T::zero(); LANE_COUNT]; 3]);
        let mut unknown = 0;
        for (lane, &place) in places.iter().enumerate() {
            let element = &elements[place];
            set_lane(&mut positions, lane, &frame.point(&element.centre));
            set_lane(&mut normals, lane, &direction(&element.vector).unwrap_or_else(Vector3::z));
            unknown |= Mask::from(element.side == Side::Unknown) << lane;
        }
        if unknown != 0 {
            rays.set_inward::<L>(unknown, &positions, &normals, &pair.ray_regions[body]);
            other.nearest_of_packet::<L>(rays, candidates, hits);
            if pair.options.past_folds {
                past_folds::follow(other, rays, hits, crossings);
            }
        }
        let inside = hits.found & hits.exits;
        let (mut bounds, mut near) = ([T::zero(); LANE_COUNT], [0; LANE_COUNT]);
        let margin = T::one() + margins::margin(margins::DISTANCE_BOUND);
        for (lane, &place) in places.iter().enumerate() {
            let element = &mut elements[place];
            let mut bound = frame.length(element.depth);
            if element.side == Side::Unknown {
                element.side = if inside >> lane & 1 == 1 { Side::Inside } else { Side::Outside };
                if element.side == Side::Inside {
                    bound = bound.min(hits.t[lane]);
                    element.near = element.near.or(Some(hits.triangle[lane]));
                }
            }
            if element.side == Side::Outside {
                bound = bound.min(frame.length(element.radius));
            }
            bounds[lane] = bound;
            near[lane] = element.near.unwrap_or(0);
        }
        // A triangle that was near before is the best guess, and its distance the best bound.
        let mut to_near = [T::zero(); LANE_COUNT];
        other.distances_to_triangles::<L>(&positions, &near, &mut to_near, distances);
        for lane in 0..places.len() {
            bounds[lane] = bounds[lane].min(to_near[lane]) * margin;
        }
        let asked = ((1u32 << places.len()) - 1) as Mask;
        other.distances_of_packet::<L>(&positions, asked, &bounds, distances);
        for (lane, &place) in places.iter().enumerate() {
            let element = &mut elements[place];
            let distance = frame.of_length(distances.distances[lane]);
            element.depth = if element.side == Side::Inside { distance } else { -distance };
            element.near = distances.triangle(lane).or(element.near);
        }
        u64::from(unknown.count_ones())
    }
}
