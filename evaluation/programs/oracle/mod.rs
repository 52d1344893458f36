//! The oracle: does every ray hit what exact arithmetic says it hits?
//!
//! `cargo run --release --example measure -- oracle --queries 1e6 --seed 1`, and `--help` for the rest.
//!
//! A query is one ray in one precision. It goes to both octree layouts, alone and among many, and is tested against
//! every triangle; all answers must agree to the bit, and then be *right*, which the [`judge`] decides. What right
//! means, in rounding units (2⁻²⁴ in f32, 2⁻⁵³ in f64) of the reach, the largest coordinate difference between the
//! ray's origin and the triangle:
//!
//! * a crossing that passes the nearest edge at more than 16 is found, from its side, and nothing behind it is reported;
//! * around an edge or vertex nearer than that, any of the triangles there may be hit, but one of them is, unless the
//!   surface folds back there so that the ray only touches it ([`judge`] argues why 16);
//! * no triangle is hit that the ray passes at more than 16;
//! * `origin + t · direction` and the weighted corners are one point to within 32, axis by axis ([`verdict::POINT_ERROR`]
//!   argues why 32). For a ray that crosses the triangle steeply that bounds `t` itself; for a grazing one it is all
//!   that can be asked, since there a small shift of the ray is a large shift of `t`;
//! * a ray that starts inside hits something.
//!
//! Each batch also asks for the nearest points of its mesh ([`nearest`]).
//!
//! Every batch of 256 rays has a mesh and random numbers of its own, so that the result depends on the seed alone.

mod cases;
mod distance;
mod exact;
mod judge;
mod nearest;
mod options;
mod points;
mod query;
mod range;
mod report;
mod tally;
mod verdict;

use crate::support::arguments::Arguments;
use cases::Case;
use indicatif::{ProgressBar, ProgressStyle};
pub use options::HELP;
use options::Options;
use query::{BATCH_SIZE, run_batch};
use rayon::prelude::*;
use std::process::ExitCode;
use std::time::Instant;
use tally::Tally;

pub fn main(arguments: Arguments) -> ExitCode {
    let options = Options::parse(arguments.parser()).unwrap_or_else(|error| arguments.fail(&error.to_string()));
    let pool = arguments.pool(options.threads);
    let start = Instant::now();
    let tally = pool.install(|| run(&options));
    print(&tally, &options, start.elapsed().as_secs_f64());
    if tally.faults() == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn run(options: &Options) -> Tally {
    // On standard error, and only where that is a terminal.
    let progress = ProgressBar::new(options.queries);
    let style = ProgressStyle::with_template("{wide_bar} {human_pos} of {human_len} rays, {eta} left");
    progress.set_style(style.expect("the template is valid"));
    let batches = options.queries.div_ceil(BATCH_SIZE);
    let batch_tally = |batch: u64| {
        let count = BATCH_SIZE.min(options.queries - batch * BATCH_SIZE);
        let case = options.case.unwrap_or(Case::ALL[(batch / 2 % Case::ALL.len() as u64) as usize]);
        let run = if batch.is_multiple_of(2) { run_batch::<f32> } else { run_batch::<f64> };
        let tally = run(case, options.seed, batch, count, options.test);
        progress.inc(count);
        tally
    };
    let tally = (0..batches).into_par_iter().map(batch_tally).reduce(Tally::default, Tally::merge);
    progress.finish_and_clear();
    tally
}

fn print(tally: &Tally, options: &Options, seconds: f64) {
    if let Some(failure) = &tally.first_failure {
        println!("{}", failure.text);
    }
    let [f32_error, f64_error] = tally.point_errors;
    println!("largest point error: {f32_error:.2} rounding units in f32, {f64_error:.2} in f64");
    println!("edges decided by exact arithmetic: {}", tally.exact_decisions);
    let [f32_error, f64_error] = tally.distance_errors;
    println!(
        "{} nearest points; distances right to within {f32_error} rounding units in f32, {f64_error} in f64",
        tally.points
    );
    let Tally { queries, missing, spurious, wrong, leaks, .. } = tally;
    eprintln!("{seconds:.1} s, {:.2} µs per query", seconds * 1e6 / (*queries).max(1) as f64);
    println!(
        "queries={queries} missing={missing} spurious={spurious} wrong={wrong} leaks={leaks} seed={}",
        options.seed
    );
}
