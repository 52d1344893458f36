//! Takes the times: round by round, in each round every method in turn, so that all see the same moods of the machine.

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

struct Running {
    description: Description,
    method: Box<dyn Method>,
    totals: Vec<f64>,
    stages: Vec<Stages>,
    last_contacts: Vec<Key>,
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
        running.push(Running {
            description: *description,
            method: description.start(workload, &host, peers)?,
            totals: Vec::new(),
            stages: Vec::new(),
            last_contacts: Vec::new(),
        });
    }
    for round in 0..ROUNDS {
        let first = round * MEASURED_STEPS;
        let frames: Vec<Frame> =
            (first..first + WARM_UP_STEPS + MEASURED_STEPS).map(|step| Frame::new(workload, step)).collect();
        for running in &mut running {
            progress.set_message(format!("{}: {}", workload.name, running.description.name));
            running.round(&mut host, &frames);
            progress.inc(1);
        }
    }
    progress.set_message(format!("{}: testing every ray against every triangle", workload.name));
    let oracle = Oracle::new(workload, &host);
    Ok(running.into_iter().map(|running| running.result(workload, &oracle)).collect())
}

impl Running {
    fn round(&mut self, host: &mut Host, frames: &[Frame]) {
        for (step, frame) in frames.iter().enumerate() {
            host.write(frame);
            let start = Instant::now();
            let stages = self.method.step(host);
            let total = start.elapsed().as_secs_f64() * 1e6;
            if step >= WARM_UP_STEPS as usize {
                self.totals.push(total);
                self.stages.extend(stages);
            }
        }
        self.last_contacts = self.method.contacts();
    }

    fn result(self, workload: &Workload, oracle: &Oracle) -> Result {
        let stage = |pick: fn(&Stages) -> f64| median(self.stages.iter().map(pick).collect());
        Result {
            workload: workload.name.clone(),
            method: self.description,
            triangles: workload.triangle_count(),
            contacts: self.last_contacts.len(),
            stages: (!self.stages.is_empty()).then(|| Stages {
                normals: stage(|s| s.normals),
                structure: stage(|s| s.structure),
                trace: stage(|s| s.trace),
                filter: stage(|s| s.filter),
            }),
            total: median(self.totals),
            verdict: self.description.same_contacts.then(|| oracle.judge(self.last_contacts)),
        }
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 0 { (values[middle - 1] + values[middle]) / 2.0 } else { values[middle] }
}
