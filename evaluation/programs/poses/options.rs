//! The command line.

use super::shapes;
use super::start::Kind;
use lexopt::prelude::*;

pub const HELP: &str = "\
Starts bodies deep inside one another and moves them, quasi-statically, as their contacts push, until an exact test of
its own finds them apart. Four poses of ten are random, two are one body twice in the same place, two are one body
inside another, two are edge across edge with no vertex inside. Linked tori are left out.

  --count N        how many poses (default 1000)
  --seed S         another seed draws other poses (default 1); the results do not depend on the threads
  --mode NAME      default: the library's; paper: the library with all that goes beyond the paper off; proximity: closest
                   features within a thickness, after Bridson et al. 2002, for comparison
  --precision P    f32 or f64 (default f64)
  --vertices N     shapes of about N vertices; 0 leaves them at 4 to 434 (default 0)
  --pile N         how many bodies start in one another (default 2)
  --kind NAME      only one kind of start: deep, coincident, contained-centre, contained-aside or edges
  --shape NAME     all bodies of one shape: torus, sphere, box, tetrahedron, star, plate, c-clamp, comb, bowl, helix,
                   cross, l-beam or holed-shell
  --press LOAD     pressing runs instead: two bodies that just touch are pressed together by a steady load for 200 steps
                   on a straight guide, which must not be taken for an overlap to escape from; LOAD is the share of the
                   smaller body's volume that would have to overlap a flat face to bear it; 0.001 is light
  --failures       the table of docs/stability.md instead: what each mode makes of each kind of failure, --count poses of each
  --pictures DIR   the same, and a picture of each failure into this folder
  --threads N      how many threads; 0 is one for each core (default 0)
  --pose K         only pose K of the seed, every step printed
  --help           this text

The last line is the result: poses=N separated=N stuck=N exploded=N median_steps=N worst_steps=N
  separated  apart within 200 steps; their steps give the median and the worst
  stuck      not apart after 200 steps
  exploded   a body moved more than ten sizes, or to no number
With --press it is: pressed=N escaped=N share=P, the runs in which the pair began to escape
Exit status: 0; 1 if in default mode less than 99.9 % are separated, or with --failures any is stuck; 2 for a wrong command line.";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    Default,
    Paper,
    Proximity,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    F32,
    F64,
}

#[derive(Clone, Debug)]
pub struct Options {
    pub count: u64,
    pub seed: u64,
    pub mode: Mode,
    pub precision: Precision,
    pub vertices: usize,
    pub pile: usize,
    pub kind: Option<Kind>,
    /// Its number.
    pub shape: Option<usize>,
    pub threads: usize,
    pub pose: Option<u64>,
    /// A share of the smaller body's volume.
    pub press: Option<f64>,
    pub failures: bool,
    /// Where to draw them.
    pub pictures: Option<String>,
}

impl Options {
    pub fn parse(mut parser: lexopt::Parser) -> Result<Self, lexopt::Error> {
        let mut options = Self {
            count: 1000,
            seed: 1,
            mode: Mode::Default,
            precision: Precision::F64,
            vertices: 0,
            pile: 2,
            kind: None,
            shape: None,
            threads: 0,
            pose: None,
            press: None,
            failures: false,
            pictures: None,
        };
        while let Some(argument) = parser.next()? {
            match argument {
                Long("count") => options.count = parser.value()?.parse()?,
                Long("seed") => options.seed = parser.value()?.parse()?,
                Long("mode") => options.mode = parser.value()?.parse_with(read_mode)?,
                Long("precision") => options.precision = parser.value()?.parse_with(read_precision)?,
                Long("vertices") => options.vertices = parser.value()?.parse()?,
                Long("pile") => options.pile = parser.value()?.parse_with(read_pile)?,
                Long("kind") => options.kind = Some(parser.value()?.parse_with(read_kind)?),
                Long("shape") => options.shape = Some(parser.value()?.parse_with(read_shape)?),
                Long("threads") => options.threads = parser.value()?.parse()?,
                Long("pose") => options.pose = Some(parser.value()?.parse()?),
                Long("press") => options.press = Some(parser.value()?.parse()?),
                Long("failures") => options.failures = true,
                Long("pictures") => {
                    options.failures = true;
                    options.pictures = Some(parser.value()?.string()?);
                }
                _ => return Err(argument.unexpected()),
            }
        }
        Ok(options)
    }
}

fn read_mode(name: &str) -> Result<Mode, String> {
    match name {
        "default" => Ok(Mode::Default),
        "paper" => Ok(Mode::Paper),
        "proximity" => Ok(Mode::Proximity),
        _ => Err("the modes are default, paper and proximity".to_owned()),
    }
}

fn read_precision(name: &str) -> Result<Precision, String> {
    match name {
        "f32" => Ok(Precision::F32),
        "f64" => Ok(Precision::F64),
        _ => Err("the precisions are f32 and f64".to_owned()),
    }
}

fn read_kind(name: &str) -> Result<Kind, String> {
    let found = Kind::ALL.into_iter().find(|kind| kind.name() == name);
    found.ok_or_else(|| format!("the kinds are {}", Kind::ALL.map(Kind::name).join(", ")))
}

fn read_shape(name: &str) -> Result<usize, String> {
    let found = shapes::NAMES.iter().position(|&known| known == name);
    found.ok_or_else(|| format!("the shapes are {}", shapes::NAMES.join(", ")))
}

fn read_pile(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(count @ 2..=20) => Ok(count),
        _ => Err("a pile has 2 to 20 bodies".to_owned()),
    }
}
