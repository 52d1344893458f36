//! An order of a mesh's triangles that does not depend on how vertices, triangles and corners are numbered.

use super::Topology;
use crate::math::{Scalar, Vector3};
use crate::memory;
use std::cmp::Ordering;

/// The triangles in the order in which their corners come in space, at the reference positions. What is settled once for a mesh
/// goes by this order, so other numbers give the same tiles and patches.
pub(crate) struct OrderInSpace<'a, T: Scalar> {
    positions: &'a [Vector3<T>],
    triangles: &'a [[u32; 3]],
    /// By vertex its rank in space; vertices in one place have the same.
    ranks: Vec<u32>,
    /// The triangles, in order.
    pub(crate) order: Vec<u32>,
}

impl<'a, T: Scalar> OrderInSpace<'a, T> {
    pub(crate) fn new(topology: &'a Topology, positions: &'a [Vector3<T>]) -> Self {
        let triangles = topology.triangles();
        let ranks = ranks(positions);
        let sorted = |corners: &[u32; 3]| first_rank_first(*corners, &ranks).map(|vertex| ranks[vertex as usize]);
        let keys = memory::listed(triangles.iter().map(sorted));
        // Counted by first corner, two triangles on average are left to be sorted.
        let mut ends = memory::filled(0u32, positions.len() + 1);
        keys.iter().for_each(|key| ends[key[0] as usize + 1] += 1);
        (1..ends.len()).for_each(|rank| ends[rank] += ends[rank - 1]);
        let mut order = memory::filled(0, triangles.len());
        for (key, number) in keys.iter().zip(0u32..) {
            let end = &mut ends[key[0] as usize];
            order[*end as usize] = number;
            *end += 1;
        }
        let mut start = 0;
        for &end in &ends[..positions.len()] {
            order[start..end as usize].sort_unstable_by_key(|&number| (keys[number as usize], number));
            start = end as usize;
        }
        Self { positions, triangles, ranks, order }
    }

    /// By triangle its place in the order.
    pub(crate) fn places(&self) -> Vec<u32> {
        let mut places = memory::filled(0, self.order.len());
        self.order.iter().zip(0..).for_each(|(&triangle, place)| places[triangle as usize] = place);
        places
    }

    /// The corners of a triangle at the reference positions, beginning with the first in space: sums over them have the
    /// same bits however the triangle is numbered.
    pub(crate) fn corners(&self, triangle: u32) -> [Vector3<T>; 3] {
        let corners = first_rank_first(self.triangles[triangle as usize], &self.ranks);
        corners.map(|vertex| self.positions[vertex as usize])
    }
}

fn first_rank_first(corners: [u32; 3], ranks: &[u32]) -> [u32; 3] {
    let [a, b, c] = corners;
    let [of_a, of_b, of_c] = corners.map(|vertex| ranks[vertex as usize]);
    if of_a <= of_b && of_a <= of_c {
        [a, b, c]
    } else if of_b <= of_c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// How many other places come before each position's.
fn ranks<T: Scalar>(positions: &[Vector3<T>]) -> Vec<u32> {
    // Positions beside their vertices, so that sorting need not look them up.
    let mut sorted = memory::listed(positions.iter().zip(0u32..).map(|(p, vertex)| ([p.x, p.y, p.z], vertex)));
    sorted.sort_unstable_by(|(a, _), (b, _)| a.partial_cmp(b).unwrap_or(Ordering::Equal));
    let mut ranks = memory::filled(0, positions.len());
    let mut rank = 0;
    for (place, &(position, vertex)) in sorted.iter().enumerate() {
        rank += u32::from(place > 0 && sorted[place - 1].0 != position);
        ranks[vertex as usize] = rank;
    }
    ranks
}
