//! The command line. `lexopt` reads it: no dependencies of its own, and it knows every spelling (`--seed 7`,
//! `--seed=7`) without deciding anything for us.

use super::cases::Case;
use lexopt::prelude::*;
use raycontact::triangle::TriangleTest;

pub const HELP: &str = "\
Aims rays at small meshes and holds every answer of the library against exact arithmetic: both octree layouts, rays
alone and many at once, and testing every triangle, in f32 and f64. For each 8 rays it asks for one nearest point too.

  --queries N   how many rays; 1e7 and 10_000_000 are understood (default 100000)
  --seed S      another seed asks other questions (default 1); the answers do not depend on the threads
  --threads N   how many threads; 0 is one for each core (default 0)
  --case NAME   only one case: random, grid-aligned, axis-aligned, edge-aimed, vertex-aimed, grazing, sliver, tiny,
                huge or far-offset
  --test NAME   the triangle test: watertight (default), or moller-trumbore, which leaks and so shows that the oracle
                finds leaks
  --help        this text

The last line is the result: queries=N missing=0 spurious=0 wrong=0 leaks=0 seed=S
  missing   a certain crossing has no hit, or the answer lies beyond it
  spurious  a triangle is hit that the ray passes
  wrong     answers differ in a bit, or a hit's or nearest point's distance, weights or side is wrong
  leaks     a ray that starts inside hits nothing
The first fault is printed in full. Exit status: 0 without faults, 1 with any, 2 for a wrong command line.";

#[derive(Clone, Copy)]
pub struct Options {
    pub queries: u64,
    pub seed: u64,
    pub threads: usize,
    pub case: Option<Case>,
    pub test: TriangleTest,
}

impl Options {
    pub fn parse(mut parser: lexopt::Parser) -> Result<Self, lexopt::Error> {
        let mut options = Self { queries: 100_000, seed: 1, threads: 0, case: None, test: TriangleTest::Watertight };
        while let Some(argument) = parser.next()? {
            match argument {
                Long("queries") => options.queries = parser.value()?.parse_with(count)?,
                Long("seed") => options.seed = parser.value()?.parse()?,
                Long("threads") => options.threads = parser.value()?.parse()?,
                Long("case") => options.case = Some(parser.value()?.parse_with(case)?),
                Long("test") => options.test = parser.value()?.parse_with(test)?,
                _ => return Err(argument.unexpected()),
            }
        }
        Ok(options)
    }
}

fn count(text: &str) -> Result<u64, String> {
    let plain = text.replace('_', "");
    if let Ok(count) = plain.parse() {
        return Ok(count);
    }
    match plain.parse::<f64>() {
        Ok(count) if (0.0..=1e18).contains(&count) && count.fract() == 0.0 => Ok(count as u64),
        _ => Err("give a whole number, such as 100000 or 1e7".to_owned()),
    }
}

fn case(name: &str) -> Result<Case, String> {
    let found = Case::ALL.into_iter().find(|case| case.name() == name);
    found.ok_or_else(|| format!("the cases are {}", Case::ALL.map(Case::name).join(", ")))
}

fn test(name: &str) -> Result<TriangleTest, String> {
    match name {
        "watertight" => Ok(TriangleTest::Watertight),
        "moller-trumbore" => Ok(TriangleTest::MollerTrumbore),
        _ => Err("the tests are watertight and moller-trumbore".to_owned()),
    }
}
