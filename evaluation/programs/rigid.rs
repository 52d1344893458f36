//! What a step costs where a large rigid body is moved by a pose, against the same body moved by positions.

use crate::support::arguments::Arguments;
use raycontact::contact::{ContactList, DetectionOptions};
use raycontact::math::{Pose, Vector3};
use raycontact::mesh::Mesh;
use raycontact::scene::Scene;
use std::error::Error;
use std::process::ExitCode;
use std::time::Instant;

pub const HELP: &str = "\
Times steps of a large torus that turns and a small one that stays where it is: the large one moved by rayc_scene_set_pose()
in one scene and by rayc_scene_set_positions() in another, by turns, with the same contacts. One thread, double precision,
default options. The positions are there when the clock starts.

  --vertices N      of the large body, about (default 100000)
  --steps N         how many steps of each (default 400)
  --mode MODE       paper: rays from the vertices, nothing else; default: the library's defaults (default default)
  --help            this text

Prints, for bodies apart, with boxes that overlap, that just touch and that overlap, the median times in microseconds of a
step by positions and by a pose, of a query after which nothing moved, the ratio of the two, the same of what they take
beyond the query where nothing moved, and the contacts of the last step.
Exit status: 0; 1 when contacts differ; 2 for a wrong command line.";

/// Radius of the tori's tubes; their rings have radius 1 and SMALL.
const TUBE: f64 = 0.4;
const SMALL: f64 = 0.1;
/// Poses of the large body, which repeat.
const FRAMES: usize = 4;

/// A torus with a ring of radius 1.
fn torus(rows: u32, columns: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let turn = |index: u32, count: u32| (std::f64::consts::TAU * f64::from(index) / f64::from(count)).sin_cos();
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..rows {
        for j in 0..columns {
            let ((sin_u, cos_u), (sin_v, cos_v)) = (turn(i, rows), turn(j, columns));
            let radius = 1.0 + TUBE * cos_v;
            positions.push([radius * cos_u, radius * sin_u, TUBE * sin_v]);
            let at = |i: u32, j: u32| i % rows * columns + j % columns;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    (positions, triangles)
}

/// Turned about its own axis, and about another so little that it stays where it is.
fn pose(frame: usize) -> Pose {
    let frame = frame as f64;
    let ((sin, cos), (sin_x, cos_x)) = ((0.7 + 0.01 * frame).sin_cos(), (1e-4 * frame).sin_cos());
    let rotation = [[cos, -sin, 0.0], [cos_x * sin, cos_x * cos, -sin_x], [sin_x * sin, sin_x * cos, cos_x]];
    Pose { position: [0.0, 1e-4 * frame, 0.0], rotation }
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Prints a row; false where contacts differ.
fn measure(
    name: &str,
    large: &(Vec<[f64; 3]>, Vec<[u32; 3]>),
    centre: [f64; 3],
    steps: usize,
    options: DetectionOptions<f64>,
) -> Result<bool, Box<dyn Error>> {
    let (small, triangles) = torus(40, 20);
    let small: Vec<_> = small.iter().map(|p| [0, 1, 2].map(|axis| SMALL * p[axis] + centre[axis])).collect();
    let frames: Vec<Vec<[f64; 3]>> = (0..FRAMES)
        .map(|frame| large.0.iter().map(|&point| pose(frame).moved(&Vector3::from(point)).into()).collect())
        .collect();
    let mut scenes = [Scene::new(1)?, Scene::new(1)?];
    for scene in &mut scenes {
        scene.set_options(options);
        scene.add(Mesh::new(&large.0, &large.1)?);
        scene.add(Mesh::new(&small, &triangles)?);
    }
    let mut lists = [ContactList::default(), ContactList::default()];
    let (mut times, mut stills) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
    // The first round finds out how much memory it needs.
    for step in 0..steps + FRAMES {
        for by_pose in [0, 1] {
            let (scene, list) = (&mut scenes[by_pose], &mut lists[by_pose]);
            let start = Instant::now();
            if by_pose == 1 {
                scene.set_pose(0, &pose(step % FRAMES))?;
            } else {
                scene.mesh_mut(0)?.set_positions(&frames[step % FRAMES])?;
            }
            scene.query(list);
            let time = start.elapsed().as_secs_f64() * 1e6;
            let start = Instant::now();
            scene.query(list);
            let still = start.elapsed().as_secs_f64() * 1e6;
            if step >= FRAMES {
                times[by_pose].push(time);
                stills[by_pose].push(still);
            }
        }
        if lists[0] != lists[1] {
            eprintln!("error: {name}: contacts by pose are not those by positions");
            return Ok(false);
        }
    }
    let [by_positions, by_pose] = times.each_mut().map(|times| median(times));
    let still = stills.each_mut().map(|stills| median(stills)).into_iter().fold(f64::INFINITY, f64::min);
    let (ratio, beyond) = (by_positions / by_pose, (by_positions - still) / (by_pose - still));
    println!(
        "{name}: positions {by_positions:.1} us, pose {by_pose:.1} us, still {still:.1} us, ratio {ratio:.1}, beyond a still \
         step {beyond:.1}, {} contacts",
        lists[1].len()
    );
    Ok(true)
}

pub fn main(mut arguments: Arguments) -> ExitCode {
    let vertices: u32 = arguments.value("--vertices", 100_000);
    let steps: usize = arguments.value("--steps", 400);
    let mode = arguments.value("--mode", "default".to_owned());
    if !(100..=10_000_000).contains(&vertices) || steps == 0 {
        arguments.fail("--vertices is from 100 to 10000000, --steps at least 1");
    }
    let options = match mode.as_str() {
        "default" => DetectionOptions::default(),
        "paper" => DetectionOptions::paper(),
        _ => arguments.fail(&format!("unknown mode '{mode}': paper or default")),
    };
    arguments.finish();
    let columns = (f64::from(vertices) / 2.5).sqrt() as u32;
    let large = torus(vertices / columns, columns);
    // Above the tube, whose top is a circle of radius 1.
    let places =
        [("apart", 2.0 * TUBE), ("boxes overlap", -0.01), ("just touching", TUBE + 0.039), ("overlapping", TUBE)];
    for (name, height) in places {
        let centre = if name == "boxes overlap" { [0.0, 0.0, height] } else { [0.0, 1.0, height] };
        match measure(name, &large, centre, steps, options) {
            Ok(true) => {}
            Ok(false) => return ExitCode::FAILURE,
            Err(error) => {
                eprintln!("error: {error}");
                return ExitCode::FAILURE;
            }
        }
    }
    ExitCode::SUCCESS
}
