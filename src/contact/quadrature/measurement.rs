//! How deep the middles of elements lie, sixteen at a time.

use crate::contact::classify::past_folds;
use crate::contact::pair::Pair;
use crate::contact::quadrature::element::{Element, Frame, Side};
use crate::contact::trace::Rays;
use crate::math::{Scalar, Vector3, direction, margins};
use crate::simd::{LANE_COUNT, Lanes, Mask, set_lane};
use crate::triangle::Hit;

/// Measures how deep the middles of elements lie.
pub(crate) struct Measurement<'a, 'b, T: Scalar> {
    pair: &'a Pair<'b, T>,
    frame: &'a Frame<T>,
    rays: Rays<T>,
}

impl<'a, 'b, T: Scalar> Measurement<'a, 'b, T> {
    pub(crate) fn new(pair: &'a Pair<'b, T>, frame: &'a Frame<T>) -> Self {
        Self { pair, frame, rays: Rays::new() }
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
            let (mut indices, mut count) = ([0; LANE_COUNT], 0);
            while count < LANE_COUNT && next < elements.len() {
                if usize::from(elements[next].body) == body {
                    indices[count] = next;
                    count += 1;
                }
                next += 1;
            }
            if count == 0 {
                return ray_count;
            }
            ray_count += self.measure::<L>(body, &indices[..count], elements, crossings);
        }
    }

    /// Measures up to sixteen elements. Where it is not known on which side of the surface one lies, a ray tells. Then the
    /// nearest point of the surface is looked for: no farther than where the ray meets it, and outside no farther than the
    /// element reaches.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn measure<L: Lanes<T>>(
        &mut self,
        body: usize,
        indices: &[usize],
        elements: &mut [Element<T>],
        crossings: &mut Vec<Hit<T>>,
    ) -> u64 {
        let Self { pair, frame, rays: Rays { packet, candidates, hits, distances } } = self;
        let other = pair.tracers[1 - body];
        let (mut positions, mut normals) = ([[T::zero(); LANE_COUNT]; 3], [[T::zero(); LANE_COUNT]; 3]);
        let mut unknown = 0;
        for (lane, &index) in indices.iter().enumerate() {
            let element = &mut elements[index];
            let position = frame.point(&element.centre);
            set_lane(&mut positions, lane, &position);
            if element.side == Side::Unknown && !pair.region.contains(&position) {
                element.side = Side::Outside;
            } else if element.side == Side::Unknown {
                set_lane(&mut normals, lane, &direction(&element.vector).unwrap_or_else(Vector3::z));
                unknown |= 1 << lane;
            }
        }
        if unknown != 0 {
            packet.set_inward::<L>(unknown, &positions, &normals, &pair.ray_regions[body]);
            other.nearest_of_packet::<L>(packet, candidates, hits);
            if pair.options.past_folds {
                past_folds::follow(other, packet, hits, crossings);
            }
        }
        let inside = hits.found & hits.exits;
        let (mut bounds, mut near) = ([T::zero(); LANE_COUNT], [0; LANE_COUNT]);
        let margin = T::one() + margins::margin(margins::DISTANCE_BOUND);
        for (lane, &index) in indices.iter().enumerate() {
            let element = &mut elements[index];
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
        for lane in 0..indices.len() {
            bounds[lane] = bounds[lane].min(to_near[lane]) * margin;
        }
        let lanes = ((1u32 << indices.len()) - 1) as Mask;
        other.distances_of_packet::<L>(&positions, lanes, &bounds, distances);
        for (lane, &index) in indices.iter().enumerate() {
            let element = &mut elements[index];
            let distance = frame.of_length(distances.distances[lane]);
            element.depth = if element.side == Side::Inside { distance } else { -distance };
            element.near = distances.triangle(lane).or(element.near);
        }
        u64::from(unknown.count_ones())
    }
}
