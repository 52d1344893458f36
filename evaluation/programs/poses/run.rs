//! One pose, from its start until the bodies are apart.

use super::body::Body;
use super::judge::Judge;
use super::motion::{self, Push};
use super::options::Mode;
use super::proximity::{self, Repulsion};
use nalgebra::Vector3;
use raycontact::contact::{ContactList, DetectionOptions, Statistics};
use raycontact::force::{PenaltyLaw, Weighting};
use raycontact::math::Scalar;
use raycontact::mesh::Mesh;
use raycontact::scene::Scene;

/// After so many steps a pose counts as stuck.
pub const MOST_STEPS: u32 = 200;
/// Further than this from its start, in its sizes, a body has exploded.
const FARTHEST: f64 = 10.0;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Separated,
    Stuck,
    Exploded,
}

/// What became of a pose, and after how many steps.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    pub outcome: Outcome,
    pub steps: u32,
}

/// Moves the bodies until they are apart; `log` is told of every step.
pub fn run<T: Scalar>(mode: Mode, bodies: &mut [Body], mut log: impl FnMut(&str)) -> Run {
    let round = |x: f64| T::of(x).to_f64();
    let starts: Vec<_> = bodies.iter().map(|body| body.centre).collect();
    bodies.iter_mut().for_each(|body| body.place(round));
    let mut forces = Forces::<T>::new(mode, bodies);
    let mut judge = Judge::default();
    for steps in 0..=MOST_STEPS {
        if judge.all_apart(bodies) {
            log(&format!("step {steps}: apart"));
            return Run { outcome: Outcome::Separated, steps };
        }
        let pushes = forces.find(bodies);
        let places = |bodies: &[Body]| bodies.iter().map(|body| (body.centre, body.rotation)).collect::<Vec<_>>();
        let before = places(bodies);
        let way = motion::step(bodies, &pushes, round);
        let deepest = pushes.iter().map(|push| push.depth).fold(0.0, f64::max);
        let statistics = forces.contacts.statistics;
        log(&format!("step {steps}: {} pushes, deepest {deepest:.3e}, moved {way:.3e} sizes", pushes.len()));
        log(&format!("    {}", forces.describe(&statistics)));
        describe_pairs(&pushes).iter().for_each(|line| log(line));
        let has_exploded = |(body, start): (&Body, &Vector3<f64>)| {
            let way = (body.centre - start).norm();
            way.is_nan() || way > FARTHEST * body.size.max(1.0)
        };
        if bodies.iter().zip(&starts).any(has_exploded) {
            return Run { outcome: Outcome::Exploded, steps };
        }
        // Without memory, what did not move now, or by less than a rounding, never will.
        if places(bodies) == before && mode != Mode::Default {
            break;
        }
    }
    Run { outcome: Outcome::Stuck, steps: MOST_STEPS }
}

/// How the first body of each pair is pushed, on the whole.
fn describe_pairs(pushes: &[Push]) -> Vec<String> {
    let mut pairs = std::collections::BTreeMap::new();
    for push in pushes {
        let [a, b] = push.bodies;
        let (count, sum) = pairs.entry([a.min(b), a.max(b)]).or_insert((0, Vector3::zeros()));
        *count += 1;
        *sum += push.direction * push.weight * if a < b { 1.0 } else { -1.0 };
    }
    let line = |([a, b], (count, sum)): ([usize; 2], (u32, Vector3<f64>))| {
        let [x, y, z] = sum.try_normalize(0.0).unwrap_or_default().into();
        format!("    bodies {a} and {b}: {count} pushes, {a} along ({x:.3}, {y:.3}, {z:.3})")
    };
    pairs.into_iter().map(line).collect()
}

/// Where the pushes come from.
pub struct Forces<T: Scalar> {
    mode: Mode,
    scene: Scene<T>,
    pub contacts: ContactList<T>,
    law: PenaltyLaw,
}

impl<T: Scalar> Forces<T> {
    pub fn new(mode: Mode, bodies: &[Body]) -> Self {
        let mut scene = Scene::new(1).expect("the caller's own thread needs no starting");
        let (options, weighting) = match mode {
            Mode::Paper => (DetectionOptions::paper(), Weighting::Vertex),
            _ => (DetectionOptions::default(), Weighting::Area),
        };
        scene.set_options(options);
        for body in bodies {
            let positions: Vec<[T; 3]> = body.positions.iter().map(|p| (*p).map(T::of).into()).collect();
            scene.add(Mesh::new(&positions, &body.rest.triangles).expect("every shape is closed and outward"));
        }
        let law = PenaltyLaw::new(1.0, 0.0, weighting).expect("the law is valid");
        Self { mode, scene, contacts: ContactList::default(), law }
    }

    pub fn find(&mut self, bodies: &[Body]) -> Vec<Push> {
        if self.mode == Mode::Proximity {
            return proximity::repulsions(bodies)
                .into_iter()
                .map(|Repulsion { bodies, points, direction, depth }| Push {
                    bodies,
                    points,
                    direction,
                    depth,
                    weight: 1.0,
                })
                .collect();
        }
        for (number, body) in bodies.iter().enumerate() {
            let mesh = self.scene.mesh_mut(number as u32).expect("every body was added");
            let position = |vertex: usize| body.positions[vertex].map(T::of);
            mesh.set_positions_with(body.positions.len(), position).expect("as many as before, and finite");
        }
        self.scene.query(&mut self.contacts);
        let push = |contact: &raycontact::contact::Contact<T>| Push {
            bodies: [contact.colliding as usize, contact.collided as usize],
            points: [&contact.p1, &contact.p2].map(|point| point.position.map(T::to_f64)),
            direction: contact.direction.map(T::to_f64),
            depth: contact.depth.to_f64(),
            weight: self.law.coefficient(contact).to_f64(),
        };
        self.contacts.contacts.iter().map(push).collect()
    }

    fn describe(&self, statistics: &Statistics) -> String {
        if self.mode == Mode::Proximity { String::new() } else { format!("{statistics:?}") }
    }
}
