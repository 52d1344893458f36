//! Whether the way out of a point that lies inside another part of its body leads through that other part, or only
//! through the far side of its own.
//!
//! Along a ray both look alike. But the surface around the overlap consists of pieces of two folds, which cross where one piece
//! ends and the next begins. So two points on it belong to the same fold if a path between them over that surface changes
//! from fold to fold an even number of times.

use crate::math::Scalar;
use crate::memory;
use crate::mesh::Topology;
use crate::self_contact::touching::Touching;
use crate::self_contact::union_find::UnionFind;

/// The folds that overlap, by vertex.
#[derive(Clone, Debug, Default)]
pub(crate) struct Folds {
    /// Whether a vertex belongs to a triangle that lies inside another part of the body.
    is_inside: Vec<bool>,
    /// Connected parts of the surface that lie inside.
    parts: UnionFind,
    /// These parts joined where they cross; the parity tells which of two folds one belongs to.
    folds: UnionFind,
    /// Whether three or more folds meet in a set of `folds`, by the set's number. Such a set has no two sides.
    is_mixed: Vec<bool>,
}

impl Folds {
    /// Starts anew with a surface of which nothing lies inside.
    pub(crate) fn reset(&mut self, topology: &Topology) {
        let count = topology.vertex_count();
        memory::refill_with(&mut self.is_inside, false, count);
        self.parts.reset(count);
        self.folds.reset(count);
        memory::refill_with(&mut self.is_mixed, false, count);
    }

    /// Marks the surface between these vertices, which may be the same, as inside.
    pub(crate) fn add(&mut self, vertices: [u32; 3]) {
        for vertex in vertices {
            self.is_inside[vertex as usize] = true;
            self.parts.join(vertices[0], vertex, false);
            self.folds.join(vertices[0], vertex, false);
        }
    }

    /// Joins what lies inside along edges: for samples at vertices, which name no surface between them.
    pub(crate) fn join_along_edges(&mut self, topology: &Topology) {
        for edge in topology.edge_list() {
            if edge.vertices.iter().all(|&vertex| self.is_inside[vertex as usize]) {
                self.add([edge.vertices[0], edge.vertices[1], edge.vertices[0]]);
            }
        }
    }

    /// Joins the parts inside whose triangles cross.
    pub(crate) fn join<T: Scalar>(&mut self, topology: &Topology, touching: &Touching<T>) {
        for pair in &touching.pairs {
            let [a, b] = pair.map(|triangle| topology.triangles()[triangle as usize]);
            for (from, to) in a.into_iter().flat_map(|from| b.into_iter().map(move |to| (from, to))) {
                if self.is_inside[from as usize] && self.is_inside[to as usize] {
                    let (mixed_from, mixed_to) = (self.is_mixed(from), self.is_mixed(to));
                    let agrees = self.folds.join(from, to, true);
                    let (root, _) = self.folds.find(from);
                    self.is_mixed[root as usize] = mixed_from || mixed_to || !agrees;
                }
            }
        }
    }

    fn is_mixed(&mut self, vertex: u32) -> bool {
        let (root, _) = self.folds.find(vertex);
        self.is_mixed[root as usize]
    }

    /// Whether a point between the first vertices, which lies inside, and one between the second belong to one fold.
    pub(crate) fn are_one(&mut self, inside: [u32; 3], other: [u32; 3]) -> bool {
        let from = inside[0];
        let (part, (fold, side)) = (self.parts.find(from).0, self.folds.find(from));
        let is_mixed = self.is_mixed[fold as usize];
        other.into_iter().any(|vertex| {
            self.is_inside[vertex as usize]
                && (self.parts.find(vertex).0 == part || (!is_mixed && self.folds.find(vertex) == (fold, side)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::shapes;

    /// Six tetrahedra; corner 4 k and triangle 4 k are of number k, and the triangle has the corner.
    fn topology() -> Mesh<f64> {
        let one = shapes::tetrahedron();
        (1..6).fold(one.clone(), |all, k| all.joined(&one.moved([4.0 * f64::from(k), 0.0, 0.0]))).mesh()
    }

    /// The folds where these tetrahedra lie inside with their first corner, and these pairs of them cross.
    fn folds(inside: &[u32], pairs: &[[u32; 2]]) -> Folds {
        let mesh = topology();
        let mut folds = Folds::default();
        folds.reset(mesh.topology());
        inside.iter().for_each(|&number| folds.add([4 * number; 3]));
        let mut touching = Touching::<f64>::default();
        touching.pairs.extend(pairs.iter().map(|pair| pair.map(|number| 4 * number)));
        folds.join(mesh.topology(), &touching);
        folds
    }

    fn are_one(folds: &mut Folds, first: u32, second: u32) -> bool {
        folds.are_one([4 * first; 3], [4 * second; 3])
    }

    #[test]
    fn what_crosses_the_same_is_one_fold() {
        let mut found = folds(&[0, 1, 2, 3], &[[0, 1], [1, 2], [2, 3]]);
        for (first, second) in (0..4).flat_map(|first| (0..4).map(move |second| (first, second))) {
            assert_eq!(are_one(&mut found, first, second), first % 2 == second % 2, "{first}, {second}");
        }
        // Only what lies inside joins.
        let mut found = folds(&[0, 2, 3], &[[0, 1], [1, 2], [3, 2]]);
        assert!(!are_one(&mut found, 0, 2) && !are_one(&mut found, 2, 3) && !are_one(&mut found, 0, 1));
    }

    /// Three that cross each other have no two sides, nor has what crosses one of them, whichever is named first.
    #[test]
    fn three_folds_in_one_place_have_no_sides() {
        for last in [[2, 3], [3, 2], [0, 3], [3, 0]] {
            let mut found = folds(&[0, 1, 2, 3, 4, 5], &[[0, 1], [1, 2], [2, 0], last, [4, 5]]);
            for (first, second) in (0..6).flat_map(|first| (0..6).map(move |second| (first, second))) {
                assert_eq!(are_one(&mut found, first, second), first == second, "{last:?}: {first}, {second}");
            }
        }
    }

    #[test]
    fn vertices_inside_are_joined_along_edges() {
        let mesh = topology();
        let mut found = Folds::default();
        found.reset(mesh.topology());
        [0, 1, 4, 6, 7].into_iter().for_each(|vertex| found.add([vertex; 3]));
        assert!(!found.are_one([0; 3], [1; 3]));
        found.join_along_edges(mesh.topology());
        for (from, to, expected) in [(0, 1, true), (4, 6, true), (6, 7, true), (0, 4, false), (0, 2, false)] {
            assert_eq!(found.are_one([from; 3], [to; 3]), expected, "{from}, {to}");
        }
    }
}
