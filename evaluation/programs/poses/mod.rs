//! The pose benchmark: do contacts free bodies from any overlap?
//!
//! `cargo run --release --example measure -- poses --count 10000 --seed 1 --mode default`, and `--help` for the rest.
//!
//! Each pose draws its bodies from a random sequence of its own ([`start`]), asks the library for contacts, or
//! [`proximity`] for repulsions, moves the bodies ([`motion`]), and is done when the [`judge`] finds them apart.

mod body;
mod failures;
mod judge;
mod motion;
mod options;
mod picture;
mod press;
mod proximity;
mod report;
mod run;
mod shapes;
mod start;
mod tree;

use crate::support::arguments::Arguments;
use body::Rest;
use indicatif::{ProgressBar, ProgressStyle};
pub use options::HELP;
use options::{Mode, Options, Precision};
use rayon::prelude::*;
use report::Pose;
use run::{Outcome, Run};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

pub fn main(arguments: Arguments) -> ExitCode {
    let options = Options::parse(arguments.parser()).unwrap_or_else(|error| arguments.fail(&error.to_string()));
    let pool = arguments.pool(options.threads);
    let numbers = options.shape.map_or(0..shapes::NAMES.len(), |number| number..number + 1);
    let make = |number| Rest::new(number, options.vertices);
    let rests: Vec<Rest> = pool.install(|| numbers.into_par_iter().map(make).collect());
    let start = Instant::now();
    if options.failures {
        let printed = pool.install(|| failures::print(&rests, &options, options.pictures.as_deref().map(Path::new)));
        eprintln!("{:.1} s", start.elapsed().as_secs_f64());
        return match printed {
            Ok(true) => ExitCode::SUCCESS,
            Ok(false) => ExitCode::FAILURE,
            Err(error) => {
                eprintln!("poses: {error}");
                ExitCode::from(2)
            }
        };
    }
    if let Some(load) = options.press {
        pool.install(|| press::print(&rests, &options, load));
        eprintln!("{:.1} s", start.elapsed().as_secs_f64());
        return ExitCode::SUCCESS;
    }
    let poses = match options.pose {
        Some(number) => vec![run_pose(&rests, &options, number, |line| println!("{line}"))],
        None => pool.install(|| run_all(&rests, &options)),
    };
    report::print(&poses);
    eprintln!("{:.1} s", start.elapsed().as_secs_f64());
    let failures = poses.len() - report::count(&poses, Outcome::Separated);
    if options.mode == Mode::Default && failures * 1000 > poses.len() { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

fn run_all(rests: &[Rest], options: &Options) -> Vec<Pose> {
    // On standard error, and only where that is a terminal.
    let progress = ProgressBar::new(options.count);
    let style = ProgressStyle::with_template("{wide_bar} {human_pos} of {human_len} poses, {eta} left");
    progress.set_style(style.expect("the template is valid"));
    let run_one = |number: u64| {
        let pose = run_pose(rests, options, number, |_| ());
        progress.inc(1);
        pose
    };
    let poses = (0..options.count).into_par_iter().map(run_one).collect();
    progress.finish_and_clear();
    poses
}

fn run_pose(rests: &[Rest], options: &Options, number: u64, mut log: impl FnMut(&str)) -> Pose {
    let start::Start { kind, mut bodies, overlap } = start::start(rests, options, number);
    let shapes: Vec<_> = bodies.iter().map(|body| body.rest.name).collect();
    log(&format!("pose {number}: {}, {}, overlap {overlap}", kind.name(), shapes.join(" and ")));
    let run: Run = match options.precision {
        Precision::F32 => run::run::<f32>(options.mode, &mut bodies, log),
        Precision::F64 => run::run::<f64>(options.mode, &mut bodies, log),
    };
    Pose { number, kind, shapes, overlap, run }
}
