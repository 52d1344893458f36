//! Rays of bodies that overlap themselves: where there are several folds, the winding number tells what a hit means.

use crate::bvh::PacketHits;
use crate::math::Scalar;
use crate::query::{Tracer, leaves_body_before_end, way_out_past_folds};
use crate::simd::{LANE_COUNT, Mask, lanes_of};
use crate::triangle::{Hit, RayPacket};

/// Replaces the hits of rays that start inside the other body and enter another fold of it first, by their way out. Gives which
/// do.
pub(crate) fn follow<T: Scalar>(
    other: &Tracer<'_, T>,
    packet: &RayPacket<T>,
    hits: &mut PacketHits<T>,
    crossings: &mut Vec<Hit<T>>,
) -> Mask {
    let entries = hits.found & !hits.exits;
    lanes_of(entries)
        .filter_map(|lane| Some((lane, way_out_past_folds(other, &packet.ray(lane), crossings)?)))
        .map(|(lane, way_out)| {
            hits.set(lane, &way_out);
            1 << lane
        })
        .fold(0, |followed, lane| followed | lane)
}

/// Which of the hidden rays have not left their own body: they only meet another fold of it.
pub(crate) fn uncovered<T: Scalar>(
    own: &Tracer<'_, T>,
    packet: &RayPacket<T>,
    hidden: Mask,
    end: &[T; LANE_COUNT],
    touched: &[[u32; LANE_COUNT]; 3],
    crossings: &mut Vec<Hit<T>>,
) -> Mask {
    lanes_of(hidden)
        .filter(|&lane| {
            let (ray, touched) = (packet.ray(lane).until(end[lane]), touched.map(|vertices| vertices[lane]));
            !leaves_body_before_end(own, &ray, touched, crossings)
        })
        .fold(0, |uncovered, lane| uncovered | 1 << lane)
}
