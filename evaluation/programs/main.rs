//! The programs that measure, in one: each of its own would compile the library anew.

mod closest;
#[path = "../../tests/common/mod.rs"]
mod common;
mod convergence;
mod energy;
mod figure8;
mod forces;
mod garbage;
mod hash;
mod oracle;
mod poses;
mod random;
mod rigid;
mod self_collision;
mod steps;
mod support;

use std::process::ExitCode;
use support::arguments::Arguments;

/// Name, line of the list, help without its usage, and what is run.
type Program = (&'static str, &'static str, &'static str, fn(Arguments) -> ExitCode);

const PROGRAMS: [Program; 12] = [
    ("closest", "what a nearest point costs", closest::HELP, closest::main),
    ("convergence", "contact forces on finer and finer meshes", convergence::HELP, convergence::main),
    ("energy", "closed systems never gain energy", energy::HELP, energy::main),
    ("figure8", "the tangential force on a cylinder that lies across a plane", figure8::HELP, figure8::main),
    ("forces", "contact forces against closed forms, closed paths and other programs", forces::HELP, forces::main),
    ("garbage", "what broken bodies, broken pairs and crowds cost", garbage::HELP, garbage::main),
    ("hash", "contacts and forces have the same bits everywhere", hash::HELP, hash::main),
    ("oracle", "every ray hits what exact arithmetic says", oracle::HELP, oracle::main),
    ("poses", "bodies get out of any overlap", poses::HELP, poses::main),
    ("rigid", "what it saves to move a rigid body by a pose", rigid::HELP, rigid::main),
    ("self_collision", "what it costs, and that culling loses nothing", self_collision::HELP, self_collision::main),
    ("steps", "runs steps, for tools that count instructions", steps::HELP, steps::main),
];

const COMMAND: &str = "cargo run --release --example measure --";

fn help() -> String {
    let lines = PROGRAMS.map(|(name, line, ..)| format!("  {name:16}{line}\n")).concat();
    format!(
        "usage: {COMMAND} NAME [options]

Measures the library by one program:

{lines}
NAME --help tells what it measures, its options and its output.
Exit status: 0; 1 as the program says; 2 for a wrong command line."
    )
}

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next();
    if let Some((name, _, help, main)) = PROGRAMS.into_iter().find(|program| name.as_deref() == Some(program.0)) {
        return main(Arguments::new(name, &format!("usage: {COMMAND} {name} [options]\n\n{help}"), arguments));
    }
    match name.as_deref() {
        None => eprintln!("{}", help()),
        Some("--help" | "-h") => {
            println!("{}", help());
            return ExitCode::SUCCESS;
        }
        Some(name) => {
            let names = PROGRAMS.map(|program| program.0).join(", ");
            eprintln!("measure: there is no program {name}; give one of {names}");
        }
    }
    ExitCode::from(2)
}
