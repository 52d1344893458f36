//! Contacts of a body with itself: what they cost a body that touches nothing of itself, and whether the rays that are
//! left out would have found anything.

use crate::support::Vector;
use crate::support::arguments::Arguments;
use crate::support::shapes::{self, Shape};
use indicatif::{ProgressBar, ProgressStyle};
use raycontact::contact::{ContactList, DetectionOptions, query_self_with_all_rays};
use raycontact::mesh::{Mesh, read_obj_file};
use raycontact::query::Octree;
use raycontact::scene::Scene;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

pub const HELP: &str = "\
Measures what self-collision costs a body that touches nothing of itself, as a part of casting every ray; and compares
the contacts of a folding body, step by step, with those found by casting every ray.

  --steps N         steps compared (default 100000)
  --seed S          seed of their motion (default 1)
  --idle-steps N    steps timed for each size, after 5 to warm up (default 50)
  --sizes LIST      tori timed: comma-separated numbers of quads around the ring, half as many across (default 40,160)
  --motions LIST    which of the motions below (default 1,2)
  --file PATH       a Wavefront .obj file instead of tori, closed; brought to the origin, and to a length of 2
  --help            this text

Prints a line for each surface and motion: the time of a scene query with self-collision on, as a part of that of an octree
update and every ray, timed in turns; means over the steps, each the median of 5 runs. The motions:
  1  standard: a ripple of height 0.02 on a ring of radius 1, moving by 0.3 radians a step
  2  tenth: a tenth of its height
  3  strong: five times its height
  4  turning: standard, and the whole turns by 0.1 radians a step
  5  sheet: pressed flat, so that the layers lie 0.01 apart, and bent by a wave that moves by 0.3 radians a step
  6  touching: pinched until two sides pass through each other, with the standard ripple
Last line: steps=N touching=… contacts=… different=…
Targets: at most 0.05 for motion 1, 0.02 for motion 2.
Exit status: 0; 1 where a step differs, or the file is not a closed surface; 2 for a wrong command line.";

pub fn main(mut arguments: Arguments) -> ExitCode {
    let steps: u64 = arguments.value("--steps", 100_000);
    let seed: u64 = arguments.value("--seed", 1);
    let idle_steps: usize = arguments.value("--idle-steps", 50);
    let sizes = arguments.list("--sizes", &[40, 160]);
    let motions = arguments.list("--motions", &[1, 2]);
    if sizes.iter().any(|&size| size < 6) || idle_steps == 0 || motions.iter().any(|m| !(1..=6).contains(m)) {
        arguments.fail("at least 6 quads around, and 1 step; motions 1 to 6");
    }
    let path: String = arguments.value("--file", String::new());
    arguments.finish();
    let surfaces: Vec<(String, Shape)> = if path.is_empty() {
        let torus = |&size: &usize| (format!("{size}x{}", size / 2), shapes::torus(size, size / 2, 0.4, false));
        sizes.iter().map(torus).collect()
    } else {
        match file(&path) {
            Ok(surface) => vec![surface],
            Err(error) => {
                eprintln!("error: {error}");
                return ExitCode::FAILURE;
            }
        }
    };
    println!("surface      motion    ratio    all rays/us");
    for (surface, shape) in &surfaces {
        for &motion in &motions {
            let (name, motion) = MOTIONS[motion - 1];
            let (ratio, whole) = idle_ratio(shape, motion, idle_steps);
            println!("{surface:12} {name:9} {ratio:.5} {:11.0}", whole.as_secs_f64() * 1e6);
        }
    }
    if compare(steps, seed) == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// The surface of a file, by its name.
fn file(path: &str) -> Result<(String, Shape), String> {
    let (positions, triangles) = read_obj_file(Path::new(path)).map_err(|error| error.to_string())?;
    let mesh = Mesh::<f64>::new(&positions, &triangles).map_err(|error| format!("{path}: {error}"))?;
    let (centre, half) = (mesh.aabb().centre(), mesh.aabb().longest_side() / 2.0);
    let points = mesh.positions().iter().map(|point| (point - centre) / half).collect();
    let name = Path::new(path).file_name().map_or(path.into(), |name| name.to_string_lossy().into_owned());
    Ok((name, Shape { points, triangles }))
}

/// Where a point of the surface is at a step.
type Motion = fn(&Vector, f64) -> Vector;

const MOTIONS: [(&str, Motion); 6] = [
    ("standard", |p, step| rippled(p, 0.02, step)),
    ("tenth", |p, step| rippled(p, 0.002, step)),
    ("strong", |p, step| rippled(p, 0.1, step)),
    ("turning", |p, step| {
        let (sine, cosine) = (0.1 * step).sin_cos();
        let p = rippled(p, 0.02, step);
        Vector::new(p.x, cosine * p.y - sine * p.z, sine * p.y + cosine * p.z)
    }),
    ("sheet", |p, step| Vector::new(p.x, p.y, p.z * 0.0125 + 0.1 * (3.0 * p.x + 0.3 * step).sin())),
    ("touching", |p, step| {
        let p = rippled(p, 0.02, step);
        Vector::new(p.x, p.y * (1.0 - (-4.0 * p.x * p.x).exp() * 0.8 / p.y.hypot(0.3)), p.z)
    }),
];

fn rippled(p: &Vector, height: f64, step: f64) -> Vector {
    p + Vector::new(p.y, -p.x, 0.5).normalize() * height * (3.0 * p.x + 2.0 * p.y + 0.3 * step).sin()
}

/// The scene's mean time as a part of that of every ray, and the latter: of each step the median of several runs.
fn idle_ratio(shape: &Shape, motion: Motion, steps: usize) -> (f64, Duration) {
    const RUNS: usize = 5;
    let runs: Vec<Vec<[Duration; 2]>> = (0..RUNS).map(|_| idle_run(shape, motion, steps)).collect();
    let mean = |which: usize| {
        let median = |step: usize| {
            let mut times: Vec<Duration> = runs.iter().map(|run| run[step][which]).collect();
            times.sort();
            times[RUNS / 2]
        };
        // Most steps may cost next to nothing, and a few pay for them.
        (0..steps).map(median).sum::<Duration>() / steps as u32
    };
    (mean(0).as_secs_f64() / mean(1).as_secs_f64(), mean(1))
}

/// The times of each step: scene, every ray.
fn idle_run(shape: &Shape, motion: Motion, steps: usize) -> Vec<[Duration; 2]> {
    const WARM_UP: usize = 5;
    let mut mesh = shape.mesh(|point| *point);
    let mut octree = Octree::new(&mesh);
    let mut scene = Scene::new(1).expect("no threads are needed");
    let body = scene.add(mesh.clone());
    scene.set_self_collision(body, true).expect("it was added");
    let options = DetectionOptions::default();
    let (mut culled, mut all) = (ContactList::default(), ContactList::default());
    let mut times = Vec::new();
    for step in 0..steps + WARM_UP {
        let positions: Vec<[f64; 3]> = shape.points.iter().map(|p| motion(p, step as f64).into()).collect();
        mesh.set_positions(&positions).expect("finite");
        scene.mesh_mut(body).expect("it was added").set_positions(&positions).expect("finite");
        let start = Instant::now();
        scene.query(&mut culled);
        let part = start.elapsed();
        let start = Instant::now();
        octree.update(&mesh).expect("its own");
        query_self_with_all_rays(&mesh, &octree, &options, &mut all).expect("up to date");
        times.push([part, start.elapsed()]);
        assert!(culled.contacts == all.contacts, "contacts are those of every ray");
    }
    times.split_off(WARM_UP)
}

/// A tube that wanders through waves at random, now and then through itself: gives the steps on which the scene's
/// contacts are not those of every ray.
fn compare(steps: u64, seed: u64) -> u64 {
    let shape = shapes::torus(24, 8, 0.2, false);
    let mut mesh: Mesh<f64> = shape.mesh(|point| *point);
    let mut octree = Octree::new(&mesh);
    let mut scene = Scene::new(1).expect("no threads are needed");
    let body = scene.add(mesh.clone());
    scene.set_self_collision(body, true).expect("it was added");
    let options = DetectionOptions::default();
    let (mut culled, mut all) = (ContactList::default(), ContactList::default());
    let mut random = crate::support::random(seed);
    let mut waves = [[0.0f64; 4]; 6];
    let (mut different, mut touching, mut contacts) = (0, 0, 0);
    let progress = ProgressBar::new(steps);
    progress.set_style(
        ProgressStyle::with_template("{bar:40} {pos}/{len} steps, {eta} left").expect("the template is valid"),
    );
    for step in 0..steps {
        // Long calm stretches, so that what is remembered counts, and wild ones.
        let pace = if step / 200 % 2 == 0 { 0.002 } else { 0.05 };
        for number in waves.as_flattened_mut() {
            *number = (*number + pace * random()).clamp(-1.0, 1.0);
        }
        let moved = |p: &Vector| {
            let mut at = *p;
            for (k, [height, x, y, z]) in waves.iter().enumerate() {
                let phase = (1.0 + k as f64) * (p.x * x + p.y * y + p.z * z);
                at[k % 3] += height * (phase * 2.0).sin() * 0.8;
            }
            at
        };
        let positions: Vec<[f64; 3]> = shape.points.iter().map(|p| moved(p).into()).collect();
        mesh.set_positions(&positions).expect("finite");
        scene.mesh_mut(body).expect("it was added").set_positions(&positions).expect("finite");
        scene.query(&mut culled);
        octree.update(&mesh).expect("its own");
        query_self_with_all_rays(&mesh, &octree, &options, &mut all).expect("up to date");
        different += u64::from(culled.contacts != all.contacts);
        touching += u64::from(!all.is_empty());
        contacts += all.len() as u64;
        progress.inc(1);
    }
    progress.finish_and_clear();
    println!("steps={steps} touching={touching} contacts={contacts} different={different}");
    different
}
