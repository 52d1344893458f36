//! Whether the way out of a point that lies inside another part of its body leads through that other part, or only
//! through the far side of its own.
//!
//! Both look alike along a ray. But the surface around what overlaps is made of parts of either fold, and where one ends
//! and the other begins, the two cross: so two points on it belong to the same fold if the way from one to the other
//! over that surface changes the fold an even number of times.

use super::sets::Sets;
use super::touching::Touching;
use crate::math::Scalar;
use crate::memory::Room;
use crate::mesh::Topology;

/// The folds that overlap, by vertex.
#[derive(Clone, Debug, Default)]
pub(super) struct Folds {
    /// Whether a vertex belongs to a triangle that lies inside another part of the body.
    is_inside: Vec<bool>,
    /// Connected parts of the surface that lie inside.
    parts: Sets,
    /// The same, joined where they cross.
    folds: Sets,
    /// By the number that stands for a set of `folds`: whether three or more folds meet in it, so that it has no two sides.
    is_mixed: Vec<bool>,
}

impl Folds {
    /// Starts anew with a surface of which nothing lies inside.
    pub(super) fn reset(&mut self, topology: &Topology) {
        let count = topology.vertex_count();
        self.is_inside.clear();
        self.is_inside.room_for(count).resize(count, false);
        self.parts.reset(count);
        self.folds.reset(count);
        self.is_mixed.clear();
        self.is_mixed.room_for(count).resize(count, false);
    }

    /// Takes note that the surface between these vertices lies inside.
    pub(super) fn add(&mut self, vertices: [u32; 3]) {
        for vertex in vertices {
            self.is_inside[vertex as usize] = true;
            self.parts.join(vertices[0], vertex, false);
            self.folds.join(vertices[0], vertex, false);
        }
    }

    /// Joins what lies inside along edges: for samples at vertices, which name no surface between them.
    pub(super) fn join_along_edges(&mut self, topology: &Topology) {
        for edge in topology.edges() {
            if edge.vertices.iter().all(|&vertex| self.is_inside[vertex as usize]) {
                self.add([edge.vertices[0], edge.vertices[1], edge.vertices[0]]);
            }
        }
    }

    /// Joins what crosses.
    pub(super) fn join<T: Scalar>(&mut self, topology: &Topology, touching: &Touching<T>) {
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
    pub(super) fn are_one(&mut self, inside: [u32; 3], other: [u32; 3]) -> bool {
        let from = inside[0];
        let (part, (fold, side)) = (self.parts.find(from).0, self.folds.find(from));
        let is_mixed = self.is_mixed[fold as usize];
        other.into_iter().any(|vertex| {
            self.is_inside[vertex as usize]
                && (self.parts.find(vertex).0 == part || (!is_mixed && self.folds.find(vertex) == (fold, side)))
        })
    }
}
