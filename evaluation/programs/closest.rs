//! What a query for the nearest point of a surface costs.

use crate::support::arguments::Arguments;
use crate::support::{random, shapes};
use raycontact::math::{Scalar, Vector3};
use raycontact::mesh::{Mesh, read_obj_file};
use raycontact::query::{Octree, Tracer};
use raycontact::triangle::ClosestPoint;
use std::f64::consts::TAU;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

pub const HELP: &str = "\
Times queries for the nearest point of a surface: points inside a cube of 12 triangles, shallow and deep ones inside
tori, in patches of 16 neighbours as far apart as the mesh's vertices.

  --rounds N   how often each workload is timed, all in turn (default 9)
  --points N   points of each workload (default 4096)
  --file PATH  a Wavefront .obj file too: points below its vertices, by 1 % of its size
  --seed S     seed of the points (default 1)
  --help       this text

Prints a line for each workload and precision: the median over the rounds of the nanoseconds for a point, asked one by
one, many at a time, and many at a time with a bound half as far again as the answer; and by testing every triangle.
Exit status: 0; 1 where answers differ, or the file is not a closed surface; 2 for a wrong command line.";

/// A mesh, and points in patches of 16.
struct Workload {
    name: String,
    positions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    points: Vec<[f64; 3]>,
}

const TUBE: f64 = 0.4;
const PATCH: usize = 4;

/// Patches of points: `place` is told where each patch lies, three numbers in [0, 1), and where in it the point.
fn patches(
    count: usize,
    random: &mut impl FnMut() -> f64,
    place: impl Fn([f64; 3], [f64; 2]) -> [f64; 3],
) -> Vec<[f64; 3]> {
    let mut points = Vec::new();
    while points.len() < count {
        let patch = [(); 3].map(|()| (random() + 1.0) / 2.0);
        for i in 0..PATCH * PATCH {
            points.push(place(patch, [(i % PATCH) as f64, (i / PATCH) as f64]));
        }
    }
    points
}

fn cube(count: usize, random: &mut impl FnMut() -> f64) -> Workload {
    let shape = shapes::cuboid([0.0; 3], [1.0; 3]);
    let place = |[x, y, z]: [f64; 3], [i, j]: [f64; 2]| [0.9 * x + 0.03 * i, 0.9 * y + 0.03 * j, 0.98 * z + 0.01];
    let positions = shape.points.iter().map(|&point| point.into()).collect();
    let points = patches(count, random, place);
    Workload { name: "cube 12".to_owned(), positions, triangles: shape.triangles, points }
}

/// Points between two depths below the surface of a torus, in parts of the tube's radius.
fn torus(sides: [usize; 2], depths: [f64; 2], name: &str, count: usize, random: &mut impl FnMut() -> f64) -> Workload {
    let [around, across] = sides;
    let shape = shapes::torus(around, across, TUBE, false);
    let place = |[first, second, depth]: [f64; 3], [i, j]: [f64; 2]| {
        let (u, v) = (TAU * (first + i / around as f64), TAU * (second + j / across as f64));
        let tube = TUBE * (1.0 - depths[0] - depth * (depths[1] - depths[0]));
        let radius = 1.0 + tube * v.cos();
        [radius * u.cos(), radius * u.sin(), tube * v.sin()]
    };
    let positions = shape.points.iter().map(|&point| point.into()).collect();
    let name = format!("torus {around}x{across} {name}");
    Workload { name, positions, triangles: shape.triangles, points: patches(count, random, place) }
}

/// Points below the vertices, in the order in which the file has them.
fn file(path: &str, count: usize) -> Result<Workload, String> {
    let (positions, triangles) = read_obj_file(Path::new(path)).map_err(|error| error.to_string())?;
    let mesh = Mesh::<f64>::new(&positions, &triangles).map_err(|error| format!("{path}: {error}"))?;
    let depth = 0.01 * mesh.aabb().longest_side();
    let below = |&vertex: &u32| {
        let around = mesh.topology().triangles_around(vertex);
        let normal: Vector3<f64> = around.iter().map(|&triangle| mesh.scaled_normal(triangle)).sum();
        (mesh.positions()[vertex as usize] - normal.normalize() * depth).into()
    };
    let vertices = mesh.topology().surface_vertices();
    // Runs of vertices that follow one another, from all over the file.
    let runs = vertices.chunks(PATCH * PATCH).step_by((vertices.len() / count).max(1));
    let points = runs.flatten().map(below).collect();
    let name = Path::new(path).file_name().map_or(path.into(), |name| name.to_string_lossy().into_owned());
    Ok(Workload { name, positions, triangles, points })
}

/// A workload in one precision, made ready.
struct Ready<T: Scalar> {
    name: String,
    mesh: Mesh<T>,
    octree: Octree<T>,
    points: Vec<Vector3<T>>,
    endless: Vec<T>,
    bounds: Vec<T>,
    found: Vec<Option<ClosestPoint<T>>>,
    /// Nanoseconds for a point, round by round, by way of asking.
    times: [Vec<f64>; 4],
}

impl<T: Scalar> Ready<T> {
    fn new(workload: &Workload) -> Result<Self, String> {
        let positions: Vec<_> = workload.positions.iter().map(|point| point.map(T::of)).collect();
        let mesh = Mesh::new(&positions, &workload.triangles).map_err(|error| error.to_string())?;
        let octree = Octree::new(&mesh);
        let points: Vec<Vector3<T>> = workload.points.iter().map(|point| point.map(T::of).into()).collect();
        let endless = vec![T::INFINITY; points.len()];
        let name = format!("{} {}", workload.name, if size_of::<T>() == 4 { "f32" } else { "f64" });
        Ok(Self {
            name,
            mesh,
            octree,
            points,
            bounds: endless.clone(),
            endless,
            found: Vec::new(),
            times: Default::default(),
        })
    }

    /// One round; gives whether all answers are those of testing every triangle.
    fn run(&mut self) -> bool {
        let Self { mesh, octree, points, endless, bounds, found, times, .. } = self;
        let tracer: Tracer<'_, T> = octree.tracer(mesh).expect("it is new");
        let time = |start: Instant, count: usize| start.elapsed().as_secs_f64() * 1e9 / count as f64;
        // Slow, and hardly worth waiting for.
        let few = &points[..points.len().min(64)];
        let start = Instant::now();
        let of_all: Vec<_> = few.iter().map(|point| tracer.closest_point_of_all(point, T::INFINITY)).collect();
        times[3].push(time(start, few.len()));
        let start = Instant::now();
        let one_by_one: Vec<_> = points.iter().map(|point| tracer.closest_point(point, T::INFINITY)).collect();
        times[0].push(time(start, points.len()));
        let start = Instant::now();
        tracer.closest_points(points, endless, found);
        times[1].push(time(start, points.len()));
        let mut are_right = one_by_one[..few.len()] == of_all && *found == one_by_one;
        let half_again = T::of(1.5);
        let bound = |found: &Option<ClosestPoint<T>>| found.map_or(T::zero(), |found| found.distance * half_again);
        *bounds = found.iter().map(bound).collect();
        let start = Instant::now();
        tracer.closest_points(points, bounds, found);
        times[2].push(time(start, points.len()));
        are_right &= *found == one_by_one;
        are_right
    }

    fn print(&mut self) {
        let [one, many, bounded, all] = self.times.each_mut().map(|times| {
            times.sort_by(f64::total_cmp);
            times[times.len() / 2]
        });
        let triangles = self.mesh.topology().triangles().len();
        println!(
            "{:<26} {triangles:>8} triangles {one:>8.0} {many:>8.0} {bounded:>8.0} ns; testing all {all:.0}",
            self.name
        );
    }
}

pub fn main(mut arguments: Arguments) -> ExitCode {
    let (rounds, count) = (arguments.value("--rounds", 9usize).max(1), arguments.value("--points", 4096usize).max(16));
    let (path, seed) = (arguments.value("--file", String::new()), arguments.value("--seed", 1));
    arguments.finish();
    match run(rounds, count, &path, seed) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(rounds: usize, count: usize, path: &str, seed: u64) -> Result<(), String> {
    let random = &mut random(seed);
    let mut workloads = vec![
        cube(count, random),
        torus([40, 20], [0.02, 0.2], "shallow", count, random),
        torus([40, 20], [0.5, 1.0], "deep", count, random),
        torus([160, 80], [0.02, 0.2], "shallow", count, random),
        torus([160, 80], [0.5, 1.0], "deep", count, random),
    ];
    if !path.is_empty() {
        workloads.push(file(path, count)?);
    }
    let mut singles = workloads.iter().map(Ready::<f32>::new).collect::<Result<Vec<_>, _>>()?;
    let mut doubles = workloads.iter().map(Ready::<f64>::new).collect::<Result<Vec<_>, _>>()?;
    for _ in 0..rounds {
        let right = singles.iter_mut().all(Ready::run) && doubles.iter_mut().all(Ready::run);
        if !right {
            return Err("answers differ from those of testing every triangle".to_owned());
        }
    }
    println!("{:<46} one by one     many  bounded", "");
    singles.iter_mut().for_each(Ready::print);
    doubles.iter_mut().for_each(Ready::print);
    Ok(())
}
