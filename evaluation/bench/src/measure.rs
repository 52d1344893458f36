//! Takes the times: round by round, in each round every method in turn, so that all see the same moods of the machine.

use crate::clock;
use crate::elsewhere::Elsewhere;
use crate::host::{Frame, Host};
use crate::libraries::Libraries;
use crate::method::{C_DEFAULTS, Description, Key, Method, Precision, RUST_DEFAULTS, Stages};
use crate::oracle::Oracle;
use crate::row::Row;
use crate::workload::Workload;
use indicatif::ProgressBar;

pub const ROUNDS: u32 = 9;
const WARM_UP_STEPS: u32 = 5;
const MEASURED_STEPS: u32 = 10;

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
    libraries: &Libraries,
    progress: &ProgressBar,
) -> Result<Vec<Row>, String> {
    // Declared before the methods, so that it outlives them.
    let mut host = Host::new(workload);
    let mut running = Vec::new();
    for description in methods {
        progress.set_message(format!("{}: preparing {}", workload.name, description.name));
        if !description.can_take(workload) {
            progress.println(format!(
                "{} is left out of {}: it cannot take it, or would not end soon",
                description.name, workload.name
            ));
            progress.inc(ROUNDS.into());
            continue;
        }
        let place = match description.simd {
            Some(simd) => Place::Elsewhere(Elsewhere::start(&workload.request, simd)?),
            None => Place::Here(description.start(workload, &host, libraries)?),
        };
        running.push(Running { description: *description, place, times: Times::default() });
    }
    for round in 0..ROUNDS {
        let frames = frames(workload, round);
        for running in &mut running {
            progress.set_message(format!("{}: {}", workload.name, running.description.name));
            let times = match &mut running.place {
                Place::Here(method) => time_round(method.as_mut(), running.description.threads, &mut host, &frames),
                Place::Elsewhere(process) => process.time_round(round)?,
            };
            running.times.totals.extend(times.totals);
            running.times.stages.extend(times.stages);
            progress.inc(1);
        }
    }
    // A method elsewhere leaves this process's arrays as they were.
    host.write(frames(workload, ROUNDS - 1).last().expect("rounds have steps"));
    same_defaults(workload, &running)?;
    progress.set_message(format!("{}: testing every ray against every triangle", workload.name));
    let oracle = Oracle::new(workload, &host);
    let first = running.first().map(|running| running.times.rounds()).unwrap_or_default();
    running.into_iter().map(|running| running.row(workload, &oracle, &first)).collect()
}

/// The default options find the same contacts through the C library and from Rust.
fn same_defaults(workload: &Workload, running: &[Running]) -> Result<(), String> {
    let contacts = |name| {
        running.iter().find_map(|running| match &running.place {
            Place::Here(method)
                if running.description.name == name && running.description.precision == Precision::F64 =>
            {
                Some(method.contacts())
            }
            _ => None,
        })
    };
    match (contacts(C_DEFAULTS), contacts(RUST_DEFAULTS)) {
        (Some(c), Some(rust)) if c != rust => Err(format!("{}: other contacts from C than from Rust", workload.name)),
        _ => Ok(()),
    }
}

impl Times {
    /// The median of each round.
    fn rounds(&self) -> Vec<f64> {
        self.totals.chunks(MEASURED_STEPS as usize).map(|steps| middle(steps.to_vec())).collect()
    }

    /// The time of a step, given the rounds of the method that all are compared with: the median of the rounds' ratios,
    /// in units of its median. The machine's pace, which changes more from round to round than within one, falls out.
    fn total(&self, first: &[f64]) -> f64 {
        let ratios = self.rounds().iter().zip(first).map(|(own, first)| own / first).collect();
        hundredths(middle(ratios) * middle(first.to_vec()))
    }
}

/// The positions of a round, step by step.
pub fn frames(workload: &Workload, round: u32) -> Vec<Frame> {
    let first = round * MEASURED_STEPS;
    (first..first + WARM_UP_STEPS + MEASURED_STEPS).map(|step| Frame::new(workload, step)).collect()
}

pub fn time_round(method: &mut dyn Method, threads: u32, host: &mut Host, frames: &[Frame]) -> Times {
    let mut times = Times::default();
    for (step, frame) in frames.iter().enumerate() {
        host.write(frame);
        let (total, stages) = clock::time(threads, || method.step(host));
        if step >= WARM_UP_STEPS as usize {
            times.totals.push(total);
            times.stages.extend(stages);
        }
    }
    times
}

impl Running {
    fn row(self, workload: &Workload, oracle: &Oracle, first: &[f64]) -> Result<Row, String> {
        let contacts: Vec<Key> = match self.place {
            Place::Here(method) => method.contacts(),
            Place::Elsewhere(mut process) => process.contacts()?,
        };
        let total_us = self.times.total(first);
        let stages = self.times.stages;
        let stage = |pick: fn(&Stages) -> f64| (!stages.is_empty()).then(|| median(stages.iter().map(pick).collect()));
        let method = self.description;
        let count = contacts.len();
        let verdict = method.same_contacts.then(|| oracle.judge(contacts));
        Ok(Row {
            workload: workload.name.clone(),
            method: method.name.to_owned(),
            precision: method.precision.name().to_owned(),
            threads: method.threads,
            triangles: workload.triangle_count(),
            contacts: count,
            total_us,
            normals_us: stage(|s| s.normals),
            structure_us: stage(|s| s.structure),
            trace_us: stage(|s| s.trace),
            filter_us: stage(|s| s.filter),
            missing: verdict.map(|v| v.missing),
            spurious: verdict.map(|v| v.spurious),
            wrong_triangle: verdict.map(|v| v.wrong_triangle),
        })
    }
}

/// The median, to a hundredth.
pub fn median(values: Vec<f64>) -> f64 {
    hundredths(middle(values))
}

fn hundredths(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len().is_multiple_of(2) { (values[middle - 1] + values[middle]) / 2.0 } else { values[middle] }
}
