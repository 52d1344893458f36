//! What is measured: one way to find the contacts of a step.

use crate::c_library::Defaults;
use crate::host::Host;
use crate::libraries::Libraries;
use crate::library::{self, HostScalar};
use crate::workload::Workload;
use nalgebra::Vector3;
use raycontact::contact::DetectionOptions;

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Precision {
    F32,
    F64,
}

impl Precision {
    pub fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }
}

/// Microseconds by stage, where a method separates them.
#[derive(Clone, Copy, Default)]
#[repr(C)]
pub struct Stages {
    pub normals: f64,
    pub structure: f64,
    pub trace: f64,
    pub filter: f64,
}

/// What identifies a contact.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Key {
    pub colliding: u32,
    pub collided: u32,
    pub vertex: u32,
    pub triangle: u32,
}

/// What one contact does to a body, for unit stiffness.
#[derive(Clone, Debug)]
pub struct Push {
    /// The one pushed, and the other, which is pushed back.
    pub bodies: [u32; 2],
    pub point: Vector3<f64>,
    /// Depth · cos α along the ray, not weighted.
    pub force: Vector3<f64>,
    /// What the contact stands for, where its method says so.
    pub area: Option<f64>,
    /// Vertices of the pushed body, or of either: body and vertex.
    pub vertices: Vec<[u32; 2]>,
}

pub trait Method {
    /// Does a whole step with the positions in the host's arrays.
    fn step(&mut self, host: &Host) -> Option<Stages>;
    /// The contacts of the last step.
    fn contacts(&self) -> Vec<Key>;
    /// What they do.
    fn pushes(&self) -> Vec<Push>;
}

/// What to measure.
#[derive(Clone, Copy)]
pub struct Description {
    pub name: &'static str,
    pub precision: Precision,
    pub threads: u32,
    /// Whether it finds the contacts of the method, so that they can be held against the oracle's.
    pub same_contacts: bool,
    /// The path of instructions, where it must be asked for.
    pub simd: Option<&'static str>,
}

/// The default, as in every chart: what a C program gets that changes no option, in double precision.
pub const C_DEFAULTS: &str = "raycontact";
/// The same options from Rust, in either precision.
pub const RUST_DEFAULTS: &str = "raycontact-rust";
/// What the paper does and nothing else, from Rust, as the peers do it: what their times are divided by.
pub const PAPER: &str = "raycontact-paper";
const PAPER_CLASSIC: &str = "raycontact-paper-classic";

/// Every method, in the order of the report.
pub fn all() -> Vec<Description> {
    use Precision::{F32, F64};
    let method = |name, precision, threads| Description { name, precision, threads, same_contacts: true, simd: None };
    let other = |name, precision, threads| Description { same_contacts: false, ..method(name, precision, threads) };
    let path = |name, simd| Description { simd: Some(simd), ..method(name, F32, 1) };
    vec![
        method(PAPER, F32, 1),
        path("raycontact-paper-avx2", "avx2"),
        path("raycontact-paper-baseline", "baseline"),
        // Rays start from other points than the vertices: C's defaults, and the same options from Rust.
        other(C_DEFAULTS, F64, 1),
        other(RUST_DEFAULTS, F64, 1),
        other(RUST_DEFAULTS, F32, 1),
        method(PAPER, F64, 1),
        method(PAPER, F32, 2),
        method(PAPER_CLASSIC, F32, 1),
        other("lower-bound", F32, 1),
        other("lower-bound", F64, 1),
        method("embree-refit", F32, 1),
        method("embree-refit-avx2", F32, 1),
        method("embree-refit-sse2", F32, 1),
        method("embree-refit", F32, 2),
        method("embree-low", F32, 1),
        method("embree4-refit", F32, 1),
        method("parry3d-refit", F32, 1),
        method("obvhs-refit", F32, 1),
        method("tinybvh-refit", F32, 1),
        other("fcl-aabb", F32, 1),
        other("bullet-vf", F32, 1),
    ]
}

/// Bullet builds its tree of a body's faces in a time that grows with their square: minutes above so many.
const MOST_TRIANGLES_FOR_BULLET: usize = 50_000;

impl Description {
    /// Whether it can take the workload, and be made ready for it in a time that one would wait.
    pub fn can_take(&self, workload: &Workload) -> bool {
        let largest = workload.bodies.iter().map(|body| body.triangles.len()).max().unwrap_or(0);
        match self.name {
            "bullet-vf" => largest <= MOST_TRIANGLES_FOR_BULLET,
            // It knows its way over grids alone.
            "lower-bound" => workload.bodies.iter().all(|body| body.rows > 0),
            _ => true,
        }
    }

    pub fn start(&self, workload: &Workload, host: &Host, libraries: &Libraries) -> Result<Box<dyn Method>, String> {
        match (self.name, self.precision) {
            (PAPER, Precision::F32) => self.whole::<f32>(workload, host, DetectionOptions::paper()),
            (PAPER, Precision::F64) => self.whole::<f64>(workload, host, DetectionOptions::paper()),
            (C_DEFAULTS, _) => Ok(Box::new(Defaults::new(&libraries.raycontact, workload, host)?)),
            (RUST_DEFAULTS, Precision::F32) => self.whole::<f32>(workload, host, DetectionOptions::default()),
            (RUST_DEFAULTS, Precision::F64) => self.whole::<f64>(workload, host, DetectionOptions::default()),
            (PAPER_CLASSIC, _) => {
                Ok(Box::new(library::Classic::<f32>::new(workload, host, DetectionOptions::paper())?))
            }
            _ => Ok(Box::new(libraries.peers.start(self, workload, host)?)),
        }
    }

    fn whole<T: HostScalar>(
        &self,
        workload: &Workload,
        host: &Host,
        options: DetectionOptions<T>,
    ) -> Result<Box<dyn Method>, String> {
        Ok(Box::new(library::Whole::new(workload, host, self.threads, options)?))
    }
}
