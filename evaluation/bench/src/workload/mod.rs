//! The bodies every method is given, and how they move.

mod deep;

pub use deep::of_files;

use crate::Vector;
use crate::shapes::Shape;

/// A body at rest: a torus of `rows` × `columns` quads, or, where these are 0, any closed surface.
pub struct Body {
    pub rest: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
    pub rows: u32,
    pub columns: u32,
    /// Radians per step about the z axis through `centre`.
    pub spin: f64,
    pub centre: [f64; 3],
}

/// How the surface ripples from step to step.
#[derive(Clone, Copy)]
pub struct Ripple {
    pub height: f64,
    pub phase_per_step: f64,
}

pub struct Workload {
    /// What [`Workload::new`] made it from.
    pub request: String,
    pub name: String,
    pub bodies: Vec<Body>,
    pub ripple: Ripple,
}

/// Ripple of the standard workloads.
const STANDARD: Ripple = Ripple { height: 0.02, phase_per_step: 0.3 };
/// Tube radius of the standard torus; its ring has radius 1.
const TUBE: f64 = 0.4;

/// The names of all workloads in the order they are measured; `full` adds those that take long.
pub fn names(full: bool) -> Vec<&'static str> {
    let quick = [
        "pair20x10",
        "stack2",
        "pair80x40",
        "pair160x80",
        "stack10",
        "stack50",
        "folded",
        "fast",
        "grazing",
        "idle",
        "deep320",
        "deepbumpy",
    ];
    let long = [
        "pair320x160",
        "pair640x320",
        "stack200",
        "stack1000",
        "deep320@0.5",
        "deep320@0.8",
        "deep320@0.95",
        "deepbumpy@0.5",
        "deepbumpy@0.8",
        "deepbumpy@0.95",
    ];
    quick.into_iter().chain(long.into_iter().filter(|_| full)).collect()
}

impl Workload {
    /// The workload of this name: `stackN`, `pairMxN`, `folded`, `fast`, `grazing`, `idle`, `deepN` or `deepbumpy`, the last
    /// two with or without `@APART`; or what [`of_files`] says.
    pub fn new(name: &str) -> Result<Self, String> {
        if let Some(deep) = deep::Deep::parse(name) {
            let request = name.to_owned();
            return Ok(Self { request, name: deep.name(), bodies: deep.bodies()?, ripple: STANDARD });
        }
        Self::of_tori(name).ok_or_else(|| format!("there is no workload '{name}'"))
    }

    fn of_tori(name: &str) -> Option<Self> {
        let stack = |count: u32| (0..count).map(|k| stacked(k, 40, 20, TUBE)).collect();
        let (bodies, ripple) = match name {
            "folded" => (vec![stacked(0, 40, 20, TUBE), stacked(1, 40, 20, 0.1)], STANDARD),
            "fast" => (spinning(stack(10)), Ripple { height: 0.05, phase_per_step: 3.0 }),
            "grazing" => (grazing(320, 160), STANDARD),
            "idle" => (vec![stacked(0, 160, 80, TUBE)], STANDARD),
            _ => {
                if let Some(count) = name.strip_prefix("stack") {
                    (stack(count.parse().ok()?), STANDARD)
                } else {
                    let (rows, columns) = name.strip_prefix("pair")?.split_once('x')?;
                    let (rows, columns) = (rows.parse().ok()?, columns.parse().ok()?);
                    ((0..2).map(|k| stacked(k, rows, columns, TUBE)).collect(), STANDARD)
                }
            }
        };
        Some(Self { request: name.to_owned(), name: name.to_owned(), bodies, ripple })
    }

    pub fn triangle_count(&self) -> usize {
        self.bodies.iter().map(|body| body.triangles.len()).sum()
    }

    /// Where a body's vertices are at a step.
    pub fn positions(&self, body: &Body, step: u32) -> impl Iterator<Item = [f64; 3]> {
        let (sin, cos) = (body.spin * f64::from(step)).sin_cos();
        let centre = body.centre;
        body.rest.iter().map(move |rest| {
            let [x, y] = [rest[0] - centre[0], rest[1] - centre[1]];
            let p = [centre[0] + cos * x - sin * y, centre[1] + sin * x + cos * y, rest[2]];
            self.ripple.moved(p, step)
        })
    }
}

impl Body {
    /// A surface, each of its points moved.
    pub fn placed(shape: Shape, place: impl Fn(&Vector) -> Vector) -> Self {
        let rest = shape.points.iter().map(|point| place(point).into()).collect();
        Self { rest, triangles: shape.triangles, rows: 0, columns: 0, spin: 0.0, centre: [0.0; 3] }
    }

    /// The standard torus around the origin.
    pub fn torus(rows: u32, columns: u32) -> Self {
        torus(rows, columns, TUBE, [0.0; 3], |p| p)
    }
}

impl Ripple {
    fn moved(&self, p: [f64; 3], step: u32) -> [f64; 3] {
        let phase = 3.0 * p[0] + 2.0 * p[1] + self.phase_per_step * f64::from(step);
        let length = (p[0] * p[0] + p[1] * p[1] + 0.25).sqrt();
        let height = self.height * phase.sin() / length;
        [p[0] + height * p[1], p[1] - height * p[0], p[2] + height * 0.5]
    }
}

/// Number `k` of a pile of tori whose neighbours overlap.
fn stacked(k: u32, rows: u32, columns: u32, tube: f64) -> Body {
    let k = f64::from(k);
    let centre = [0.13 * k.sin(), 0.13 * (1.7 * k).cos(), 0.6 * k];
    let (sin_z, cos_z) = (0.37 * k).sin_cos();
    let (sin_x, cos_x) = (0.15 * (2.1 * k).sin()).sin_cos();
    torus(rows, columns, tube, centre, |[x, y, z]| {
        let [x, y] = [cos_z * x - sin_z * y, sin_z * x + cos_z * y];
        let [y, z] = [cos_x * y - sin_x * z, sin_x * y + cos_x * z];
        [x + centre[0], y + centre[1], z + centre[2]]
    })
}

/// The same bodies, each turning against its neighbours.
fn spinning(mut bodies: Vec<Body>) -> Vec<Body> {
    for (k, body) in bodies.iter_mut().enumerate() {
        body.spin = if k % 2 == 0 { 0.3 } else { -0.3 };
    }
    bodies
}

/// Two tori side by side whose boxes share so little that 1 % of the vertices lie in both.
fn grazing(rows: u32, columns: u32) -> Vec<Body> {
    let distance = 2.0 * (1.0 + TUBE) - 0.047;
    [0.0, distance].map(|x| torus(rows, columns, TUBE, [x, 0.0, 0.0], |p| [p[0] + x, p[1], p[2]])).into()
}

fn torus(rows: u32, columns: u32, tube: f64, centre: [f64; 3], place: impl Fn([f64; 3]) -> [f64; 3]) -> Body {
    let turn = |index: u32, count: u32| (std::f64::consts::TAU * f64::from(index) / f64::from(count)).sin_cos();
    let (mut rest, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..rows {
        for j in 0..columns {
            let ((sin_u, cos_u), (sin_v, cos_v)) = (turn(i, rows), turn(j, columns));
            let radius = 1.0 + tube * cos_v;
            rest.push(place([radius * cos_u, radius * sin_u, tube * sin_v]));
            let at = |i: u32, j: u32| i % rows * columns + j % columns;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Body { rest, triangles, rows, columns, spin: 0.0, centre }
}
