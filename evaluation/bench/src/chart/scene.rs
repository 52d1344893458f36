//! The scenes of the chart: each as it is measured, and finer, for the limit of the law on the smooth shapes.

use crate::Vector;
use crate::shapes::{self, Shape};
use crate::surfaces::{bumpy, read, stems};
use crate::workload::{Body, Ripple, Workload};
use std::path::PathBuf;

/// Ripple of all scenes, in their units.
const RIPPLE: Ripple = Ripple { height: 0.02, phase_per_step: 0.3 };
const TUBE: f64 = 0.4;

pub struct Scene {
    pub name: String,
    /// As it is measured.
    pub workload: Workload,
    /// What stands for the smooth shapes, each with half the edges of the one before. Without them the surface is the shape.
    pub finer: Option<[Workload; 2]>,
}

/// The scenes that are generated.
pub const NAMES: [&str; 6] = ["deep-tori", "stack", "grazing", "spike", "resolution", "bumpy"];
/// The scene of two surfaces from files.
pub const GIVEN: &str = "given";

impl Scene {
    /// One of [`NAMES`], or [`GIVEN`], which is called after its two files.
    pub fn new(name: &str, files: &[PathBuf]) -> Result<Self, String> {
        let workload =
            |name: &str, bodies| Workload { request: name.to_owned(), name: name.to_owned(), bodies, ripple: RIPPLE };
        if name == GIVEN || name == "bumpy" {
            let (name, shapes) = if name == GIVEN {
                let [first, second] = files else { return Err("the scene 'given' needs two files".to_owned()) };
                (stems([first, second]), [read(first)?, read(second)?])
            } else {
                (name.to_owned(), [bumpy(5.0, 30), bumpy(3.0, 36)])
            };
            let [first, second] = shapes;
            let workload = workload(&name, pair(first, second, [0.6, 0.25, 0.9]));
            return Ok(Self { name, workload, finer: None });
        }
        let bodies: fn(usize) -> Vec<Body> = match name {
            "deep-tori" => |finer| pair(torus(160 * finer), torus(160 * finer), [0.25, 0.1, 0.3]),
            "stack" => |finer| (0..10).map(|k| stacked(k, 40 * finer)).collect(),
            "grazing" => |finer| pair(torus(160 * finer), torus(160 * finer), [2.0 * (1.0 + TUBE) - 0.047, 0.0, 0.0]),
            "spike" => spike_in_ball,
            "resolution" => fine_in_coarse,
            _ => return Err(format!("there is no scene '{name}'; there are {} and {GIVEN}", NAMES.join(", "))),
        };
        let finer = Some([2, 4].map(|finer| workload(name, bodies(finer))));
        Ok(Self { name: name.to_owned(), workload: workload(name, bodies(1)), finer })
    }
}

/// Of the body with the shortest edges: their mean length.
pub fn shortest_mean_edge(workload: &Workload) -> f64 {
    let of_body = |body: &Body| {
        let lengths = body.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).map(|ends| {
            let [from, to] = ends.map(|vertex| Vector::from(body.rest[vertex as usize]));
            (to - from).norm()
        });
        lengths.sum::<f64>() / (3 * body.triangles.len()) as f64
    };
    workload.bodies.iter().map(of_body).fold(f64::INFINITY, f64::min)
}

fn pair(first: Shape, second: Shape, shift: [f64; 3]) -> Vec<Body> {
    let shift = Vector::from(shift);
    vec![Body::placed(first, |point| *point), Body::placed(second, |point| point + shift)]
}

/// Encloses as much as the smooth torus.
fn torus(around: usize) -> Shape {
    shapes::torus(around, around / 2, TUBE, true)
}

/// As the measuring program's pile.
fn stacked(k: u32, around: usize) -> Body {
    let k = f64::from(k);
    let centre = Vector::new(0.13 * k.sin(), 0.13 * (1.7 * k).cos(), 0.6 * k);
    let turn = shapes::turn([1.0, 0.0, 0.0], 0.15 * (2.1 * k).sin()) * shapes::turn([0.0, 0.0, 1.0], 0.37 * k);
    Body::placed(torus(around), |point| turn * point + centre)
}

/// A unit sphere of 20 · parts² triangles that encloses as much as the smooth one.
fn ball(parts: usize) -> Shape {
    let sphere = shapes::icosphere(parts);
    let factor = (4.0 * std::f64::consts::PI / 3.0 / sphere.volume()).cbrt();
    sphere.scaled(factor)
}

/// A thorn whose sides meet in a cusp, its tip 0.7 deep in a ball.
fn spike_in_ball(finer: usize) -> Vec<Body> {
    let tilt = shapes::turn([0.3, 1.0, 0.0], 0.4);
    let thorn = Body::placed(shapes::icosphere(24 * finer), |p| {
        let width = 0.15 * (1.0 + p.z);
        tilt * (Vector::new(p.x * width, p.y * width, p.z) + Vector::new(0.1, 0.05, 1.3))
    });
    vec![thorn, Body::placed(ball(40 * finer), |point| *point)]
}

/// A fine ball sunk into a slab whose triangles' sides are a hundred times as long as its own.
fn fine_in_coarse(finer: usize) -> Vec<Body> {
    let fine = Body::placed(ball(28 * finer), |point| point + Vector::new(0.013, 0.02, 0.6));
    // Its faces stay; finer pieces only follow the ripple more closely.
    vec![fine, Body::placed(shapes::cuboid([-2.2, -2.1, -4.0], [2.1, 2.2, 0.0]), |point| *point)]
}
