//! The table of docs/stability.md: how other methods fail, and a picture of each failure.

use super::body::{Body, Rest};
use super::options::{Mode, Options};
use super::picture::{self, Panel};
use super::run::{self, Outcome};
use super::shapes;
use super::start::{self, Kind};
use rayon::prelude::*;
use std::path::Path;

/// A way to start that some method fails at.
struct Failure {
    name: &'static str,
    /// Its picture's file name.
    file: &'static str,
    kind: Kind,
    /// All bodies of this shape.
    shape: Option<&'static str>,
    /// The shape in the picture.
    drawn: &'static str,
}

const FAILURES: [Failure; 7] = [
    Failure { name: "bodies deep in one another", file: "deep", kind: Kind::Deep, shape: None, drawn: "c-clamp" },
    Failure {
        name: "one body twice in the same place",
        file: "coincident",
        kind: Kind::Coincident,
        shape: None,
        drawn: "l-beam",
    },
    Failure {
        name: "one body swallowed whole, around the middle",
        file: "contained_centre",
        kind: Kind::ContainedCentre,
        shape: None,
        drawn: "box",
    },
    Failure {
        name: "one body swallowed whole, elsewhere",
        file: "contained_aside",
        kind: Kind::ContainedAside,
        shape: None,
        drawn: "box",
    },
    Failure {
        name: "edge across edge, no vertex inside",
        file: "edges",
        kind: Kind::Edges,
        shape: None,
        drawn: "tetrahedron",
    },
    Failure {
        name: "rays leave their own body first: thin plates",
        file: "plates",
        kind: Kind::Deep,
        shape: Some("plate"),
        drawn: "plate",
    },
    Failure {
        name: "the same, and entangled: helices",
        file: "helices",
        kind: Kind::Deep,
        shape: Some("helix"),
        drawn: "helix",
    },
];

const MODES: [Mode; 3] = [Mode::Paper, Mode::Proximity, Mode::Default];

/// Prints the table, each cell from the options' number of poses, and draws the pictures into `folder`. Whether all is as
/// the library claims: default mode frees every pose, and each failure is one, for at least a quarter of the poses and in
/// both other modes.
pub fn print(rests: &[Rest], options: &Options, folder: Option<&Path>) -> std::io::Result<bool> {
    println!("| failure | paper | proximity | default |\n| --- | --- | --- | --- |");
    let mut as_claimed = true;
    for failure in &FAILURES {
        let chosen = of_shape(rests, failure.shape);
        let options = Options { kind: Some(failure.kind), ..options.clone() };
        let freed = MODES.map(|mode| {
            let is_freed = |number: &u64| separate(chosen, &options, mode, *number).0 == Outcome::Separated;
            (0..options.count).into_par_iter().filter(is_freed).count() as u64
        });
        let cells = freed.map(|freed| format!("{freed} of {}", options.count));
        let name =
            folder.map_or(failure.name.to_owned(), |_| format!("[{}](stability/{}.svg)", failure.name, failure.file));
        println!("| {name} | {} |", cells.join(" | "));
        as_claimed &= freed[2] == options.count && freed[..2].iter().all(|freed| freed * 4 <= options.count * 3);
        if let Some(folder) = folder {
            draw(rests, &options, failure, &folder.join(failure.file).with_extension("svg"))?;
        }
    }
    Ok(as_claimed)
}

fn of_shape<'a>(rests: &'a [Rest], shape: Option<&str>) -> &'a [Rest] {
    let number = shape.and_then(|shape| shapes::NAMES.iter().position(|&name| name == shape));
    number.map_or(rests, |number| &rests[number..=number])
}

fn separate<'a>(rests: &'a [Rest], options: &Options, mode: Mode, number: u64) -> (Outcome, u32, Vec<Body<'a>>) {
    let mut bodies = start::start(rests, options, number).bodies;
    let run = run::run::<f64>(mode, &mut bodies, |_| ());
    (run.outcome, run.steps, bodies)
}

/// The first pose in which both other methods leave the bodies stuck.
fn draw(rests: &[Rest], options: &Options, failure: &Failure, file: &Path) -> std::io::Result<()> {
    let chosen = of_shape(rests, Some(failure.drawn));
    for number in 0..options.count {
        let ends = MODES.map(|mode| separate(chosen, options, mode, number));
        if ends[..2].iter().any(|(outcome, ..)| *outcome == Outcome::Separated) {
            continue;
        }
        let mut panels =
            vec![Panel { title: "start".to_owned(), bodies: start::start(chosen, options, number).bodies }];
        for (name, (outcome, steps, bodies)) in ["paper", "proximity", "default"].into_iter().zip(ends) {
            let end = match outcome {
                Outcome::Separated => format!("apart after {steps} steps"),
                Outcome::Stuck => "stuck".to_owned(),
                Outcome::Exploded => "exploded".to_owned(),
            };
            panels.push(Panel { title: format!("{name}: {end}"), bodies });
        }
        return std::fs::write(file, picture::svg(&panels));
    }
    Err(std::io::Error::other(format!("no pose shows the failure \"{}\"; ask for more", failure.name)))
}
