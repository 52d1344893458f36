//! A number of steps of one workload, in the default precision of simulators: what counts instructions runs this.

use crate::support::arguments::Arguments;
use raycontact::contact::{ContactLaw, ContactList, DetectionOptions, Sampling};
use raycontact::math::Scalar;
use raycontact::mesh::Mesh;
use raycontact::scene::Scene;
use std::error::Error;
use std::process::ExitCode;

pub const HELP: &str = "\
Runs steps of detection on a workload of moving tori, for tools that count what a step costs.

  --workload NAME   stackN: N tori 40x20 in a pile; pairMxN: two tori MxN; deepN: two tori NxN/2, one turned, whose centres lie
                    a fifth of their size apart; boxes: two boxes of twelve triangles, one on the other (default stack2)
  --steps N         how many steps (default 10)
  --mode MODE       paper: rays from the vertices, nothing else; default: the library's defaults; ray-length:
                    the defaults with the paper's law; spacing:LENGTH and accuracy:PART: the defaults with such a sampling (default paper)
  --precision P     single or double, the C interface's default (default single)
  --carrier D       how far apart the unknowns of all bodies are said to be: 0 where vertices are nodes (default: not said)
  --help            this text

Prints steps=N contacts=N, the contacts of the last step.
Exit status: 0; 1 when a mesh cannot be made; 2 for a wrong command line.";

/// Radius of the tori's tubes; their rings have radius 1.
const TUBE: f64 = 0.4;

/// Where a torus lies: turned about z, then about x, then moved.
#[derive(Clone, Copy)]
struct Pose {
    about_z: f64,
    about_x: f64,
    centre: [f64; 3],
}

impl Pose {
    /// Number `k` of a pile whose neighbours overlap.
    fn stacked(k: u32) -> Self {
        let k = f64::from(k);
        let centre = [0.13 * k.sin(), 0.13 * (1.7 * k).cos(), 0.6 * k];
        Self { about_z: 0.37 * k, about_x: 0.15 * (2.1 * k).sin(), centre }
    }

    /// Number `k` of two that overlap deeply.
    fn deep(k: u32) -> Self {
        let k = f64::from(k);
        Self { about_z: 0.4 * k, about_x: 1.1 * k, centre: [0.3 * k, 0.4 * k, 0.25 * k] }
    }

    /// The lower box, or that which stands on it, aslant.
    fn on_top(k: u32) -> Self {
        let k = f64::from(k);
        Self { about_z: 0.4 * k, about_x: 0.03 * k, centre: [0.1 * k, 0.05 * k, 0.97 * k] }
    }

    fn place(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let (sin_z, cos_z) = self.about_z.sin_cos();
        let (sin_x, cos_x) = self.about_x.sin_cos();
        let [x, y] = [cos_z * x - sin_z * y, sin_z * x + cos_z * y];
        let [y, z] = [cos_x * y - sin_x * z, sin_x * y + cos_x * z];
        [x + self.centre[0], y + self.centre[1], z + self.centre[2]]
    }
}

/// A box with edges of length 1, in twelve triangles.
fn cube(pose: &Pose) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let corner = |index: u32| [0, 1, 2].map(|axis| f64::from(index >> axis & 1) - 0.5);
    // Two faces across each axis; counted the other way on the lower one.
    let face = |axis: u32, is_upper: u32| {
        let [a, b] = [1, 2].map(|next| 1 << ((axis + next) % 3));
        let first = is_upper << axis;
        let [second, fourth] = if is_upper == 1 { [a, b] } else { [b, a] };
        let third = first + a + b;
        [[first, first + second, third], [first, third, first + fourth]]
    };
    let triangles = (0..3).flat_map(|axis| [0, 1].map(|is_upper| face(axis, is_upper))).flatten().collect();
    ((0..8).map(|index| pose.place(corner(index))).collect(), triangles)
}

fn torus(pose: &Pose, rows: u32, columns: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let turn = |index: u32, count: u32| (std::f64::consts::TAU * f64::from(index) / f64::from(count)).sin_cos();
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..rows {
        for j in 0..columns {
            let ((sin_u, cos_u), (sin_v, cos_v)) = (turn(i, rows), turn(j, columns));
            let radius = 1.0 + TUBE * cos_v;
            positions.push(pose.place([radius * cos_u, radius * sin_u, TUBE * sin_v]));
            let at = |i: u32, j: u32| i % rows * columns + j % columns;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    (positions, triangles)
}

/// Where a point at rest is at a step.
fn moved<T: Scalar>([x, y, z]: [f64; 3], step: u32) -> [T; 3] {
    let height = 0.02 * (3.0 * x + 2.0 * y + 0.3 * f64::from(step)).sin() / (x * x + y * y + 0.25).sqrt();
    [x + height * y, y - height * x, z + height * 0.5].map(T::of)
}

/// The poses of the bodies, and their rows and columns; none for boxes.
fn parse(workload: &str) -> Option<(Vec<Pose>, Option<[u32; 2]>)> {
    let stacked = |count: u32| (0..count).map(Pose::stacked).collect();
    if workload == "boxes" {
        return Some(((0..2).map(Pose::on_top).collect(), None));
    }
    if let Some(count) = workload.strip_prefix("stack") {
        return Some((stacked(count.parse().ok()?), Some([40, 20])));
    }
    if let Some(rows) = workload.strip_prefix("deep") {
        let rows: u32 = rows.parse().ok()?;
        return Some(((0..2).map(Pose::deep).collect(), Some([rows, rows / 2])));
    }
    let (rows, columns) = workload.strip_prefix("pair")?.split_once('x')?;
    Some((stacked(2), Some([rows.parse().ok()?, columns.parse().ok()?])))
}

fn options<T: Scalar>(mode: &str) -> Option<DetectionOptions<T>> {
    let with = |sampling| DetectionOptions { sampling, ..DetectionOptions::default() };
    let positive =
        |number: &str| number.parse().ok().filter(|&number: &f64| number > 0.0 && number.is_finite()).map(T::of);
    match mode.split_once(':') {
        None if mode == "paper" => Some(DetectionOptions::paper()),
        None if mode == "default" => Some(DetectionOptions::default()),
        None if mode == "ray-length" => {
            Some(DetectionOptions { law: ContactLaw::RayLength, ..DetectionOptions::default() })
        }
        Some(("spacing", length)) => Some(with(Sampling::Spacing(positive(length)?))),
        Some(("accuracy", part)) => Some(with(Sampling::Accuracy(positive(part)?))),
        _ => None,
    }
}

/// Positions of all bodies at some steps, which repeat: only the library is to be counted.
const FRAMES: u32 = 4;

pub fn main(mut arguments: Arguments) -> ExitCode {
    let workload = arguments.value("--workload", "stack2".to_owned());
    let steps = arguments.value("--steps", 10);
    let mode = arguments.value("--mode", "paper".to_owned());
    let precision = arguments.value("--precision", "single".to_owned());
    let carrier: f64 = arguments.value("--carrier", f64::NAN);
    let carrier = Some(carrier).filter(|spacing| !spacing.is_nan());
    let (Some(singles), Some(doubles)) = (options::<f32>(&mode), options::<f64>(&mode)) else {
        arguments.fail(&format!("unknown mode '{mode}': paper, default, ray-length, spacing:LENGTH or accuracy:PART"))
    };
    let Some((poses, sides)) = parse(&workload) else {
        arguments.fail(&format!("unknown workload '{workload}': stackN, pairMxN, deepN or boxes"))
    };
    if !["single", "double"].contains(&precision.as_str()) {
        arguments.fail(&format!("unknown precision '{precision}': single or double"));
    }
    arguments.finish();
    let counted = match precision.as_str() {
        "double" => run(&poses, sides, steps, doubles, carrier),
        _ => run(&poses, sides, steps, singles, carrier),
    };
    match counted {
        Ok(contacts) => {
            println!("steps={steps} contacts={contacts}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Gives the number of contacts in the last step.
fn run<T: Scalar>(
    poses: &[Pose],
    sides: Option<[u32; 2]>,
    steps: u32,
    options: DetectionOptions<T>,
    carrier: Option<f64>,
) -> Result<usize, Box<dyn Error>> {
    let mut scene = Scene::<T>::new(1)?;
    scene.set_options(options);
    let mut frames = vec![Vec::new(); FRAMES as usize];
    for (body, pose) in poses.iter().enumerate() {
        let (rest, triangles) = sides.map_or_else(|| cube(pose), |[rows, columns]| torus(pose, rows, columns));
        for (step, frame) in (0..).zip(&mut frames) {
            frame.push(rest.iter().map(|&point| moved(point, step)).collect::<Vec<_>>());
        }
        let mut mesh = Mesh::new(&frames[0][body], &triangles)?;
        carrier.map_or(Ok(()), |spacing| mesh.set_carrier_spacing(T::of(spacing)))?;
        scene.add(mesh);
    }
    let mut contacts = ContactList::default();
    for step in 0..steps {
        for (body, positions) in (0..).zip(&frames[(step % FRAMES) as usize]) {
            scene.mesh_mut(body)?.set_positions(positions)?;
        }
        scene.query(&mut contacts);
    }
    Ok(contacts.len())
}
