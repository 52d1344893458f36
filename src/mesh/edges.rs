//! Where triangles meet. Edges are found from the triangles around their ends as they are asked for: a list of all would take a
//! fifth of a mesh's memory.

use super::MeshError;
use crate::memory::{self, Room};

/// Where two triangles meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// Its ends, the smaller number first.
    pub vertices: [u32; 2],
    /// Its two triangles.
    pub triangles: [u32; 2],
}

/// What to do with edges that belong to one triangle only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Border {
    /// The surface is open, and refused.
    Refused,
    /// The surface may end there.
    Allowed,
}

/// In place of a neighbour where the surface ends.
pub(crate) const NO_TRIANGLE: u32 = u32::MAX;

/// A triangle's side, seen from its end with the smaller number: the larger end, whether the triangle runs backward through the
/// side, and the triangle. As one number they sort fastest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Side(u64);

impl Side {
    fn new(end: u32, is_backward: bool, triangle: u32) -> Self {
        // Triangles are fewer than a third of 2³².
        Self(u64::from(end) << 32 | u64::from(is_backward) << 31 | u64::from(triangle))
    }

    fn end(self) -> u32 {
        (self.0 >> 32) as u32
    }

    fn is_backward(self) -> bool {
        self.0 >> 31 & 1 == 1
    }

    fn triangle(self) -> u32 {
        self.0 as u32 & (u32::MAX >> 1)
    }
}

/// The two corners of a triangle that follow one of them, in its order.
pub(crate) fn others([a, b, c]: [u32; 3], vertex: u32) -> [u32; 2] {
    if a == vertex {
        [b, c]
    } else if b == vertex {
        [c, a]
    } else {
        [a, b]
    }
}

/// The sides of which a vertex is the smaller end, in ascending order, given the triangles around it.
pub(crate) fn list_sides(vertex: u32, triangles: &[[u32; 3]], around: &[u32], sides: &mut Vec<Side>) {
    sides.clear();
    sides.room_for(2 * around.len());
    for &triangle in around {
        let [next, last] = others(triangles[triangle as usize], vertex);
        for (end, is_backward) in [(next, false), (last, true)] {
            if end > vertex {
                sides.push(Side::new(end, is_backward, triangle));
            }
        }
    }
    sides.sort_unstable();
}

/// Checks that every edge belongs to two triangles that run through it in opposite directions, or to one at a border. Gives each
/// triangle's neighbours across its edges, in no order, with [`NO_TRIANGLE`] at a border; and whether there is a border.
pub(crate) fn check(
    triangles: &[[u32; 3]],
    around: &[u32],
    around_start: &[u32],
    border: Border,
) -> Result<(Vec<[u32; 3]>, bool), MeshError> {
    let mut is_open = false;
    let mut neighbours = memory::filled([NO_TRIANGLE; 3], triangles.len());
    let mut sides = Vec::new();
    for (vertex, ends) in (0..).zip(around_start.windows(2)) {
        list_sides(vertex, triangles, &around[ends[0] as usize..ends[1] as usize], &mut sides);
        for shared in sides.chunk_by(|s, t| s.end() == t.end()) {
            let edge = [vertex, shared[0].end()];
            match *shared {
                [s, t] if s.is_backward() == t.is_backward() => {
                    let triangles = [s, t].map(|side| side.triangle() as usize);
                    return Err(MeshError::InconsistentOrientation { triangles, edge });
                }
                [s, t] => join(&mut neighbours, [s, t].map(Side::triangle)),
                [_] if border == Border::Allowed => is_open = true,
                [side] => return Err(MeshError::Open { triangle: side.triangle() as usize, edge }),
                _ => return Err(MeshError::NonManifold { edge, triangle_count: shared.len() }),
            }
        }
    }
    Ok((neighbours, is_open))
}

/// Notes that two triangles meet.
pub(crate) fn join(neighbours: &mut [[u32; 3]], [a, b]: [u32; 2]) {
    for (from, to) in [(a, b), (b, a)] {
        let [first, second, third] = &mut neighbours[from as usize];
        // A triangle has three edges.
        let free = if *first == NO_TRIANGLE {
            first
        } else if *second == NO_TRIANGLE {
            second
        } else {
            third
        };
        *free = to;
    }
}

/// The first edge at or after `next` among a vertex's sides; moves `next` behind it.
pub(crate) fn next_edge(vertex: u32, sides: &[Side], next: &mut usize) -> Option<Edge> {
    while let Some(&[s, t]) = sides[*next..].first_chunk() {
        let is_edge = s.end() == t.end();
        *next += if is_edge { 2 } else { 1 };
        if is_edge {
            return Some(Edge { vertices: [vertex, s.end()], triangles: [s, t].map(Side::triangle) });
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::shapes;
    use std::collections::BTreeMap;

    /// Closed and with a border; vertices with few and with very many triangles around them.
    #[test]
    fn edges_are_where_two_triangles_share_two_vertices() {
        let torus = shapes::torus(12, 7, 0.4);
        let sheet = &torus.triangles[..torus.triangles.len() - 5];
        let sheet = Mesh::<f64>::open(&torus.positions, sheet).expect("it has a border");
        for mesh in [torus.mesh(), sheet, shapes::fan(400).mesh()] {
            let topology = mesh.topology();
            let mut sharing: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
            for (triangle, &[a, b, c]) in (0..).zip(topology.triangles()) {
                for [from, to] in [[a, b], [b, c], [c, a]] {
                    sharing.entry([from.min(to), from.max(to)]).or_default().push(triangle);
                }
            }
            sharing.retain(|_, triangles| triangles.len() == 2);
            let found: Vec<_> = topology.edges().collect();
            assert!(found.iter().map(|edge| edge.vertices).eq(sharing.keys().copied()));
            let sorted = |mut triangles: [u32; 2]| {
                triangles.sort();
                triangles
            };
            assert!(found.iter().map(|edge| sorted(edge.triangles)).eq(sharing.values().map(|two| [two[0], two[1]])));
            assert_eq!(topology.edge_list(), found);
            let mut sides = Vec::new();
            let mut from_each = Vec::new();
            for vertex in 0..topology.vertex_count() as u32 {
                from_each.extend(topology.edges_from(vertex, &mut sides));
            }
            assert_eq!(from_each, found);
            for (triangle, neighbours) in (0..).zip(topology.neighbours()) {
                let mut expected: Vec<u32> = found
                    .iter()
                    .filter(|edge| edge.triangles.contains(&triangle))
                    .map(|edge| edge.triangles[usize::from(edge.triangles[0] == triangle)])
                    .collect();
                expected.resize(3, NO_TRIANGLE);
                let mut neighbours = neighbours.to_vec();
                expected.sort();
                neighbours.sort();
                assert_eq!(neighbours, expected);
            }
        }
    }
}
