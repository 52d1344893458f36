//! One number for all contacts and forces of five scenes in both precisions: the same on every machine, with any number of
//! threads, whose-ever they are, and with the instructions of any processor.
//!
//! The scenes are made of sums, products, quotients and roots alone, which are rounded alike everywhere.

use crate::support::arguments::Arguments;
use raycontact::contact::{ContactList, DetectionOptions, Sampling};
use raycontact::force::{PenaltyLaw, Weighting, add_forces};
use raycontact::math::{Scalar, Vector3};
use raycontact::mesh::Mesh;
use raycontact::scene::Scene;
use raycontact::threads::ParallelFor;
use std::process::ExitCode;
use std::sync::Arc;

pub const HELP: &str = "\
Moves five scenes a few steps, in f32 and f64, and hashes every bit of their contacts and forces.

  --threads N    1: the calling thread alone; N: a pool of N; 0: one for each core (default 1)
  --host N       N threads of the program's own instead, lent to the library (default 0: none)
  --help         this text

RAYCONTACT_SIMD=baseline, avx2 or avx512 chooses the instructions.
Last line: hash=…, the number in tests/golden_hash.txt whatever the options.
Exit status: 0; 2 for a wrong command line.";

pub fn main(mut arguments: Arguments) -> ExitCode {
    let threads: usize = arguments.value("--threads", 1);
    let host: usize = arguments.value("--host", 0);
    arguments.finish();
    let mut all = Hash::new();
    for (name, build) in SCENES {
        let one = hash_of::<f32>(&build(), threads, host);
        let two = hash_of::<f64>(&build(), threads, host);
        println!("{name:16} f32 {one:016x}  f64 {two:016x}");
        all.add(one);
        all.add(two);
    }
    println!("hash={:016x}", all.0);
    ExitCode::SUCCESS
}

/// FNV-1a over 64-bit words.
struct Hash(u64);

impl Hash {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn add(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    }

    fn add_numbers<T: Scalar>(&mut self, numbers: &[T]) {
        numbers.iter().for_each(|number| self.add(number.to_f64().to_bits()));
    }

    fn add_contacts<T: Scalar>(&mut self, list: &ContactList<T>) {
        self.add(list.len() as u64);
        for contact in &list.contacts {
            self.add(contact.kind as u64);
            [contact.colliding, contact.collided].into_iter().for_each(|body| self.add(u64::from(body)));
            for point in [&contact.p1, &contact.p2] {
                self.add(u64::from(point.triangle));
                point.vertices.into_iter().for_each(|vertex| self.add(u64::from(vertex)));
                self.add_numbers(&point.weights);
                self.add_numbers(point.position.as_slice());
            }
            self.add_numbers(contact.direction.as_slice());
            self.add_numbers(&[contact.depth, contact.cos_alpha, contact.area]);
        }
    }
}

/// Threads that start anew for each call, and take numbers in turn.
struct Host(usize);

impl ParallelFor for Host {
    fn run(&self, count: usize, task: &(dyn Fn(usize) + Sync)) {
        std::thread::scope(|scope| {
            for thread in 0..self.0 {
                scope.spawn(move || (thread..count).step_by(self.0).rev().for_each(task));
            }
        });
    }
}

type Point = [f64; 3];

/// Corners and triangles.
struct Surface {
    positions: Vec<Point>,
    triangles: Vec<[u32; 3]>,
    is_open: bool,
    collides_with_itself: bool,
}

impl Surface {
    fn map(mut self, map: impl Fn(Point) -> Point) -> Self {
        self.positions.iter_mut().for_each(|point| *point = map(*point));
        self
    }

    fn moved(self, by: Point) -> Self {
        self.map(|[x, y, z]| [x + by[0], y + by[1], z + by[2]])
    }

    /// Turned about x by the angle of the 3-4-5 triangle.
    fn turned(self) -> Self {
        self.map(|[x, y, z]| [x, 0.8 * y - 0.6 * z, 0.6 * y + 0.8 * z])
    }
}

/// A point of the unit circle: of a square's border, at equal distances, drawn to the circle.
fn on_circle(place: usize, count: usize) -> [f64; 2] {
    let along = 4.0 * place as f64 / count as f64;
    let (side, across) = (along.floor() as i32, 2.0 * (along - along.floor()) - 1.0);
    let [x, y] = [[1.0, across], [-across, 1.0], [-1.0, -across], [across, -1.0]][side as usize % 4];
    let length = (x * x + y * y).sqrt();
    [x / length, y / length]
}

fn torus(around: usize, across: usize, ring: f64, tube: f64) -> Surface {
    let quads = || (0..around).flat_map(|i| (0..across).map(move |j| (i, j)));
    let point = |(i, j)| {
        let ([x, y], [out, up]) = (on_circle(i, around), on_circle(j, across));
        [(ring + tube * out) * x, (ring + tube * out) * y, tube * up]
    };
    let index = |i: usize, j: usize| (i % around * across + j % across) as u32;
    let two = |(i, j): (usize, usize)| {
        let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    Surface {
        positions: quads().map(point).collect(),
        triangles: quads().flat_map(two).collect(),
        is_open: false,
        collides_with_itself: false,
    }
}

/// A box by two squares of its eight corners.
fn block(half: Point) -> Surface {
    let corner = |i: usize| std::array::from_fn(|axis| if i >> axis & 1 == 1 { half[axis] } else { -half[axis] });
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Surface { positions: (0..8).map(corner).collect(), triangles, is_open: false, collides_with_itself: false }
}

/// A square sheet at height 0, seen from above.
fn floor(cells: usize, half: f64) -> Surface {
    let side = cells + 1;
    let at = |place: usize| (2.0 * place as f64 / cells as f64 - 1.0) * half;
    let positions = (0..side * side).map(|place| [at(place % side), at(place / side), 0.0]).collect();
    let quads = (0..cells * cells).map(|place| (place / cells * side + place % cells) as u32);
    let row = side as u32;
    let triangles = quads.flat_map(|a| [[a, a + 1, a + 1 + row], [a, a + 1 + row, a + row]]).collect();
    Surface { positions, triangles, is_open: true, collides_with_itself: false }
}

/// What is hashed.
struct Setting {
    bodies: Vec<Surface>,
    sampling: Option<Sampling<f64>>,
    is_paper: bool,
}

type Build = fn() -> Setting;

const SCENES: [(&str, Build); 5] = [
    ("deep tori", || {
        let bodies = (0..3).map(f64::from);
        let bodies = bodies.map(|k| torus(64, 32, 1.0, 0.4).turned().moved([0.3 * k, 0.1 * k, 0.2 * k])).collect();
        Setting { bodies, sampling: None, is_paper: false }
    }),
    ("paper", || {
        let bodies = vec![torus(64, 32, 1.0, 0.4), torus(64, 32, 1.0, 0.4).turned().moved([0.2, 0.1, 0.5])];
        Setting { bodies, sampling: None, is_paper: true }
    }),
    ("pile", || {
        let mut bodies: Vec<_> = (0..4).map(|_| block([0.5, 0.4, 0.3])).collect();
        bodies.push(torus(32, 12, 0.1, 0.04).moved([0.05, 0.02, 0.01]));
        Setting { bodies, sampling: None, is_paper: false }
    }),
    ("self and others", || {
        let mut spindle = torus(64, 52, 0.3, 0.4);
        spindle.collides_with_itself = true;
        Setting { bodies: vec![spindle, block([0.3; 3]).moved([0.6, 0.1, 0.2])], sampling: None, is_paper: false }
    }),
    ("sheet and patches", || {
        let bodies = vec![floor(8, 3.0), torus(64, 32, 1.0, 0.4).moved([0.1, 0.2, 0.25]), {
            torus(64, 32, 1.0, 0.4).turned().moved([0.4, 0.3, 0.8])
        }];
        Setting { bodies, sampling: Some(Sampling::Accuracy(0.3)), is_paper: false }
    }),
];

const STEPS: usize = 8;

fn hash_of<T: Scalar>(setting: &Setting, threads: usize, host: usize) -> u64 {
    let mut scene = if host > 0 {
        Scene::with_host_threads(Arc::new(Host(host)))
    } else {
        Scene::new(threads).expect("the threads start")
    };
    let defaults = if setting.is_paper { DetectionOptions::paper() } else { DetectionOptions::default() };
    let sampling = match setting.sampling {
        Some(Sampling::Accuracy(tolerance)) => Sampling::Accuracy(T::of(tolerance)),
        _ => defaults.sampling,
    };
    scene.set_options(DetectionOptions { sampling, ..defaults });
    let weighting = if setting.is_paper { Weighting::Vertex } else { Weighting::Area };
    let law = PenaltyLaw::new(1.0, 0.0, weighting).expect("a valid law");
    let mut positions: Vec<Vec<Vector3<T>>> = Vec::new();
    for body in &setting.bodies {
        let corners: Vec<[T; 3]> = body.positions.iter().map(|point| point.map(T::of)).collect();
        let make = if body.is_open { Mesh::open } else { Mesh::new };
        let number = scene.add(make(&corners, &body.triangles).expect("a valid surface"));
        scene.set_self_collision(number, body.collides_with_itself).expect("it was added");
        positions.push(corners.into_iter().map(Vector3::from).collect());
    }
    let (mut hash, mut contacts, mut patches) = (Hash::new(), ContactList::default(), 0);
    for step in 0..STEPS {
        for (body, positions) in positions.iter().enumerate() {
            let mesh = scene.mesh_mut(body as u32).expect("it was added");
            mesh.set_positions_with(positions.len(), |vertex| rippled(&positions[vertex], step)).expect("finite");
        }
        scene.query(&mut contacts);
        hash.add_contacts(&contacts);
        patches += contacts.statistics.patches;
        let mut forces: Vec<_> = positions.iter().map(|of_body| vec![Vector3::zeros(); of_body.len()]).collect();
        add_forces(&contacts, &law, None::<&[Vec<Vector3<T>>]>, None, &mut forces);
        for (positions, forces) in positions.iter_mut().zip(&forces) {
            forces.iter().for_each(|force| hash.add_numbers(force.as_slice()));
            // Each body goes a little along its force, so that what follows depends on it.
            let push = forces.iter().fold(Vector3::zeros(), |sum, force| sum + force);
            let size = push.amax();
            let by = if size > T::zero() { push * (T::of(0.02) / size) } else { push };
            positions.iter_mut().for_each(|position| *position += by);
        }
    }
    assert!(patches > 0 || setting.sampling.is_none(), "patches are hashed where they are meant to be");
    hash.0
}

/// A wave without a sine: t (1 − 4t²) for t from −½ to ½, over and over.
fn rippled<T: Scalar>(point: &Vector3<T>, step: usize) -> Vector3<T> {
    let phase = point.x * T::of(0.5) + point.y * T::of(0.25) + T::of(step as f64 * 0.0625);
    let t = phase - phase.round();
    let height = t * (T::one() - T::of(4.0) * t * t) * T::of(0.05);
    point + Vector3::new(height * T::of(0.25), T::zero(), height)
}
