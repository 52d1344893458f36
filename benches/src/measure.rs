//! Takes the times: round by round, in each round every method in turn, so that all see the same moods of the machine.

use crate::elsewhere::Elsewhere;
use crate::host::{Frame, Host};
use crate::method::{Description, Key, Method, Stages};
use crate::oracle::{Oracle, Verdict};
use crate::peer;
use crate::workload::Workload;
use indicatif::ProgressBar;
use std::time::Instant;

pub const ROUNDS: u32 = 5;
const WARM_UP_STEPS: u32 = 5;
const MEASURED_STEPS: u32 = 10;

/// Medians over the measured steps.
pub struct Result {
    pub workload: String,
    pub method: Description,
    pub triangles: usize,
    pub contacts: usize,
    pub total: f64,
    pub stages: Option<Stages>,
    pub verdict: Option<Verdict>,
}

/// Microseconds of each measured step.
#[derive(Default)]
pub struct Times {
    pub totals: Vec<f64>,
    pub stages: Vec<Stages>,
}

struct Running {
    description: Description,
    place: Place,
    times: Times,
}

enum Place {
    Here(Box<dyn Method>),
    Elsewhere(Elsewhere),
}

/// Measures all methods on one workload.
pub fn run(
    workload: &Workload,
    methods: &[Description],
    peers: &peer::Library,
    progress: &ProgressBar,
) -> std::result::Result<Vec<Result>, String> {
    // Declared before the methods, so that it outlives them.
    let mut host = Host::new(workload);
    let mut running = Vec::new();
    for description in methods {
        progress.set_message(format!("{}: preparing {}", workload.name, description.name));
        let place = match description.simd {
            Some(simd) => Place::Elsewhere(Elsewhere::start(&workload.name, simd)?),
            None => Place::Here(description.start(workload, &host, peers)?),
        };
        running.push(Running { description: *description, place, times: Times::default() });
    }
    for round in 0..ROUNDS {
        let frames = frames(workload, round);
        for running in &mut running {
            progress.set_message(format!("{}: {}", workload.name, running.description.name));
            let times = match &mut running.place {
                Place::Here(method) => time_round(method.as_mut(), &mut host, &frames),
                Place::Elsewhere(process) => process.time_round(round)?,
            };
            running.times.totals.extend(times.totals);
            running.times.stages.extend(times.stages);
            progress.inc(1);
        }
    }
    progress.set_message(format!("{}: testing every ray against every triangle", workload.name));
    let oracle = Oracle::new(workload, &host);
    running.into_iter().map(|running| running.result(workload, &oracle)).collect()
}

/// The positions of a round, step by step.
pub fn frames(workload: &Workload, round: u32) -> Vec<Frame> {
    let first = round * MEASURED_STEPS;
    (first..first + WARM_UP_STEPS + MEASURED_STEPS).map(|step| Frame::new(workload, step)).collect()
}

pub fn time_round(method: &mut dyn Method, host: &mut Host, frames: &[Frame]) -> Times {
    let mut times = Times::default();
    for (step, frame) in frames.iter().enumerate() {
        host.write(frame);
        let start = Instant::now();
        let stages = method.step(host);
        let total = start.elapsed().as_secs_f64() * 1e6;
        if step >= WARM_UP_STEPS as usize {
            times.totals.push(total);
            times.stages.extend(stages);
        }
    }
    times
}

impl Running {
    fn result(self, workload: &Workload, oracle: &Oracle) -> std::result::Result<Result, String> {
        let contacts: Vec<Key> = match self.place {
            Place::Here(method) => method.contacts(),
            Place::Elsewhere(mut process) => process.contacts()?,
        };
        let Times { totals, stages } = self.times;
        let stage = |pick: fn(&Stages) -> f64| median(stages.iter().map(pick).collect());
        Ok(Result {
            workload: workload.name.clone(),
            method: self.description,
            triangles: workload.triangle_count(),
            contacts: contacts.len(),
            stages: (!stages.is_empty()).then(|| Stages {
                normals: stage(|s| s.normals),
                structure: stage(|s| s.structure),
                trace: stage(|s| s.trace),
                filter: stage(|s| s.filter),
            }),
            total: median(totals),
            verdict: self.description.same_contacts.then(|| oracle.judge(contacts)),
        })
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len().is_multiple_of(2) { (values[middle - 1] + values[middle]) / 2.0 } else { values[middle] }
}
