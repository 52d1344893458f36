//! Is the contact force right? Against closed forms, closed paths, and reference data computed by other programs.

mod closed_paths;
mod cubes_aside;
mod dense;
mod patch_test;
mod references;
mod slab;
mod steps;
mod threads;

use crate::support::Mode;
use crate::support::arguments::Arguments;
use std::process::ExitCode;

pub const HELP: &str = "\
Measures default contact forces, and those of the paper's law, against what is known of them.

  --only NAME     one case of: references, aside, steps, paths, slab, rolled, dense, threads,
                  patch (default: all)
  --poses N       random poses of each case (default 1000)
  --seed S        of the random poses (default 1)
  --help          this text

Prints CSV on standard output: case,bodies,law,median,ninety,worst; see docs/accuracy.md for what each case is.
Exit status: 0; 1 where the default law misses a target; 2 for a wrong command line.";

/// Errors of one case, as parts; not yet sorted.
pub struct Row {
    bodies: String,
    mode: Mode,
    errors: Vec<f64>,
    /// The most that the default law may have: median, ninety of a hundred, worst.
    targets: [f64; 3],
}

impl Row {
    /// Sorted errors at a part of them.
    fn quantile(&self, part: f64) -> f64 {
        self.errors[((self.errors.len() - 1) as f64 * part).round() as usize]
    }
}

/// Measures one case.
type Measure = fn(poses: usize, seed: u64) -> Vec<Row>;

const CASES: [(&str, Measure); 9] = [
    ("references", references::measure),
    ("aside", cubes_aside::measure),
    ("steps", steps::measure),
    ("paths", closed_paths::measure),
    ("slab", slab::measure),
    ("rolled", slab::measure_rolled),
    ("dense", dense::measure),
    ("threads", threads::measure),
    ("patch", patch_test::measure),
];

pub fn main(mut arguments: Arguments) -> ExitCode {
    let only: String = arguments.value("--only", String::new());
    let poses: usize = arguments.value("--poses", 1000);
    let seed: u64 = arguments.value("--seed", 1);
    if poses == 0 || !(only.is_empty() || CASES.iter().any(|(name, _)| *name == only)) {
        arguments.fail("at least one pose, and a case that exists");
    }
    arguments.finish();
    println!("case,bodies,law,median,ninety,worst");
    let mut kept = true;
    for (name, measure) in CASES.into_iter().filter(|(name, _)| only.is_empty() || *name == only) {
        for mut row in measure(poses, seed) {
            row.errors.sort_by(f64::total_cmp);
            let found = [0.5, 0.9, 1.0].map(|part| row.quantile(part));
            let [median, ninety, worst] = found;
            println!("{name},{},{},{median:.6},{ninety:.6},{worst:.6}", row.bodies, row.mode.name());
            if row.mode == Mode::Default && found.iter().zip(row.targets).any(|(found, target)| *found > target) {
                eprintln!("{name}, {}: {found:.6?} is above the target {:?}", row.bodies, row.targets);
                kept = false;
            }
        }
    }
    if kept { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
