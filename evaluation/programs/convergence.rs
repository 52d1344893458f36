//! Do contact forces depend on the mesh? Bodies on a slab against the exact overlap volume, and pairs of spheres and
//! tori against the law on the smooth surfaces, from about 500 to 50 000 triangles.

use crate::support::arguments::Arguments;
use crate::support::shapes::Shape;
use crate::support::{Mode, Vector, limits, net_force, shapes};
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use raycontact::mesh::Mesh;
use std::f64::consts::PI;
use std::process::ExitCode;

pub const HELP: &str = "\
Measures contact forces against exact answers on finer and finer meshes.

  --only NAME       one case of: ball, globe, ellipsoid, lens, spheres, tori (default: all)
  --largest N       leave out meshes of more triangles (default 50000)
  --help            this text

Prints CSV on standard output: case,mesh,mode,triangles,rays,force_error,torque_error
  mesh          exact: compared with its own volume; fitted: encloses as much as the smooth body;
                inscribed: vertices on the smooth body, so too small by the chords
  force_error   |F - F0| / |F0|; for bodies on the slab it includes the tangential part
  torque_error  |T - T0| / |T0|, empty where T0 is zero by symmetry
and the orders of convergence on standard error.
Exit status: 0; 1 where the default mode on exact and fitted meshes is above 1 % at about 1600 triangles, or where two
sizes differ by more than 2 %, the force of tori of fewer than 1500 triangles by more than 3 %; 2 for a wrong command line.";

/// One measured mesh size.
struct Row {
    triangles: usize,
    force_error: f64,
    torque_error: Option<f64>,
    /// Magnitudes over the exact ones.
    force_ratio: f64,
    torque_ratio: Option<f64>,
}

/// The sizes: parts per edge of an icosahedron; circles of a torus.
const SIZES: [(usize, usize); 5] = [(5, 24), (9, 40), (16, 72), (28, 126), (50, 224)];

pub fn main(mut arguments: Arguments) -> ExitCode {
    let only: String = arguments.value("--only", String::new());
    let largest: usize = arguments.value("--largest", 50_500);
    let cases = ["ball", "globe", "ellipsoid", "lens", "spheres", "tori"];
    if !only.is_empty() && !cases.contains(&only.as_str()) {
        arguments.fail(&format!("unknown case {only}"));
    }
    arguments.finish();
    println!("case,mesh,mode,triangles,rays,force_error,torque_error");
    let mut kept = true;
    for case in cases.into_iter().filter(|&case| only.is_empty() || only == case) {
        let meshes: &[&str] = if matches!(case, "spheres" | "tori") { &["fitted", "inscribed"] } else { &["exact"] };
        let exact = tori_limit(case);
        for mesh in meshes {
            for mode in [Mode::Vertices, Mode::Default] {
                let rows: Vec<Row> = SIZES
                    .iter()
                    .map(|&size| (size, meshes_of_size(case, mesh, size)))
                    .filter(|(_, pair)| pair[0].topology().triangles().len() <= largest)
                    .map(|(_, pair)| measure(case, mesh, mode, &pair, &exact))
                    .collect();
                kept &= judge(case, mesh, mode, &rows);
            }
        }
    }
    if kept { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn meshes_of_size(case: &str, mesh: &str, (parts, around): (usize, usize)) -> [Mesh<f64>; 2] {
    match case {
        "spheres" => spheres(parts, mesh == "fitted"),
        "tori" => tori(around, mesh == "fitted"),
        _ => on_slab(case, parts),
    }
}

fn measure(case: &str, mesh: &str, mode: Mode, pair: &[Mesh<f64>; 2], limit: &Option<(Vector, Vector)>) -> Row {
    let [a, b] = pair;
    let net = net_force(mode, a, b, &Vector::zeros());
    let exact = match (case, limit) {
        ("spheres", _) => (Vector::x() * limits::spheres(DISTANCE), None),
        (_, Some((force, torque))) => (*force, Some(*torque)),
        _ => (Vector::z() * limits::volume_below_zero(a), None),
    };
    let row = Row {
        triangles: a.topology().triangles().len(),
        force_error: (net.force - exact.0).norm() / exact.0.norm(),
        torque_error: exact.1.map(|torque| (net.torque - torque).norm() / torque.norm()),
        force_ratio: net.force.norm() / exact.0.norm(),
        torque_ratio: exact.1.map(|torque| net.torque.norm() / torque.norm()),
    };
    let torque = row.torque_error.map_or(String::new(), |error| format!("{error:.6}"));
    println!("{case},{mesh},{},{},{},{:.6},{torque}", mode.name(), row.triangles, net.rays, row.force_error);
    row
}

/// Prints the order of convergence; false where a target is missed.
fn judge(case: &str, mesh: &str, mode: Mode, rows: &[Row]) -> bool {
    let name = format!("{case} {mesh} {}", mode.name());
    let held = mode == Mode::Default && mesh != "inscribed";
    let force = rows.iter().map(|row| Some((row.triangles, row.force_error, row.force_ratio)));
    let torque = rows.iter().map(|row| Some((row.triangles, row.torque_error?, row.torque_ratio?)));
    let kinds = [("force", force.collect::<Option<Vec<_>>>()), ("torque", torque.collect())];
    let mut kept = true;
    for (kind, rows) in kinds {
        let Some(rows) = rows.filter(|rows| rows.len() > 1) else { continue };
        let spread = |least: usize| {
            let ratios = rows.iter().filter(|row| row.0 >= least).map(|row| row.2);
            ratios.clone().fold(f64::MIN, f64::max) - ratios.fold(f64::MAX, f64::min)
        };
        let [spread, of_fine] = [spread(0), spread(1500)];
        eprintln!("{name}: {kind} order {:.2}, sizes differ by {:.2} %", order(&rows), spread * 100.0);
        for (triangles, error, _) in rows.into_iter().filter(|row| held && row.0 >= 1500 && row.1 > 0.01) {
            eprintln!("{name}, {triangles} triangles: error of {kind} {error:.4} is above 0.01");
            kept = false;
        }
        // The distance to a coarse torus's faces is less than that to the smooth one, by more than its volume makes up for.
        let most = if case == "tori" && kind == "force" { 0.03 } else { 0.02 };
        if held && (spread > most || of_fine > 0.02) {
            eprintln!("{name}: {kind} differs by more than {} %, or by 2 % from 1500 triangles on", most * 100.0);
            kept = false;
        }
    }
    kept
}

/// The slope of the error over the edge length, both as logarithms, by least squares, without what is exact: triangles that
/// are cut for the overlap's sake are, in a flat face.
fn order(rows: &[(usize, f64, f64)]) -> f64 {
    let inexact = rows.iter().filter(|row| row.1 > 1e-9);
    let points: Vec<(f64, f64)> =
        inexact.map(|&(triangles, error, _)| (-0.5 * (triangles as f64).ln(), error.ln())).collect();
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
    let (above, below) = points.iter().fold((0.0, 0.0), |(a, b), p| (a + (p.0 - x) * (p.1 - y), b + (p.0 - x).powi(2)));
    above / below
}

/// A convex body, sunk less than half way into a slab of twelve triangles with its top at z = 0.
fn on_slab(case: &str, parts: usize) -> [Mesh<f64>; 2] {
    let sphere = if case == "globe" { shapes::globe(20 * parts * parts) } else { shapes::icosphere(parts) };
    let (radii, tilt, height) = match case {
        "ellipsoid" => (Vector::new(1.3, 0.9, 0.6), 0.5, 0.5),
        "lens" => (Vector::new(1.0, 1.0, 0.25), 0.1, 0.15),
        _ => (Vector::repeat(1.0), 0.5, 0.6),
    };
    let turn = shapes::turn([0.3, 1.0, 0.2], tilt);
    let body = sphere.mesh(|point| turn * point.component_mul(&radii) + Vector::new(0.013, 0.02, height));
    [body, shapes::cuboid([-5.0, -5.0, -3.0], [5.0, 5.0, 0.0]).mesh(|point| *point)]
}

/// Between the centres of the two unit spheres.
const DISTANCE: f64 = 1.5;

fn spheres(parts: usize, fitted: bool) -> [Mesh<f64>; 2] {
    let sphere = shapes::icosphere(parts);
    let factor = if fitted { (4.0 * PI / 3.0 / sphere.volume()).cbrt() } else { 1.0 };
    let sphere: Shape = sphere.scaled(factor);
    let turns = [shapes::turn([0.3, 1.0, 0.2], 0.5), shapes::turn([-0.3, 0.4, 0.7], 1.5)];
    [sphere.mesh(|point| turns[0] * point), sphere.mesh(|point| turns[1] * point + Vector::x() * DISTANCE)]
}

fn tori(around: usize, fitted: bool) -> [Mesh<f64>; 2] {
    let torus = shapes::torus(around, around / 2, limits::TUBE, fitted);
    tori_poses().map(|pose| torus.mesh(|point| pose.rotation * point + pose.translation.vector))
}

/// Two tori on one another, the upper turned, tilted and shifted to the side so that there is a moment.
fn tori_poses() -> [Isometry3<f64>; 2] {
    let turn = shapes::turn([1.0, 0.0, 0.0], 0.13) * shapes::turn([0.0, 0.0, 1.0], 0.37);
    let upper = Isometry3::from_parts(Translation3::new(0.5, -0.05, 0.55), UnitQuaternion::from_rotation_matrix(&turn));
    [Isometry3::identity(), upper]
}

fn tori_limit(case: &str) -> Option<(Vector, Vector)> {
    let [lower, upper] = &tori_poses();
    (case == "tori").then(|| limits::tori([lower, upper], &Vector::zeros(), 1000))
}
