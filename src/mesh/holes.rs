//! Holes closed over the vertices around them. A cap adds no vertex, since the host could not move it and would not know the
//! forces on it.

use super::{MeshError, Topology};
use crate::math::{Aabb, Scalar, Vector3};
use crate::memory::{self, Room};

/// The time to close a hole grows with the cube of the vertices around it; this many take about a second.
const MOST_VERTICES: usize = 1000;

/// A triangle whose area is below this part of the square of its longest side counts as none.
const LEAST_AREA: f64 = 1.0 / 1_048_576.0;

/// How much the squares of a triangle's sides count beside its area. All caps of a plane hole have the same area, and the one
/// with short sides is best.
const SIDES: f64 = 1.0 / 1_048_576.0;

/// A hole that was closed when the mesh was made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hole {
    /// The first triangle of its cap. Caps come behind the triangles that were given.
    pub first_triangle: u32,
    /// How many triangles the cap has. Their corners are the vertices around the hole, two more than triangles.
    pub triangle_count: u32,
    /// The area of the cap, as a part of the given area of the connected part that has the hole.
    pub area_share: f64,
}

/// A side of a triangle, as it runs, and the triangle.
type HalfEdge = (u32, u32, u32);

/// The triangles that close all holes of an open mesh. They may have `most` of the area of each connected part together.
pub(super) fn caps<T: Scalar>(
    topology: &Topology,
    positions: &[Vector3<T>],
    aabb: &Aabb<T>,
    most: f64,
) -> Result<(Vec<[u32; 3]>, Vec<Hole>), MeshError> {
    // In units of the mesh's size, so that no area overflows or underflows.
    let lower = aabb.lower.map(T::to_f64);
    let size = (aabb.upper.map(T::to_f64) - lower).max();
    let at = |vertex: u32| (positions[vertex as usize].map(T::to_f64) - lower) / size;
    let mut half_edges: Vec<HalfEdge> = memory::with_room(3 * topology.triangles().len());
    for (triangle, &[a, b, c]) in (0..).zip(topology.triangles()) {
        half_edges.extend([(a, b, triangle), (b, c, triangle), (c, a, triangle)]);
    }
    half_edges.sort_unstable();
    let runs = |from: u32, to: u32| half_edges.binary_search_by_key(&(from, to), |&(a, b, _)| (a, b)).is_ok();
    // The sides of the border, in the direction in which a cap runs through them.
    let mut border: Vec<HalfEdge> =
        memory::listed(half_edges.iter().filter(|&&(a, b, _)| !runs(b, a)).map(|&(a, b, triangle)| (b, a, triangle)));
    border.sort_unstable();
    check_seam(&border, at)?;
    if let Some(pair) = border.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        return Err(MeshError::HolesTouch { vertex: pair[0].0 });
    }

    let component_of = topology.component_of_triangles();
    let mut areas = memory::filled(0.0, topology.components().len());
    for (&[a, b, c], &component) in topology.triangles().iter().zip(&component_of) {
        areas[component as usize] += area(&at(a), &at(b), &at(c));
    }
    let mut shares = memory::filled(0.0, areas.len());
    let (mut triangles, mut holes) = (Vec::new(), Vec::new());
    let mut is_done = memory::filled(false, border.len());
    let mut around = Vec::new();
    for start in 0..border.len() {
        around.clear();
        let mut next = start;
        while !std::mem::replace(&mut is_done[next], true) {
            around.room_for(1).push(border[next].0);
            next = border.partition_point(|side| side.0 < border[next].1);
        }
        let [vertex, ..] = *around else { continue };
        if around.len() > MOST_VERTICES {
            return Err(MeshError::HoleTooLong { vertex, vertex_count: around.len(), most: MOST_VERTICES });
        }
        let positions = memory::listed(around.iter().map(|&vertex| at(vertex)));
        let is_edge = |i: usize, j: usize| runs(around[i], around[j]) || runs(around[j], around[i]);
        let cap = least_area(&positions, is_edge);
        let cap = cap.ok_or(MeshError::HoleNotClosed { vertex, vertex_count: around.len() })?;
        let component = component_of[border[start].2 as usize] as usize;
        let cap_area: f64 = cap.iter().map(|&[i, j, k]| area(&positions[i], &positions[j], &positions[k])).sum();
        let area_share = cap_area / areas[component];
        shares[component] += area_share;
        if shares[component] > most {
            let (vertex_count, share) = (around.len(), shares[component]);
            return Err(MeshError::HoleTooLarge { vertex, vertex_count, share, most });
        }
        let first_triangle = (topology.triangles().len() + triangles.len()) as u32;
        holes.room_for(1).push(Hole { first_triangle, triangle_count: cap.len() as u32, area_share });
        memory::append(&mut triangles, cap.iter().map(|corners| corners.map(|place| around[place])));
    }
    Ok((triangles, holes))
}

/// Vertices of the border in one place are a seam that was not welded, and no hole.
fn check_seam(border: &[HalfEdge], at: impl Fn(u32) -> Vector3<f64>) -> Result<(), MeshError> {
    let mut places: Vec<([f64; 3], u32)> = memory::listed(border.iter().map(|side| (at(side.0).into(), side.0)));
    places.sort_unstable_by(|p, q| p.partial_cmp(q).unwrap_or(std::cmp::Ordering::Equal));
    places.dedup_by_key(|place| place.1);
    let (mut first, mut count) = (None, 0);
    for together in places.chunk_by(|p, q| p.0 == q.0).filter(|together| together.len() > 1) {
        first = first.or(Some([together[0].1, together[1].1]));
        count += together.len();
    }
    first.map_or(Ok(()), |vertices| Err(MeshError::Seam { vertices, count }))
}

fn area(a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>) -> f64 {
    (b - a).cross(&(c - a)).norm() / 2.0
}

/// The triangles of least area over a loop of vertices, without a new vertex (Barequet and Sharir 1995, "Filling gaps in the
/// boundary of a polyhedron", section 3), by places in the loop. No diagonal may be an edge already, which would then have four
/// triangles. `None` where every way has such a diagonal or a triangle without area.
fn least_area(at: &[Vector3<f64>], is_edge: impl Fn(usize, usize) -> bool) -> Option<Vec<[usize; 3]>> {
    let count = at.len();
    // By two vertices of the loop, in either order, the cost of the triangles between them; and the third corner of the triangle
    // that has both.
    let mut costs = memory::filled(0.0, count * count);
    let mut thirds = memory::filled(0u32, count * count);
    for length in 2..count {
        for i in 0..count - length {
            let j = i + length;
            let mut least = f64::INFINITY;
            if length == count - 1 || !is_edge(i, j) {
                let side = (at[j] - at[i]).norm_squared();
                for k in i + 1..j {
                    let below = costs[i * count + k] + costs[j * count + k];
                    // Already dearer without its triangle.
                    if below >= least {
                        continue;
                    }
                    let (area, to_i, to_j) =
                        (area(&at[i], &at[k], &at[j]), (at[k] - at[i]).norm_squared(), (at[k] - at[j]).norm_squared());
                    let cost = below + area + SIDES * (side + to_i + to_j);
                    if area > LEAST_AREA * side.max(to_i).max(to_j) && cost < least {
                        (least, thirds[i * count + j]) = (cost, k as u32);
                    }
                }
            }
            (costs[i * count + j], costs[j * count + i]) = (least, least);
        }
    }
    if costs[count - 1] == f64::INFINITY {
        return None;
    }
    let mut triangles = memory::with_room(count - 2);
    let mut waiting = memory::with_room(count);
    waiting.push((0, count - 1));
    while let Some((i, j)) = waiting.pop() {
        if j - i > 1 {
            let k = thirds[i * count + j] as usize;
            triangles.push([i, k, j]);
            waiting.extend([(i, k), (k, j)]);
        }
    }
    Some(triangles)
}
