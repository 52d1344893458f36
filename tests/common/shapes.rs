//! Closed surfaces for tests, in f64; each comes with points well inside it.

use raycontact::math::Scalar;
use raycontact::mesh::{Mesh, MeshError};
use std::f64::consts::TAU;

pub type Point = [f64; 3];

/// A closed, outward-oriented surface.
#[derive(Clone, Debug)]
pub struct Shape {
    pub positions: Vec<Point>,
    pub triangles: Vec<[u32; 3]>,
    /// Points inside, at a fair distance from the surface.
    pub inside: Vec<Point>,
}

impl Shape {
    /// A shape around the origin.
    fn around_origin(positions: Vec<Point>, triangles: Vec<[u32; 3]>) -> Self {
        Self { positions, triangles, inside: vec![[0.0; 3]] }
    }

    /// Every point moved by `map`, which must keep outside outside.
    pub fn map(&self, map: impl Fn(Point) -> Point) -> Self {
        let all = |points: &[Point]| points.iter().map(|&point| map(point)).collect();
        Self { positions: all(&self.positions), triangles: self.triangles.clone(), inside: all(&self.inside) }
    }

    pub fn scaled(&self, factor: f64) -> Self {
        self.map(|point| point.map(|x| x * factor))
    }

    pub fn moved(&self, by: Point) -> Self {
        self.map(|point| std::array::from_fn(|axis| point[axis] + by[axis]))
    }

    /// Turned about the axis z, then about x.
    pub fn turned(&self, about_z: f64, about_x: f64) -> Self {
        let ((sin_z, cos_z), (sin_x, cos_x)) = (about_z.sin_cos(), about_x.sin_cos());
        self.map(|[x, y, z]| {
            let (x, y) = (cos_z * x - sin_z * y, sin_z * x + cos_z * y);
            [x, cos_x * y - sin_x * z, sin_x * y + cos_x * z]
        })
    }

    /// One body of two parts that are not connected; the other's vertices and triangles come after the own.
    pub fn joined(&self, other: &Self) -> Self {
        let offset = self.positions.len() as u32;
        let mut joined = self.clone();
        joined.positions.extend(&other.positions);
        joined.triangles.extend(other.triangles.iter().map(|corners| corners.map(|vertex| vertex + offset)));
        joined.inside.extend(&other.inside);
        joined
    }

    /// The positions, rounded.
    pub fn rounded<T: Scalar>(&self) -> Vec<[T; 3]> {
        self.positions.iter().map(|point| point.map(T::of)).collect()
    }

    pub fn try_mesh<T: Scalar>(&self) -> Result<Mesh<T>, MeshError> {
        Mesh::new(&self.rounded(), &self.triangles)
    }

    pub fn mesh<T: Scalar>(&self) -> Mesh<T> {
        self.try_mesh().expect("the shape is a closed, outward surface")
    }
}

pub fn tetrahedron() -> Shape {
    let positions = vec![[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    Shape::around_origin(positions, vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
}

pub fn octahedron() -> Shape {
    let positions: Vec<Point> = (0..6).map(|i| std::array::from_fn(|axis| signed_unit(i, axis))).collect();
    let triangles = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    Shape::around_origin(positions, triangles)
}

fn signed_unit(vertex: usize, axis: usize) -> f64 {
    match (vertex / 2 == axis, vertex % 2) {
        (false, _) => 0.0,
        (true, 0) => 1.0,
        (true, _) => -1.0,
    }
}

/// The cube from −1 to 1, each face cut into `cells` × `cells` squares of two triangles.
pub fn cube(cells: usize) -> Shape {
    block([cells; 3]).map(|point| point.map(|x| x * 2.0 / cells as f64 - 1.0))
}

/// The box from (0, 0, 0) to `cells`, its faces cut into unit squares of two triangles.
pub fn block(cells: [usize; 3]) -> Shape {
    let mut builder = Builder::default();
    for axis in 0..3 {
        let (across, up) = ((axis + 1) % 3, (axis + 2) % 3);
        for (end, far) in [(0, false), (cells[axis], true)] {
            for (i, j) in (0..cells[across]).flat_map(|i| (0..cells[up]).map(move |j| (i, j))) {
                let corner = |di: usize, dj: usize| {
                    let mut point = [0.0; 3];
                    (point[axis], point[across], point[up]) = (end as f64, (i + di) as f64, (j + dj) as f64);
                    point
                };
                let quad = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                builder.quad(if far { quad } else { [quad[0], quad[3], quad[2], quad[1]] });
            }
        }
    }
    let middle = cells.map(|count| count as f64 / 2.0);
    Shape { positions: builder.positions, triangles: builder.triangles, inside: vec![middle] }
}

/// Collects triangles by the positions of their corners; equal positions become one vertex.
#[derive(Default)]
struct Builder {
    positions: Vec<Point>,
    triangles: Vec<[u32; 3]>,
}

impl Builder {
    fn vertex(&mut self, point: Point) -> u32 {
        let known = self.positions.iter().position(|&other| other == point);
        known.unwrap_or_else(|| {
            self.positions.push(point);
            self.positions.len() - 1
        }) as u32
    }

    fn quad(&mut self, corners: [Point; 4]) {
        let [a, b, c, d] = corners.map(|corner| self.vertex(corner));
        self.triangles.extend([[a, b, c], [a, c, d]]);
    }
}

pub fn icosahedron() -> Shape {
    let long = (1.0 + 5f64.sqrt()) / 2.0;
    let mut positions = Vec::new();
    for axis in 0..3 {
        for (one, other) in [(1.0, long), (-1.0, long), (1.0, -long), (-1.0, -long)] {
            let mut point = [0.0; 3];
            (point[axis], point[(axis + 1) % 3]) = (one, other);
            positions.push(unit(point));
        }
    }
    Shape::around_origin(positions.clone(), hull_of_icosahedron(&positions))
}

/// The triples of mutual nearest neighbours, outward.
fn hull_of_icosahedron(positions: &[Point]) -> Vec<[u32; 3]> {
    let is_edge = |i: usize, j: usize| dot(positions[i], positions[j]) > 0.4;
    let count = positions.len();
    let mut triangles = Vec::new();
    for (i, j) in (0..count).flat_map(|i| (i + 1..count).map(move |j| (i, j))) {
        for k in (j + 1..count).filter(|&k| is_edge(i, j) && is_edge(j, k) && is_edge(k, i)) {
            let outward = dot(cross(positions[i], positions[j]), positions[k]) > 0.0;
            triangles.push(if outward { [i, j, k] } else { [i, k, j] }.map(|vertex| vertex as u32));
        }
    }
    triangles
}

/// A unit sphere: the icosahedron with every triangle cut into four `levels` times. 20 · 4^levels triangles.
pub fn sphere(levels: usize) -> Shape {
    let mut shape = icosahedron();
    for _ in 0..levels {
        let mut builder = Builder { positions: shape.positions.clone(), triangles: Vec::new() };
        for &[a, b, c] in &shape.triangles {
            let middle = |i: u32, j: u32| {
                let (p, q) = (shape.positions[i as usize], shape.positions[j as usize]);
                // Addition commutes, so both neighbours find the same point.
                unit(std::array::from_fn(|axis| p[axis] + q[axis]))
            };
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)].map(|point| builder.vertex(point));
            builder.triangles.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        shape = Shape::around_origin(builder.positions, builder.triangles);
    }
    shape
}

/// A torus about the axis z, `around` × `across` quads of two triangles; ring radius 1, tube radius `tube`.
pub fn torus(around: usize, across: usize, tube: f64) -> Shape {
    let angle = |i: usize, count: usize| TAU * i as f64 / count as f64;
    let point = |u: f64, v: f64| {
        let out = 1.0 + tube * v.cos();
        [out * u.cos(), out * u.sin(), tube * v.sin()]
    };
    let mut positions = Vec::with_capacity(around * across);
    let mut triangles = Vec::with_capacity(2 * around * across);
    for (i, j) in (0..around).flat_map(|i| (0..across).map(move |j| (i, j))) {
        positions.push(point(angle(i, around), angle(j, across)));
        let index = |i: usize, j: usize| (i % around * across + j % across) as u32;
        let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    let inside = (0..around).map(|i| [angle(i, around).cos(), angle(i, around).sin(), 0.0]).collect();
    Shape { positions, triangles, inside }
}

/// A star: the sphere of 80 triangles with every second vertex drawn inward. Not convex, but seen whole from the
/// middle.
pub fn star() -> Shape {
    let mut shape = sphere(1);
    for point in shape.positions.iter_mut().step_by(2) {
        *point = point.map(|x| x * 0.4);
    }
    shape
}

/// Three narrow pyramids side by side, as one body: 1 high, points down at z = 0, of this half width at their bases.
pub fn spikes(half_width: f64) -> Shape {
    let quarters = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let base = quarters.map(|[x, y]| [half_width * x, half_width * y, 1.0]);
    let triangles = vec![[0, 1, 2], [0, 2, 3], [1, 0, 4], [2, 1, 4], [3, 2, 4], [0, 3, 4]];
    let positions = base.into_iter().chain([[0.0; 3]]).collect();
    let spike = Shape { positions, triangles, inside: vec![[0.0, 0.0, 0.75]] };
    let [a, b, c] = [[1.0, 0.0, 0.0], [-0.5, 0.8, 0.0], [-0.5, -0.8, 0.0]].map(|place| spike.moved(place));
    a.joined(&b).joined(&c)
}

/// Two fans around an axis: two vertices that `count` slivers share.
pub fn fan(count: usize) -> Shape {
    let turn = |k: usize| TAU * k as f64 / count as f64;
    let mut positions: Vec<Point> = (0..count).map(|k| [turn(k).cos(), turn(k).sin(), 0.0]).collect();
    positions.extend([[0.0, 0.0, 0.5], [0.0, 0.0, -0.5]]);
    let next = |k: usize| ((k + 1) % count) as u32;
    let (top, bottom) = (count as u32, count as u32 + 1);
    let triangles = (0..count).flat_map(|k| [[k as u32, next(k), top], [next(k), k as u32, bottom]]).collect();
    Shape { positions, triangles, inside: vec![[0.0; 3]] }
}

pub fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: Point, b: Point) -> Point {
    std::array::from_fn(|axis| {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        a[next] * b[last] - a[last] * b[next]
    })
}

pub fn unit(a: Point) -> Point {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}
