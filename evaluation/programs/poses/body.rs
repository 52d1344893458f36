//! Rigid bodies: a shape at rest and where it is now.

use super::proximity::Surface;
use super::shapes::{self, TORUS};
use super::tree::Tree;
use crate::random::Random;
use nalgebra::{UnitQuaternion, Vector3};
use raycontact::mesh::Mesh;

/// An edge and the two triangles that share it.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    pub vertices: [u32; 2],
    pub triangles: [u32; 2],
}

/// A shape around its centre of volume, its longest side 1.
#[derive(Debug)]
pub struct Rest {
    pub name: &'static str,
    pub positions: Vec<Vector3<f64>>,
    pub triangles: Vec<[u32; 3]>,
    pub edges: Vec<Edge>,
    pub tree: Tree,
    pub volume: f64,
    /// Of the sphere around the centre.
    pub radius: f64,
    /// Points inside, evenly spread, each with its distance to the surface.
    pub interior: Vec<(Vector3<f64>, f64)>,
    /// The radius of the torus's core circle.
    pub ring: Option<f64>,
}

impl Rest {
    /// Shape `number`, with about `vertices` vertices.
    pub fn new(number: usize, vertices: usize) -> Self {
        let surface = shapes::generate(number, vertices);
        let name = shapes::NAMES[number];
        let plain: Vec<[f64; 3]> = surface.positions.iter().map(|&p| p.into()).collect();
        let mesh = Mesh::new(&plain, &surface.triangles).unwrap_or_else(|error| panic!("{name}: {error}"));
        let volume = mesh.volume();
        let sixfold_moment = surface.triangles.iter().fold(Vector3::zeros(), |sum, triangle| {
            let [a, b, c] = triangle.map(|vertex| surface.positions[vertex as usize]);
            sum + (a + b + c) * (a.dot(&b.cross(&c)) / 4.0)
        });
        let centre = sixfold_moment / (6.0 * volume);
        let size = mesh.aabb().longest_side();
        let positions: Vec<_> = surface.positions.iter().map(|p| (p - centre) / size).collect();
        let tree = Tree::new(&positions, &surface.triangles);
        let mut rest = Self {
            name,
            edges: edges_of(&surface.triangles),
            volume: volume / size.powi(3),
            radius: positions.iter().map(|p| p.norm()).fold(0.0, f64::max),
            interior: Vec::new(),
            ring: (number == TORUS).then_some(1.0 / size),
            positions,
            triangles: surface.triangles,
            tree,
        };
        rest.interior = rest.find_interior(number);
        rest
    }

    pub fn corners(&self, triangle: u32) -> [Vector3<f64>; 3] {
        self.triangles[triangle as usize].map(|vertex| self.positions[vertex as usize])
    }

    /// The winding number of the surface around a point: the sum of the triangles' solid angles (Van Oosterom and
    /// Strackee 1983). For placing bodies; the judge is exact.
    pub fn is_inside(&self, point: &Vector3<f64>) -> bool {
        if !self.tree.bounds().holds(point) {
            return false;
        }
        let half_angles = (0..self.triangles.len() as u32).fold(0.0, |sum, triangle| {
            let [a, b, c] = self.corners(triangle).map(|corner| corner - point);
            let [la, lb, lc] = [a.norm(), b.norm(), c.norm()];
            sum + a.dot(&b.cross(&c)).atan2(la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb)
        });
        half_angles > std::f64::consts::PI
    }

    fn find_interior(&self, number: usize) -> Vec<(Vector3<f64>, f64)> {
        const COUNT: usize = 200;
        let mut random = Random::new(0x1a7e, number as u64);
        let bounds = self.tree.bounds();
        let mut points = Vec::with_capacity(COUNT);
        while points.len() < COUNT {
            let point = Vector3::from_fn(|axis, _| random.between(bounds.lower[axis], bounds.upper[axis]));
            if self.is_inside(&point) {
                let distances = (0..self.triangles.len() as u32).map(|triangle| {
                    (super::proximity::closest_on_triangle(&point, &self.corners(triangle)) - point).norm()
                });
                points.push((point, distances.fold(f64::INFINITY, f64::min)));
            }
        }
        points
    }
}

fn edges_of(triangles: &[[u32; 3]]) -> Vec<Edge> {
    let mut sides: Vec<([u32; 2], u32)> = Vec::with_capacity(triangles.len() * 3);
    for (triangle, corners) in triangles.iter().enumerate() {
        for i in 0..3 {
            let (from, to) = (corners[i], corners[(i + 1) % 3]);
            sides.push(([from.min(to), from.max(to)], triangle as u32));
        }
    }
    sides.sort_unstable();
    sides.chunks(2).map(|pair| Edge { vertices: pair[0].0, triangles: [pair[0].1, pair[1].1] }).collect()
}

/// A rest shape, scaled, turned and moved.
#[derive(Clone, Debug)]
pub struct Body<'a> {
    pub rest: &'a Rest,
    /// Its longest side, before it is turned.
    pub size: f64,
    pub rotation: UnitQuaternion<f64>,
    pub centre: Vector3<f64>,
    /// Where its vertices are, as rounded to the library's precision.
    pub positions: Vec<Vector3<f64>>,
    pub tree: Tree,
}

impl<'a> Body<'a> {
    pub fn new(rest: &'a Rest, size: f64, rotation: UnitQuaternion<f64>, centre: Vector3<f64>) -> Self {
        let (positions, tree) = (rest.positions.clone(), rest.tree.clone());
        let mut body = Self { rest, size, rotation, centre, positions, tree };
        body.place(|x| x);
        body
    }

    /// Renews the vertices, each coordinate rounded by `round`.
    pub fn place(&mut self, round: impl Fn(f64) -> f64) {
        let matrix = self.rotation.to_rotation_matrix().into_inner() * self.size;
        for (place, rest) in self.positions.iter_mut().zip(&self.rest.positions) {
            *place = (matrix * rest + self.centre).map(&round);
        }
        self.tree.refit(&self.positions, &self.rest.triangles);
    }

    pub fn to_world(&self, rest: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * rest * self.size + self.centre
    }

    pub fn to_rest(&self, world: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.inverse() * (world - self.centre) / self.size
    }

    pub fn corners(&self, triangle: u32) -> [Vector3<f64>; 3] {
        self.rest.triangles[triangle as usize].map(|vertex| self.positions[vertex as usize])
    }

    pub fn ends(&self, edge: &Edge) -> [Vector3<f64>; 2] {
        edge.vertices.map(|vertex| self.positions[vertex as usize])
    }

    pub fn radius(&self) -> f64 {
        self.rest.radius * self.size
    }
}

impl Surface for Body<'_> {
    fn size(&self) -> f64 {
        self.size
    }

    fn positions(&self) -> &[Vector3<f64>] {
        &self.positions
    }

    fn triangles(&self) -> &[[u32; 3]] {
        &self.rest.triangles
    }

    fn edges(&self) -> impl Iterator<Item = [u32; 2]> {
        self.rest.edges.iter().map(|edge| edge.vertices)
    }

    fn tree(&self) -> &Tree {
        &self.tree
    }
}
