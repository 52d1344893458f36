//! Feeds the library with bytes that nobody chose: random ones, and those of earlier inputs, changed.

mod bytes;
mod differential;
mod host;
mod obj_file;
#[path = "../support/mod.rs"]
mod support;
mod surface;

use bytes::{Bytes, Mutator};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::exit;
use std::time::{Duration, Instant};
use support::arguments::Arguments;

const HELP: &str = "\
usage: cargo run --release --example fuzz -- [options]

Feeds each target with inputs made from a seed, and with changes of those that reached something new: another status,
another number of contacts. A fault ends the run and prints the seed and the input's number, which repeat it.

  --seconds N    for each target (default 5)
  --seed N       where the inputs start (default 1)
  --only NAME    one target: surface, obj_file, differential, host (default: all)
  --input N      this input of --only alone, with changes of earlier ones as they were (default: all)
  --help         this text

surface: meshes from bytes. obj_file: .obj files from bytes. differential: rays through both octrees and against every
triangle. host: calls of the C interface in any order its rules allow.
Exit status: 0; 1 for a fault; 2 for a wrong command line.";

/// Does what the bytes say and checks what holds; gives a number that tells outcomes apart.
type Target = fn(&mut Bytes) -> u64;

const TARGETS: [(&str, Target); 4] =
    [("surface", surface::run), ("obj_file", obj_file::run), ("differential", differential::run), ("host", host::run)];

fn main() {
    let mut arguments = Arguments::new(HELP);
    let seconds: u64 = arguments.value("--seconds", 5);
    let seed: u64 = arguments.value("--seed", 1);
    let only: String = arguments.value("--only", String::new());
    let last: u64 = arguments.value("--input", u64::MAX - 1);
    if !only.is_empty() && TARGETS.iter().all(|(name, _)| *name != only) {
        arguments.fail(&format!("there is no target {only}"));
    }
    arguments.finish();
    for (name, target) in TARGETS.into_iter().filter(|(name, _)| only.is_empty() || *name == only) {
        let (start, mut mutator, mut executions) = (Instant::now(), Mutator::new(seed), 0);
        while executions <= last && (start.elapsed() < Duration::from_secs(seconds) || last < u64::MAX - 1) {
            let input = mutator.next();
            match catch_unwind(AssertUnwindSafe(|| target(&mut Bytes::new(&input)))) {
                Ok(outcome) => mutator.learn(&input, outcome),
                Err(_) => {
                    println!("fault: --only {name} --seed {seed} --input {executions}, bytes {input:?}");
                    exit(1);
                }
            }
            executions += 1;
        }
        println!("{name:14} {executions} executions, {} outcomes, no fault", mutator.outcomes());
    }
}
