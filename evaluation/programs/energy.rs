//! Closed systems never gain energy: random bodies, deep in one another too, on the contact system under implicit Euler.

#[path = "../../tests/library/system/bodies.rs"]
mod bodies;
#[allow(dead_code)] // the tests use more of it
#[path = "../../tests/library/system/closed.rs"]
mod closed;

use crate::support::arguments::Arguments;
use closed::{Closed, Wanted};
use indicatif::{ProgressBar, ProgressStyle};
use std::process::ExitCode;

pub const HELP: &str = "\
Lets closed systems go from random starts: two to four bodies, rigid, of springs or in cages, of different materials, with
friction and without, at rest or moving, apart or deep in one another, every second one in a narrow room. No gravity, no
escapes. Each step is implicit Euler, solved until the contact system has nothing to correct. The energy of motion, of
springs and of contact must not rise. That of contact is an integral over what bodies share, of the pressure law's potential.

  --starts N      how many (default 20); the full run is --starts 1000 --steps 10000
  --steps N       of each (default 500)
  --every N       steps between two integrals; between them, motion and springs are summed up (default 25). With more than
                  there are steps, only the start's energy has contact's in it, which is quicker
  --seed N        of all starts (default 1)
  --start N       the first start (default 0): what is printed of a start repeats with --start N --starts 1
  --kind KIND     any, or cubes: rigid ones in narrow rooms, without damping (default any)
  --dt X          the length of steps, in s (default 0: 1/240, 1/60 or 0.05)
  --solves N      how often a step may be solved (default 60)
  --goal X        the part of the force predicted wrongly that is good enough (default 1e-7)
  --guard 1       steps whose energy would rise are cut short (default 0)
  --tolerance X   how far energy may rise, of the greatest (default 0.01)
  --help          this text

Prints starts that rise above the tolerance, how many there are, the greatest rise above the start and, where there were
integrals, above the least energy before, over the greatest energy, and where it was. A step of cubes takes some 7 ms, of
any bodies more.
Exit status: 0; 1 when energy rises above the start by more than the tolerance; 2 for a wrong command line.";

/// The greatest rise of energy, over the greatest energy.
#[derive(Clone, Copy, Debug, Default)]
struct Rise {
    part: f64,
    start: u64,
    step: usize,
}

impl Rise {
    fn most(&mut self, other: Self) {
        if other.part > self.part {
            *self = other;
        }
    }
}

/// What one start showed.
#[derive(Default)]
struct Outcome {
    description: String,
    /// Above the start, and above the least before.
    rises: [Rise; 2],
    /// Steps of which more than a thousandth of the force was wrong in the end.
    unsolved: usize,
    /// Steps with contacts.
    touching: usize,
    /// Steps cut short, and slowed.
    cuts: [usize; 2],
    /// The energy at the end, over that at the start.
    left: f64,
}

/// How a start is run.
struct Course {
    steps: usize,
    every: usize,
    solves: usize,
    goal: f64,
    is_guarded: bool,
}

fn run(mut closed: Closed, start: u64, course: &Course) -> Outcome {
    let &Course { steps, every, solves, goal, is_guarded } = course;
    closed.host.is_guarded = is_guarded;
    (closed.host.solves, closed.host.goal) = (solves, goal);
    let first = closed.energy();
    let (mut greatest, mut least) = (first, first);
    let mut outcome = Outcome { description: closed.description.clone(), ..Outcome::default() };
    for step in 1..=steps {
        closed.host.step(closed.dt);
        outcome.unsolved += usize::from(closed.host.wrong > 1e-3);
        outcome.touching += usize::from(!closed.host.system.contacts().is_empty());
        let (is_whole, moving) = (step % every == 0, closed.moving());
        let energy = if is_whole { moving + closed.contact() } else { moving };
        greatest = greatest.max(energy);
        let rise = |above: f64| Rise { part: (energy - above) / greatest, start, step };
        outcome.rises[0].most(rise(first));
        if is_whole {
            outcome.rises[1].most(rise(least));
            least = least.min(energy);
        }
    }
    outcome.cuts = closed.host.cuts;
    outcome.left = closed.energy() / first;
    outcome
}

pub fn main(mut arguments: Arguments) -> ExitCode {
    let starts: u64 = arguments.value("--starts", 20);
    let steps: usize = arguments.value("--steps", 500);
    let every: usize = arguments.value("--every", 25);
    let seed: u64 = arguments.value("--seed", 1);
    let kind = arguments.value("--kind", "any".to_owned());
    let wanted = Wanted { cubes: kind == "cubes", dt: arguments.value("--dt", 0.0) };
    let solves: usize = arguments.value("--solves", 60);
    let goal: f64 = arguments.value("--goal", 1e-7);
    let is_guarded = arguments.value("--guard", 0) == 1;
    let first: u64 = arguments.value("--start", 0);
    let tolerance: f64 = arguments.value("--tolerance", 0.01);
    if starts == 0 || steps == 0 || every == 0 || solves == 0 {
        arguments.fail("--starts, --steps, --every and --solves are at least 1");
    }
    if !wanted.cubes && kind != "any" {
        arguments.fail(&format!("unknown kind '{kind}': any or cubes"));
    }
    if [tolerance, goal, wanted.dt].iter().any(|x| !(*x >= 0.0 && x.is_finite())) {
        arguments.fail("--tolerance, --goal and --dt are finite and at least 0");
    }
    arguments.finish();
    let course = Course { steps, every, solves, goal, is_guarded };
    // On standard error, and only where that is a terminal.
    let progress = ProgressBar::new(starts);
    let style = ProgressStyle::with_template("{wide_bar} {pos} of {len} starts, {eta} left");
    progress.set_style(style.expect("the template is valid"));
    let mut worst = [Rise::default(); 2];
    let (mut risen, mut unsolved, mut touching) = ([0; 2], 0, 0);
    let (mut cuts, mut ended, mut left) = ([0; 2], 0, Vec::new());
    for start in first..first + starts {
        let outcome = run(Closed::wanted(seed, start, wanted), start, &course);
        for (k, rise) in outcome.rises.into_iter().enumerate() {
            worst[k].most(rise);
            risen[k] += usize::from(rise.part > tolerance);
        }
        unsolved += outcome.unsolved;
        touching += outcome.touching;
        (0..2).for_each(|k| cuts[k] += outcome.cuts[k]);
        ended += usize::from(outcome.left > 1.001);
        left.push(outcome.left);
        if outcome.rises.iter().any(|rise| rise.part > tolerance) {
            let [above_start, above_least] = outcome.rises;
            progress.suspend(|| {
                println!(
                    "start {start}: {:.2} % above the start at step {}, {:.2} % above the least before at step {}: {}; \
                     {} of {steps} steps in contact, {} not solved",
                    100.0 * above_start.part,
                    above_start.step,
                    100.0 * above_least.part,
                    above_least.step,
                    outcome.description,
                    outcome.touching,
                    outcome.unsolved
                );
            });
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    let judged = if every <= steps { 2 } else { 1 };
    for (name, rise, count) in
        [("start", worst[0], risen[0]), ("least before", worst[1], risen[1])].into_iter().take(judged)
    {
        let Rise { part, start, step } = rise;
        println!(
            "above the {name}: {count} of {starts} starts by more than {}, at most {part:.3e} of the greatest energy, \
             in start {start} at step {step}",
            tolerance
        );
    }
    println!(
        "{starts} starts of {steps} steps, {touching} steps in contact, {unsolved} of them not solved; seed {seed}"
    );
    left.sort_by(f64::total_cmp);
    println!(
        "{ended} end with more than 1.001 of what they began with, at most {:.4}, half of them with {:.4}; {} steps cut \
         short, {} slowed",
        left[left.len() - 1],
        left[left.len() / 2],
        cuts[0],
        cuts[1]
    );
    if risen[0] == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
