//! Closed triangle meshes of the shapes measured.

#[allow(clippy::duplicate_mod)] // one test has both the programs' shapes and its own
#[path = "../../../tests/common/cuboid.rs"]
mod cuboid;

use super::Vector;
use cuboid::CUBOID_FACES;
use nalgebra::{Rotation3, Unit};
use raycontact::mesh::Mesh;
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

/// Points and triangles, before they are posed.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Corners.
    pub points: Vec<Vector>,
    /// Outward triangles.
    pub triangles: Vec<[u32; 3]>,
}

impl Shape {
    /// The mesh with every point moved by `place`.
    pub fn mesh(&self, place: impl Fn(&Vector) -> Vector) -> Mesh<f64> {
        let points: Vec<[f64; 3]> = self.points.iter().map(|point| place(point).into()).collect();
        Mesh::new(&points, &self.triangles).expect("a closed, outward shape")
    }

    /// The same shape, larger.
    pub fn scaled(mut self, factor: f64) -> Self {
        self.points.iter_mut().for_each(|point| *point *= factor);
        self
    }

    /// The enclosed volume.
    pub fn volume(&self) -> f64 {
        let six_fold: f64 = self
            .triangles
            .iter()
            .map(|corners| {
                let [a, b, c] = corners.map(|corner| self.points[corner as usize]);
                a.dot(&b.cross(&c))
            })
            .sum();
        six_fold / 6.0
    }
}

/// A rotation by `angle` about `axis`, which need not be of unit length.
pub fn turn(axis: [f64; 3], angle: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Unit::new_normalize(Vector::from(axis)), angle)
}

/// A box of twelve triangles.
pub fn cuboid(lower: [f64; 3], upper: [f64; 3]) -> Shape {
    let points = (0..8).map(|i: usize| {
        let pick = |axis: usize| if i >> axis & 1 == 1 { upper[axis] } else { lower[axis] };
        Vector::new(pick(0), pick(1), pick(2))
    });
    Shape { points: points.collect(), triangles: CUBOID_FACES.to_vec() }
}

/// A cylinder of `sides` flat sides around y, corners at radius 1, y from −1 to 1, with about square pieces of side.
pub fn cylinder(sides: usize) -> Shape {
    let rings = (1.0 / (PI / sides as f64).sin()).round().max(1.0) as usize;
    let mut points = Vec::new();
    for ring in 0..=rings {
        for side in 0..sides {
            let angle = TAU * side as f64 / sides as f64;
            points.push(Vector::new(angle.sin(), 2.0 * ring as f64 / rings as f64 - 1.0, -angle.cos()));
        }
    }
    points.extend([Vector::new(0.0, -1.0, 0.0), Vector::new(0.0, 1.0, 0.0)]);
    let corner = |ring: usize, side: usize| (ring * sides + side % sides) as u32;
    let (bottom, top) = (points.len() as u32 - 2, points.len() as u32 - 1);
    let mut triangles = Vec::new();
    for side in 0..sides {
        for ring in 0..rings {
            let square =
                [corner(ring, side), corner(ring, side + 1), corner(ring + 1, side + 1), corner(ring + 1, side)];
            triangles.extend([[square[0], square[2], square[1]], [square[0], square[3], square[2]]]);
        }
        triangles.push([bottom, corner(0, side), corner(0, side + 1)]);
        triangles.push([top, corner(rings, side + 1), corner(rings, side)]);
    }
    outward(Shape { points, triangles })
}

/// The unit sphere: an icosahedron, every edge cut in `parts`; 20 · parts² triangles.
pub fn icosphere(parts: usize) -> Shape {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut base: Vec<Vector> = Vec::new();
    for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        base.extend([Vector::new(0.0, a, b), Vector::new(a, b, 0.0), Vector::new(b, 0.0, a)]);
    }
    let near = |i: usize, j: usize| (base[i] - base[j]).norm() < 2.1;
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    let mut known: HashMap<Vec<(usize, usize)>, u32> = HashMap::new();
    for (i, j, k) in (0..12).flat_map(|i| (0..i).flat_map(move |j| (0..j).map(move |k| (i, j, k)))) {
        if !(near(i, j) && near(j, k) && near(k, i)) {
            continue;
        }
        let face =
            if (base[j] - base[i]).cross(&(base[k] - base[i])).dot(&base[i]) > 0.0 { [i, j, k] } else { [i, k, j] };
        let mut corner = |u: usize, v: usize| {
            let mut name: Vec<_> = [(face[0], u), (face[1], v), (face[2], parts - u - v)].into();
            name.retain(|&(_, weight)| weight > 0);
            name.sort_unstable();
            *known.entry(name.clone()).or_insert_with(|| {
                points.push(
                    name.iter().map(|&(vertex, weight)| base[vertex] * weight as f64).sum::<Vector>().normalize(),
                );
                points.len() as u32 - 1
            })
        };
        for u in 0..parts {
            for v in 0..parts - u {
                let (a, b, c) = (corner(u, v), corner(u + 1, v), corner(u, v + 1));
                triangles.push([a, b, c]);
                if u + v + 2 <= parts {
                    triangles.push([b, corner(u + 1, v + 1), c]);
                }
            }
        }
    }
    outward(Shape { points, triangles })
}

/// The unit sphere by latitude and longitude, twice as many meridians as parallels; about `triangles` triangles.
pub fn globe(triangles: usize) -> Shape {
    let meridians = (triangles as f64).sqrt().round() as usize;
    let parallels = meridians / 2;
    let mut points = vec![-Vector::z()];
    for i in 1..parallels {
        for j in 0..meridians {
            let (tilt, turn) = (PI * i as f64 / parallels as f64, TAU * j as f64 / meridians as f64);
            points.push(Vector::new(tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), -tilt.cos()));
        }
    }
    points.push(Vector::z());
    let top = points.len() as u32 - 1;
    let corner = |i: usize, j: usize| (1 + (i - 1) * meridians + j % meridians) as u32;
    let mut triangles = Vec::new();
    for j in 0..meridians {
        triangles.push([0, corner(1, j + 1), corner(1, j)]);
        triangles.push([top, corner(parallels - 1, j), corner(parallels - 1, j + 1)]);
        for i in 1..parallels - 1 {
            triangles.push([corner(i, j), corner(i, j + 1), corner(i + 1, j + 1)]);
            triangles.push([corner(i, j), corner(i + 1, j + 1), corner(i + 1, j)]);
        }
    }
    outward(Shape { points, triangles })
}

/// A torus around z, radii 1 and `tube`, 2 · `around` · `across` triangles.
///
/// With `raised`, every vertex is lifted along its normal by the mean depth of the chords below the smooth surface
/// around it, (κᵤa² + κᵥb²) / 12 for edges a, b: mesh and smooth torus then enclose the same, patch by patch.
pub fn torus(around: usize, across: usize, tube: f64, raised: bool) -> Shape {
    let mut points = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let (u, v) = (TAU * i as f64 / around as f64, TAU * j as f64 / across as f64);
            let radius = 1.0 + tube * v.cos();
            let (a, b) = (radius * TAU / around as f64, tube * TAU / across as f64);
            let lift = if raised { (v.cos() / radius * a * a + b * b / tube) / 12.0 } else { 0.0 };
            let radius = 1.0 + (tube + lift) * v.cos();
            points.push(Vector::new(radius * u.cos(), radius * u.sin(), (tube + lift) * v.sin()));
            let corner = |i: usize, j: usize| ((i % around) * across + j % across) as u32;
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    outward(Shape { points, triangles })
}

fn outward(mut shape: Shape) -> Shape {
    if shape.volume() < 0.0 {
        shape.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    }
    shape
}
