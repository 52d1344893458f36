//! Two bodies of one size, each turned at random, their centres apart by a share of that size.

use super::{Body, TUBE};
use crate::Vector;
use crate::shapes::{self, Shape};
use crate::surfaces::{self, SIZE};
use nalgebra::{Rotation3, Unit};
use std::path::{Path, PathBuf};

const DEFAULT_APART: f64 = 0.2;
const DEFAULT_SEED: u64 = 1;

/// Which surfaces.
enum Surfaces {
    /// Two tori of so many rows and half as many columns.
    Tori(u32),
    /// Two balls with bumps, 100 820 triangles each, of no symmetry.
    Bumpy,
    Files([PathBuf; 2]),
}

pub struct Deep {
    surfaces: Surfaces,
    apart: f64,
    seed: u64,
}

/// The workload of two Wavefront files.
pub fn of_files(files: [&Path; 2], apart: f64, seed: u64) -> String {
    let [first, second] = files.map(|path| path.to_string_lossy());
    format!("files:{first}:{second}@{apart}#{seed}")
}

impl Deep {
    /// `deepN`, `deepbumpy` or `files:A:B`; each with or without `@APART`, then with or without `#SEED`.
    pub fn parse(name: &str) -> Option<Self> {
        let (name, seed) = match name.rsplit_once('#') {
            Some((name, seed)) => (name, seed.parse().ok()?),
            None => (name, DEFAULT_SEED),
        };
        let (name, apart) = match name.rsplit_once('@') {
            Some((name, apart)) => (name, apart.parse().ok()?),
            None => (name, DEFAULT_APART),
        };
        let surfaces = if let Some(files) = name.strip_prefix("files:") {
            let (first, second) = files.split_once(':')?;
            Surfaces::Files([first.into(), second.into()])
        } else {
            match name.strip_prefix("deep")? {
                "bumpy" => Surfaces::Bumpy,
                rows => Surfaces::Tori(rows.parse().ok()?),
            }
        };
        Some(Self { surfaces, apart, seed })
    }

    /// How the tables call it.
    pub fn name(&self) -> String {
        let surfaces = match &self.surfaces {
            Surfaces::Tori(rows) => format!("deep{rows}"),
            Surfaces::Bumpy => "deepbumpy".to_owned(),
            Surfaces::Files([first, second]) => surfaces::stems([first, second]),
        };
        let seed = if self.seed == DEFAULT_SEED { String::new() } else { format!("#{}", self.seed) };
        format!("{surfaces}@{}{seed}", self.apart)
    }

    pub fn bodies(&self) -> Result<Vec<Body>, String> {
        let shapes = match &self.surfaces {
            Surfaces::Tori(rows) => [(); 2].map(|()| shapes::torus(*rows as usize, (rows / 2) as usize, TUBE, false)),
            Surfaces::Bumpy => [surfaces::bumpy(5.0, 71), surfaces::bumpy(3.0, 71)],
            Surfaces::Files([first, second]) => [surfaces::read(first)?, surfaces::read(second)?],
        };
        let mut random = fastrand::Rng::with_seed(self.seed);
        let shift = direction(&mut random).into_inner() * (self.apart * SIZE);
        let mut body = |shape: Shape, shift: Vector| {
            let turn = Rotation3::from_axis_angle(&direction(&mut random), std::f64::consts::TAU * random.f64());
            let size = surfaces::longest_side(&shape);
            Body::placed(shape, |point| turn * point * (SIZE / size) + shift)
        };
        let [first, second] = shapes;
        Ok(vec![body(first, Vector::zeros()), body(second, shift)])
    }
}

/// Any direction is as likely as any other.
fn direction(random: &mut fastrand::Rng) -> Unit<Vector> {
    loop {
        let point = Vector::from_fn(|_, _| 2.0 * random.f64() - 1.0);
        if let Some(direction) = Unit::try_new(point, 0.1).filter(|_| point.norm_squared() <= 1.0) {
            return direction;
        }
    }
}
