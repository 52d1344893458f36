//! Times and errors of every setting on one scene.

use super::load::{Loads, Moment, Weights};
use super::row::Row;
use super::scene::{Scene, shortest_mean_edge};
use super::setting::{self, Setting};
use crate::clock;
use crate::host::{Frame, Host};
use crate::libraries::Libraries;
use crate::library::Whole;
use crate::measure::{frames, median};
use crate::method::{Method, Push};
use crate::oracle;
use crate::workload::{Body, Workload};
use indicatif::ProgressBar;
use raycontact::contact::{ContactLaw, DetectionOptions, Sampling};
use std::collections::BTreeSet;

const ROUNDS: u32 = 5;

/// The steps whose contacts are judged.
const JUDGED: [u32; 3] = [0, 5, 10];

/// Microseconds that a round of one setting should take: slow ones make fewer steps, but no fewer than these.
const ROUND: f64 = 4e5;
const FEWEST_STEPS: usize = 3;

/// Force errors are against the limit of a method's own law, directions against that of the first.
const LAWS: [ContactLaw; 2] = [ContactLaw::Pressure, ContactLaw::RayLength];

struct Running {
    setting: Setting,
    method: Box<dyn Method>,
    /// Time of a step over the mean of the lower bound's just before and just after, of each round.
    multiples: Vec<f64>,
}

/// What every method is held against at one step.
struct Truth {
    frame: Frame,
    /// Of each of [`LAWS`].
    limits: [Loads; 2],
    inside: Vec<[u32; 2]>,
}

/// Measures all settings on one scene, interleaved, and writes into `progress` what goes on.
pub fn run(
    scene: &Scene,
    settings: &[Setting],
    libraries: &Libraries,
    progress: &ProgressBar,
) -> Result<Vec<Row>, String> {
    let workload = &scene.workload;
    progress.set_message(format!("{}: the limit of the law", scene.name));
    let truths = truths(scene, progress)?;
    // Declared before the methods, so that they end before it.
    let mut host = Host::new(workload);
    let bound_workload = bound_workload(workload);
    let mut bound_host = Host::new(&bound_workload);
    let mut bound = libraries.peers.start(&setting::peer_of("lower-bound"), &bound_workload, &bound_host)?;
    let mut running = Vec::new();
    for &setting in settings {
        progress.set_message(format!("{}: preparing {}", scene.name, setting.method()));
        match setting.start(workload, &host, libraries) {
            Ok(method) => running.push(Running { setting, method, multiples: Vec::new() }),
            // A peer may refuse a surface.
            Err(reason) => say(progress, format!("{}: without {}: {reason}", scene.name, setting.method())),
        }
    }
    let vertices = |workload: &Workload| workload.bodies.iter().map(|body| body.rest.len()).sum::<usize>() as f64;
    let share = vertices(workload) / vertices(&bound_workload);
    for round in 0..ROUNDS {
        let frames = frames(workload, round);
        let bound_frames = self::frames(&bound_workload, round);
        let mut bound_time = || time_round(&mut bound, &mut bound_host, &bound_frames) * share;
        let mut before = bound_time();
        for running in &mut running {
            progress.set_message(format!("{}, round {}: {}", scene.name, round + 1, running.setting.method()));
            let time = time_round(running.method.as_mut(), &mut host, &frames);
            let after = bound_time();
            running.multiples.push(2.0 * time / (before + after));
            before = after;
        }
    }
    let mut rows = Vec::new();
    for running in &running {
        progress.set_message(format!("{}: judging {}", scene.name, running.setting.method()));
        rows.extend(running.judge(scene, &truths, &mut host, libraries)?);
    }
    Ok(rows)
}

/// Also where no progress is shown.
fn say(progress: &ProgressBar, text: String) {
    progress.suspend(|| eprintln!("{text}"));
}

/// Microseconds of a step: the median of those after the first third, which warms up.
fn time_round(method: &mut dyn Method, host: &mut Host, frames: &[Frame]) -> f64 {
    let mut step = |frame: &Frame| {
        host.write(frame);
        clock::time(1, || method.step(host)).0
    };
    let first = step(&frames[0]);
    let count = ((ROUND / first) as usize).clamp(FEWEST_STEPS, frames.len());
    let times: Vec<f64> = frames[1..count].iter().map(step).collect();
    let warm_up = count / 3 - 1;
    median(times[warm_up..].to_vec())
}

/// Tori with about as many vertices: the lower bound's program knows no other bodies, and only the number counts.
fn bound_workload(workload: &Workload) -> Workload {
    let torus = |body: &Body| {
        let across = ((body.rest.len() as f64 / 2.0).sqrt().round() as u32).max(3);
        Body::torus((body.rest.len() as u32 / across).max(3), across)
    };
    let ripple = workload.ripple;
    let name = "lower-bound".to_owned();
    Workload { request: name.clone(), name, bodies: workload.bodies.iter().map(torus).collect(), ripple }
}

fn truths(scene: &Scene, progress: &ProgressBar) -> Result<Vec<Truth>, String> {
    let mut host = Host::new(&scene.workload);
    let mut found: Vec<Truth> = Vec::new();
    for step in JUDGED {
        let frame = Frame::new(&scene.workload, step);
        host.write(&frame);
        let inside = oracle::inside(&scene.workload, &host);
        found.push(Truth { frame, limits: Default::default(), inside });
    }
    let inside: usize = found.iter().map(|truth| truth.inside.len()).sum::<usize>() / found.len();
    say(progress, format!("{}: {inside} vertices inside", scene.name));
    let spacings = limit_spacings(&scene.workload);
    for (number, law) in LAWS.into_iter().enumerate() {
        let [coarser, finer] = [0, 1].map(|level| {
            let workload = scene.finer.as_ref().map_or(&scene.workload, |finer| &finer[level]);
            limit_loads(workload, law, spacings[level])
        });
        let mut still = 0.0f64;
        for ((truth, finer), coarser) in found.iter_mut().zip(finer?).zip(coarser?) {
            host.write(&truth.frame);
            let limit = finer.extrapolated(&coarser);
            still = still.max(Moment::new(&scene.workload, &host).difference(&limit, &finer).force);
            truth.limits[number] = limit;
        }
        let law = setting::name_of(law);
        say(progress, format!("{}, {law}: limit known to {:.4} %", scene.name, still * 100.0));
    }
    if scene.finer.is_some() {
        for (number, law) in LAWS.into_iter().enumerate() {
            let error = surface_error(&scene.workload, number, &found, &mut host)? * 100.0;
            let law = setting::name_of(law);
            say(progress, format!("{}, {law}: the surfaces themselves are off by {error:.3} %", scene.name));
        }
    }
    Ok(found)
}

/// The force error of the triangulation, which no rays can mend: that of a law on the surfaces as they are measured.
fn surface_error(workload: &Workload, law: usize, truths: &[Truth], host: &mut Host) -> Result<f64, String> {
    let [coarser, finer] = limit_spacings(workload).map(|spacing| limit_loads(workload, LAWS[law], spacing));
    let mut sum = 0.0;
    for ((truth, coarser), finer) in truths.iter().zip(coarser?).zip(finer?) {
        host.write(&truth.frame);
        sum += Moment::new(workload, host).difference(&truth.limits[law], &finer.extrapolated(&coarser)).force;
    }
    Ok(sum / truths.len() as f64)
}

/// The distances of rays from which a limit is extrapolated, on meshes as they are measured and on finer ones alike.
fn limit_spacings(workload: &Workload) -> [f64; 2] {
    let edge = shortest_mean_edge(workload);
    [edge / 4.0, edge / 8.0]
}

/// A law at the judged steps with rays as far apart as `spacing` says, in double precision.
fn limit_loads(workload: &Workload, law: ContactLaw, spacing: f64) -> Result<Vec<Loads>, String> {
    let mut host = Host::new(workload);
    let sampling = Sampling::Spacing(spacing);
    let options = DetectionOptions { law, sampling, escape: false, ..DetectionOptions::default() };
    let mut method = Whole::<f64>::new(workload, &host, 0, options)?;
    let at_step = |step: &u32| {
        host.write(&Frame::new(workload, *step));
        method.step(&host);
        Moment::new(workload, &host).loads(&method.pushes(), Weights::Area)
    };
    Ok(JUDGED.iter().map(at_step).collect())
}

impl Running {
    fn judge(
        &self,
        scene: &Scene,
        truths: &[Truth],
        host: &mut Host,
        libraries: &Libraries,
    ) -> Result<Vec<Row>, String> {
        let setting = self.setting;
        let mut method = setting.without_escapes().start(&scene.workload, host, libraries)?;
        let weights = setting.weights();
        let mut rows: Vec<Row> = weights
            .iter()
            .map(|weights| Row {
                scene: scene.name.clone(),
                method: setting.method().to_owned(),
                settings: setting.describe(*weights),
                time_over_lower_bound: median(self.multiples.clone()),
                force_error: setting.has_comparable_force().then_some(0.0),
                recall: setting.knows_vertices().then_some(0.0),
                direction_error: 0.0,
                contacts: 0,
            })
            .collect();
        let share = 1.0 / truths.len() as f64;
        let own_law = LAWS.iter().position(|law| *law == setting.law()).expect("both laws are there");
        for truth in truths {
            host.write(&truth.frame);
            method.step(host);
            let moment = Moment::new(&scene.workload, host);
            let pushes = method.pushes();
            for (row, weights) in rows.iter_mut().zip(weights) {
                let loads = moment.loads(&pushes, *weights);
                let force = moment.difference(&truth.limits[own_law], &loads).force;
                row.force_error = row.force_error.map(|sum| sum + force * share);
                row.recall = row.recall.map(|sum| sum + recall(&truth.inside, &pushes) * share);
                row.direction_error += moment.difference(&truth.limits[0], &loads).direction * share;
                row.contacts = pushes.len();
            }
        }
        Ok(rows)
    }
}

/// The part of the vertices inside another body from which, or from a triangle of which, a contact starts.
fn recall(inside: &[[u32; 2]], pushes: &[Push]) -> f64 {
    let pushed: BTreeSet<[u32; 2]> = pushes.iter().flat_map(|push| &push.vertices).copied().collect();
    inside.iter().filter(|vertex| pushed.contains(*vertex)).count() as f64 / inside.len().max(1) as f64
}
