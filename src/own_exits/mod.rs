//! The shortest ways out of a body that overlaps itself.
//!
//! A vertex lies inside another part of its body if the surface winds around the point just under it more than once. The
//! shortest way out of that other part ends at the nearest point of its surface. No volume mesh is needed to tell that surface
//! from the vertex' own. Around the vertex its own surface lies inside the other part and is no way out; where it comes out
//! again, the other part's surface is nearer. So the end is the nearest point of all the surface but the part inside around the
//! vertex. Chen, Diaz and Yuksel 2023, "Shortest path to boundary for self-intersecting meshes", find the same through
//! tetrahedra.

mod inside;
mod region_growing;

use crate::math::{Scalar, Vector3};
use crate::memory::{self, Room};
use crate::mesh::{Mesh, Topology};
use crate::own_exits::inside::Inside;
use crate::own_exits::region_growing::{OUTSIDE, RegionGrowing};
use crate::query::{Octree, OctreeError, Tracer};
use crate::triangle::ClosestPoint;
use std::fmt;

/// A vertex inside another part of its body, and the way out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnExit<T: Scalar> {
    /// The vertex.
    pub vertex: u32,
    /// Where its shortest way out ends; `None` where every triangle belongs to the part inside around the vertex.
    pub exit: Option<ClosestPoint<T>>,
}

/// The vertices of a body that lie inside another part of it, with their ways out, and the memory that finding them takes: to
/// be kept, so that a steady step allocates nothing.
///
/// ```
/// use raycontact::{mesh::Mesh, own_exits::OwnExits, query::Octree};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // One mesh of two unit cubes, the second shifted by (0.8, 0.1, 0.2): a corner of each lies inside the other.
/// let corner = |i: usize, by: [f64; 3]| [0, 1, 2].map(|axis| (i >> axis & 1) as f64 + by[axis]);
/// let positions: Vec<_> = (0..16).map(|i| corner(i % 8, if i < 8 { [0.0; 3] } else { [0.8, 0.1, 0.2] })).collect();
/// let faces: [[u32; 3]; 12] = [
///     [0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4],
///     [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5],
/// ];
/// let triangles: Vec<_> = (0..24).map(|i| faces[i % 12].map(|vertex| vertex + if i < 12 { 0 } else { 8 })).collect();
/// let mesh = Mesh::new(&positions, &triangles)?;
/// let octree = Octree::new(&mesh);
/// let mut own_exits = OwnExits::default();
/// let found = own_exits.find(&mesh, &octree)?;
/// assert_eq!(found.iter().map(|exit| exit.vertex).collect::<Vec<_>>(), [7, 8]);
/// let exit = found[0].exit.expect("there is another part");
/// assert!((exit.distance - 0.1).abs() < 1e-12 && (exit.position.y - 1.1).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, Default)]
pub struct OwnExits<T: Scalar> {
    exits: Vec<OwnExit<T>>,
    inside: Inside<T>,
    /// By vertex the part inside that it belongs to, or [`OUTSIDE`].
    parts: Vec<u32>,
    /// For each vertex inside, its part and its place in the tree: sorted, neighbours of a part are together.
    places: Vec<[u32; 2]>,
    waiting: Vec<u32>,
    points: Vec<Vector3<T>>,
    bounds: Vec<T>,
    found: Vec<Option<ClosestPoint<T>>>,
    growing: RegionGrowing<T>,
}

/// Why there are no own exits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OwnExitsError {
    /// The octree does not belong to the mesh, or is stale.
    Octree(OctreeError),
    /// The mesh is open, and so has no inside.
    Open,
}

impl fmt::Display for OwnExitsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Octree(error) => error.fmt(f),
            Self::Open => write!(f, "the mesh is open, so it has no inside; close it"),
        }
    }
}

impl std::error::Error for OwnExitsError {}

impl From<OctreeError> for OwnExitsError {
    fn from(error: OctreeError) -> Self {
        Self::Octree(error)
    }
}

/// The part of a vertex inside that is yet to be numbered.
const UNNUMBERED: u32 = u32::MAX - 1;

impl<T: Scalar> OwnExits<T> {
    /// Finds the vertices with a winding number above 1 just under them, in ascending order. A vertex' part are the vertices
    /// inside that are connected with it along edges. Its exit is the nearest point of the surface without the triangles that
    /// have a vertex of the part. Where that point also lies on such a triangle, the surface goes on there into the part. The
    /// part then grows by the vertices around it until the point does not.
    ///
    /// Vertices without a normal have no side, and are left out. Where a body lies in itself all around, as a ring of two full
    /// turns, everything is one part, and the exit may not be the shortest. The time grows with the number of vertices, and with
    /// how many sheets lie above one another.
    ///
    /// # Errors
    /// [`OwnExitsError`]; what was found before is then gone.
    pub fn find(&mut self, mesh: &Mesh<T>, octree: &Octree<T>) -> Result<&[OwnExit<T>], OwnExitsError> {
        self.exits.clear();
        let tracer = octree.tracer(mesh)?;
        if mesh.is_open() {
            return Err(OwnExitsError::Open);
        }
        let topology = mesh.topology();
        memory::refill_with(&mut self.parts, OUTSIDE, topology.vertex_count());
        self.places.clear();
        let places = self.inside.find(&tracer).iter().map(|&place| [UNNUMBERED, place]);
        memory::append(&mut self.places, places);
        self.number_parts(topology);
        self.find_exits(&tracer);
        Ok(&self.exits)
    }

    /// What was found last.
    pub fn exits(&self) -> &[OwnExit<T>] {
        &self.exits
    }

    /// Numbers the parts inside, and sorts what lies inside by them.
    fn number_parts(&mut self, topology: &Topology) {
        let Self { inside, parts, places, waiting, .. } = self;
        for &[_, place] in places.iter() {
            parts[inside.vertex_at(place) as usize] = UNNUMBERED;
        }
        let mut count = 0;
        for [part, place] in places.iter_mut() {
            let vertex = inside.vertex_at(*place);
            if parts[vertex as usize] == UNNUMBERED {
                parts[vertex as usize] = count;
                waiting.room_for(1).push(vertex);
                flood(topology, parts, waiting);
                count += 1;
            }
            *part = parts[vertex as usize];
        }
        places.sort_unstable();
    }

    fn find_exits(&mut self, tracer: &Tracer<'_, T>) {
        let Self { exits, inside, parts, places, points, bounds, found, growing, .. } = self;
        let vertices = places.iter().map(|&[_, place]| inside.vertex_at(place));
        memory::refill(points, vertices.clone().map(|vertex| tracer.mesh().position(vertex)));
        memory::refill_with(bounds, T::INFINITY, points.len());
        memory::refill_with(found, None, points.len());
        let mut first = 0;
        for part in places.chunk_by(|[a, _], [b, _]| a == b) {
            let range = first..first + part.len();
            first = range.end;
            let (points, bounds, found) = (&points[range.clone()], &bounds[range.clone()], &mut found[range]);
            tracer.closest_points_beyond((parts, part[0][0]), points, bounds, found);
            growing.ask_again(tracer, parts, part[0][0], points, found);
        }
        memory::append(exits, vertices.zip(found.iter()).map(|(vertex, &exit)| OwnExit { vertex, exit }));
        exits.sort_unstable_by_key(|exit| exit.vertex);
    }
}

/// Gives the vertices that are connected with the waiting ones along edges, and are yet to be numbered, their number.
fn flood(topology: &Topology, parts: &mut [u32], waiting: &mut Vec<u32>) {
    while let Some(vertex) = waiting.pop() {
        for &other in topology.ring(vertex) {
            if parts[other as usize] == UNNUMBERED {
                parts[other as usize] = parts[vertex as usize];
                waiting.room_for(1).push(other);
            }
        }
    }
}
