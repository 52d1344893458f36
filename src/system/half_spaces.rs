//! Half-spaces, and the rows of the bodies that reach into them.

use super::Material;
use super::anchors::AnchorPoint;
use super::body::Body;
use super::loads::Surface;
use super::row_builder::{Draft, End, Ends, RowBuilder};
use super::twist::V3;
use crate::math::{Aabb, Scalar, direction};
use crate::memory::{self, Room};
use crate::mesh::Mesh;

/// Vertices make rows of their own if each node carries fewer of them than this: they may part from the plane one by one.
const FEWEST_OF_NODE: f64 = 4.0;
/// A patch is at most this fraction of the flat surface around it, which may be all that a body stands on.
const LARGEST_FRACTION: f64 = 0.25;

/// A floor or wall: solid where normal · x < offset.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HalfSpace {
    pub(super) normal: V3,
    pub(super) offset: f64,
    pub(super) material: Material,
}

/// What of some bodies lies below a half-space's plane.
#[derive(Debug, Default)]
pub(super) struct Below<T: Scalar> {
    /// Of each vertex of a body: its depth, the area that it stands for, seen along the normal, and which way that faces.
    vertices: Vec<(f64, f64, V3)>,
    /// The triangles with a corner below, each with its patch.
    triangles: Vec<(u32, u32)>,
    /// The vertices and patches that press, body by body.
    pressed: Vec<Pressed>,
    /// The vertices that bear the patches' loads, with their weights.
    bearing: Vec<(u32, T)>,
    /// How many bodies are deeper than half their thickness.
    pub(super) deep_bodies: u64,
}

/// A vertex or a patch that a half-space presses on.
#[derive(Debug)]
struct Pressed {
    /// The index of its body.
    body: usize,
    /// A vertex's number, or that of a patch's middle triangle.
    name: u32,
    depth: f64,
    area: f64,
    facing: V3,
    /// The end of its bearing vertices, which begin where those before end. A vertex has none but itself.
    bearing_end: usize,
}

impl<T: Scalar> Below<T> {
    /// Finds the triangles, and the depths of all vertices.
    fn find(&mut self, half_space: &HalfSpace, body: &Body<T>, mesh: &Mesh<T>) {
        let depth = |&position: &[T; 3]| half_space.offset - half_space.normal.dot(&V3::from(position.map(T::to_f64)));
        memory::refill(&mut self.vertices, body.positions.iter().map(|position| (depth(position), 0.0, V3::zeros())));
        let Self { vertices, triangles, .. } = self;
        triangles.clear();
        let is_below = |vertex: &u32| vertices[*vertex as usize].0 > 0.0;
        for vertex in (0..vertices.len() as u32).filter(is_below) {
            for &triangle in mesh.topology().triangles_around(vertex) {
                // Each comes with the first of its corners below.
                if mesh.topology().triangles()[triangle as usize].iter().find(|corner| is_below(corner))
                    == Some(&vertex)
                {
                    triangles.room_for(1).push((0, triangle));
                }
            }
        }
        triangles.sort_unstable();
    }

    /// Divides a triangle's area among its corners.
    fn add_area(&mut self, half_space: &HalfSpace, body: &Body<T>, corners: [u32; 3]) {
        let [a, b, c] = corners.map(|vertex| V3::from(body.positions[vertex as usize].map(T::to_f64)));
        let outward = (b - a).cross(&(c - a));
        let sixth = -half_space.normal.dot(&outward) / 6.0;
        // The sides of what stands on the plane face it as little as they press on it.
        let facing = direction(&outward).unwrap_or_default() * sixth.max(0.0);
        for vertex in corners {
            let (_, area, faces) = &mut self.vertices[vertex as usize];
            (*area, *faces) = (*area + sixth, *faces + facing);
        }
    }

    /// Per stiffness, the energy of what of a body lies below, where no pressure is larger than at the depth `cap`.
    pub(super) fn energy(&mut self, half_space: &HalfSpace, body: &Body<T>, mesh: &Mesh<T>, cap: f64) -> f64 {
        self.find(half_space, body, mesh);
        for index in 0..self.triangles.len() {
            let corners = mesh.topology().triangles()[self.triangles[index].1 as usize];
            self.add_area(half_space, body, corners);
        }
        let pressed = (0..self.vertices.len() as u32).filter_map(|vertex| self.pressed(vertex));
        pressed.map(|(depth, area, _)| area * depth.min(cap) * (depth - 0.5 * depth.min(cap))).sum()
    }

    /// The depth and the area of a vertex that bears a load, and which way that faces.
    fn pressed(&self, vertex: u32) -> Option<(f64, f64, V3)> {
        let (depth, area, facing) = self.vertices[vertex as usize];
        (depth > 0.0 && area > 0.0).then_some((depth, area, facing))
    }

    pub(super) fn clear(&mut self) {
        self.pressed.clear();
        self.bearing.clear();
        self.deep_bodies = 0;
    }

    /// Finds what presses on one body. Each surface vertex below the plane bears the pressure of its depth over the area that it
    /// stands for, seen along the normal. Where nodes are much further apart than vertices, and the step looks ahead, the
    /// vertices of a patch bear it together, with weights by their areas.
    pub(super) fn find_pressed(
        &mut self,
        half_space: &HalfSpace,
        (index, body): (usize, &Body<T>),
        mesh: &Mesh<T>,
        looks_ahead: bool,
    ) {
        let normal = half_space.normal;
        let Aabb { lower, upper } = mesh.aabb();
        let deepest = V3::from_fn(|axis, _| if normal[axis] > 0.0 { lower[axis] } else { upper[axis] }.to_f64());
        if !body.is_movable() || normal.dot(&deepest) >= half_space.offset {
            return;
        }
        self.find(half_space, body, mesh);
        let half_thickness = mesh.half_thickness().to_f64();
        self.deep_bodies += u64::from(self.vertices.iter().any(|&(depth, ..)| depth > half_thickness));
        let all = mesh.topology().triangles();
        let (spacing, vertices) = (mesh.carrier_spacing().to_f64(), mesh.topology().surface_vertices());
        let of_nodes = mesh.roundness().area / (spacing * spacing);
        // A patch's stretch follows the predicted motion, and without one only points tell how far a spring is stretched.
        if (vertices.len() as f64) < of_nodes * FEWEST_OF_NODE || !looks_ahead {
            for index in 0..self.triangles.len() {
                self.add_area(half_space, body, all[self.triangles[index].1 as usize]);
            }
            for &name in vertices {
                if let Some((depth, area, facing)) = self.pressed(name) {
                    let bearing_end = self.bearing.len();
                    self.pressed.room_for(1).push(Pressed { body: index, name, depth, area, facing, bearing_end });
                }
            }
            return;
        }
        // Patches are the same in each step, so that friction finds again what it holds on to.
        let (patches, largest, fraction) = (mesh.patches(), T::of(spacing * spacing), T::of(LARGEST_FRACTION));
        let patch_of = |triangle: u32| patches.part_around(triangle, largest, fraction);
        self.triangles.iter_mut().for_each(|(patch, triangle)| *patch = patch_of(*triangle));
        self.triangles.sort_unstable();
        let (mut start, mut end) = (0, 0);
        while let Some(&(patch, _)) = self.triangles.get(start) {
            while let Some(&(_, triangle)) = self.triangles.get(end).filter(|of_triangle| of_triangle.0 == patch) {
                self.add_area(half_space, body, all[triangle as usize]);
                end += 1;
            }
            let bearing_begin = self.bearing.len();
            let (mut load, mut area, mut facing) = (0.0, 0.0, V3::zeros());
            for of_patch in start..end {
                for vertex in all[self.triangles[of_patch].1 as usize] {
                    if let Some((depth, own, faces)) = self.pressed(vertex) {
                        self.bearing.room_for(1).push((vertex, T::of(own)));
                        (load, area, facing) = (load + depth * own, area + own, facing + faces);
                    }
                    (self.vertices[vertex as usize].1, self.vertices[vertex as usize].2) = (0.0, V3::zeros());
                }
            }
            start = end;
            if area > 0.0 {
                self.bearing[bearing_begin..].iter_mut().for_each(|(_, weight)| *weight /= T::of(area));
                let (name, depth, bearing_end) = (patches.middle(patch), load / area, self.bearing.len());
                self.pressed.room_for(1).push(Pressed { body: index, name, depth, area, facing, bearing_end });
            }
        }
    }
}

impl<T: Scalar> RowBuilder<'_, T> {
    /// Adds a row for each vertex and patch that is pressed.
    pub(super) fn add_half_space_rows(&mut self, (number, half_space): (u32, &HalfSpace), below: &Below<T>) {
        let (normal, mut bearing_begin) = (half_space.normal, 0);
        for &Pressed { body, name, depth, area, facing, bearing_end } in &below.pressed {
            let body = &self.bodies[body];
            let bearing = &below.bearing[bearing_begin..bearing_end];
            bearing_begin = bearing_end;
            let vertex = AnchorPoint { vertices: [name; 3], weights: [1.0, 0.0, 0.0], height: 0.0 };
            let (at, on) = if bearing.is_empty() { (vertex, None) } else { (AnchorPoint::NOWHERE, Some(bearing)) };
            let end = End { at: &at, on };
            let mut ends = Ends::default();
            let begin = self.rows.entries.len();
            self.add_end(&mut ends, 0, body, &end, None, &end.point_ahead(body));
            ends.leaning = -self.velocity_before(begin, &ends.rigid[0]);
            let key = (body.number, Surface::HalfSpace(number));
            let lean = normal + direction(&facing).unwrap_or_default();
            let draft = Draft { key, direction: normal, depth, cos_alpha: 1.0, area, pushes: normal, lean };
            let pair = self.pair(key, Some(&half_space.material));
            self.finish(draft, pair, ends, Some((name, at, None)));
        }
    }
}
