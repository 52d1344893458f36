//! A triangle beside a part inside may lie partly inside too, where the other part's surface passes between its vertices. It is
//! as near as that surface, but no way out. It is recognised by its nearest point, which lies on the border of the part; the
//! part then grows over it.

use crate::math::{Scalar, Vector3};
use crate::memory::{self, Room};
use crate::mesh::Topology;
use crate::query::Tracer;
use crate::triangle::ClosestPoint;

/// The part of a vertex that is not inside.
pub(crate) const OUTSIDE: u32 = u32::MAX;

/// A part inside that grows over the surface, and the points whose nearest point beyond it is sought; scratch memory for both.
#[derive(Clone, Debug, Default)]
pub(crate) struct RegionGrowing<T: Scalar> {
    /// For each vertex [`PART`] if it belongs to the part, else [`OUTSIDE`].
    parts: Vec<u32>,
    vertices: Vec<u32>,
    /// Where in `vertices` those begin that joined last.
    newest: usize,
    /// The indices of the points to be searched for again.
    places: Vec<u32>,
    points: Vec<Vector3<T>>,
    bounds: Vec<T>,
    found: Vec<Option<ClosestPoint<T>>>,
}

const PART: u32 = 0;

impl<T: Scalar> RegionGrowing<T> {
    /// Searches again for each of a part's points whose nearest point lies on the border of the part.
    pub(crate) fn ask_again(
        &mut self,
        tracer: &Tracer<'_, T>,
        parts: &[u32],
        part: u32,
        points: &[Vector3<T>],
        found: &mut [Option<ClosestPoint<T>>],
    ) {
        let topology = tracer.mesh().topology();
        self.places.clear();
        let again = (0..).zip(found.iter()).filter(|(_, found)| is_on_border(topology, parts, part, found));
        memory::append(&mut self.places, again.map(|(place, _)| place));
        if self.places.is_empty() {
            return;
        }
        memory::refill(&mut self.parts, parts.iter().map(|&own| if own == part { PART } else { OUTSIDE }));
        self.vertices.clear();
        let own = topology.surface_vertices().iter().filter(|&&vertex| parts[vertex as usize] == part);
        memory::append(&mut self.vertices, own.copied());
        self.newest = 0;
        while !self.places.is_empty() {
            self.grow(topology);
            let Self { parts, places, points: some, bounds, found: answers, .. } = self;
            memory::refill(some, places.iter().map(|&place| points[place as usize]));
            memory::refill_with(bounds, T::INFINITY, some.len());
            memory::refill_with(answers, None, some.len());
            tracer.closest_points_beyond((parts, PART), some, bounds, answers);
            for (place, answer) in places.iter().zip(answers.iter()) {
                found[*place as usize] = *answer;
            }
            places.retain(|&place| is_on_border(topology, parts, PART, &found[place as usize]));
        }
    }

    /// The part grows by the vertices around it.
    fn grow(&mut self, topology: &Topology) {
        let last = self.vertices.len();
        for place in self.newest..last {
            for &other in topology.ring(self.vertices[place]) {
                if self.parts[other as usize] != PART {
                    self.parts[other as usize] = PART;
                    self.vertices.room_for(1).push(other);
                }
            }
        }
        self.newest = last;
    }
}

/// Whether a point found on a triangle without a vertex of the part also lies on a triangle with one.
fn is_on_border<T: Scalar>(topology: &Topology, parts: &[u32], part: u32, point: &Option<ClosestPoint<T>>) -> bool {
    let Some(point) = point else { return false };
    let corners = topology.triangles()[point.triangle as usize];
    let holds_it = |triangle: &[u32; 3]| {
        (0..3).all(|corner| point.weights[corner] == T::zero() || triangle.contains(&corners[corner]))
    };
    let has_it = |triangle: &[u32; 3]| triangle.iter().any(|&vertex| parts[vertex as usize] == part);
    let Some(first) = (0..3).find(|&corner| point.weights[corner] != T::zero()) else { return false };
    let around = topology.triangles_around(corners[first]).iter();
    around
        .map(|&triangle| &topology.triangles()[triangle as usize])
        .any(|triangle| holds_it(triangle) && has_it(triangle))
}
