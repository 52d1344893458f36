//! Pressing runs: a loaded contact that has come to rest must not be taken for a jam. Two bodies that just touch slide
//! towards each other on a straight guide, without turning, so that they cannot slip past one another; a steady load
//! presses them together.

use super::body::{Body, Rest};
use super::judge::Judge;
use super::motion::Push;
use super::options::{Options, Precision};
use super::run::{Forces, MOST_STEPS};
use super::start;
use crate::random::Random;
use nalgebra::Vector3;
use raycontact::math::Scalar;
use rayon::prelude::*;

/// One run: whether the pair began to escape.
struct Run {
    shapes: [&'static str; 2],
    has_escaped: bool,
}

/// Makes the options' number of runs and prints the shares.
pub fn print(rests: &[Rest], options: &Options, load: f64) {
    let run = |number: u64| match options.precision {
        Precision::F32 => press::<f32>(rests, options, load, number),
        Precision::F64 => press::<f64>(rests, options, load, number),
    };
    let runs: Vec<Run> = (0..options.count).into_par_iter().map(run).collect();
    for shape in super::shapes::NAMES {
        let with_shape = || runs.iter().filter(|run| run.shapes.contains(&shape));
        let escaped = with_shape().filter(|run| run.has_escaped).count();
        println!("{shape:16} {:>6} runs {escaped:>6} escaped", with_shape().count());
    }
    let escaped = runs.iter().filter(|run| run.has_escaped).count();
    let share = 100.0 * escaped as f64 / runs.len().max(1) as f64;
    println!("pressed={} escaped={escaped} share={share:.2}%", runs.len());
}

fn press<T: Scalar>(rests: &[Rest], options: &Options, load: f64, number: u64) -> Run {
    let round = |x: f64| T::of(x).to_f64();
    let mut random = Random::new(options.seed, number);
    let (mut bodies, towards) = touching(rests, &mut random);
    bodies.iter_mut().for_each(|body| body.place(round));
    let volume = |body: &Body| body.rest.volume * body.size.powi(3);
    // The contacts' stiffness is 1, so against a flat face their force is the volume that overlaps.
    let load = load * volume(&bodies[0]).min(volume(&bodies[1]));
    let shapes = [bodies[0].rest.name, bodies[1].rest.name];
    let mut forces = Forces::<T>::new(options.mode, &bodies);
    for _ in 0..MOST_STEPS {
        let pushes = forces.find(&bodies);
        if forces.contacts.statistics.escapes_started > 0 {
            return Run { shapes, has_escaped: true };
        }
        let way = approach(&pushes, &towards, load);
        bodies[0].centre += towards * way;
        bodies[0].place(round);
    }
    Run { shapes, has_escaped: false }
}

/// How far the first body goes: it minimises ½ Σ weight (J q − depth)² + ½ 0.05 W q² − load · q, W being the sum of the
/// weights.
fn approach(pushes: &[Push], towards: &Vector3<f64>, load: f64) -> f64 {
    const INERTIA: f64 = 0.05;
    const LONGEST: f64 = 0.01;
    let (mut wanted, mut stiffness) = (load, 0.0);
    for push in pushes {
        let along = push.direction.dot(towards) * if push.bodies[0] == 0 { 1.0 } else { -1.0 };
        wanted += push.weight * along * push.depth;
        stiffness += push.weight * (along * along + INERTIA);
    }
    (wanted / stiffness).clamp(-LONGEST, LONGEST)
}

/// Two bodies that the next move of the first along the given direction brings to touch.
fn touching<'a>(rests: &'a [Rest], random: &mut Random) -> (Vec<Body<'a>>, Vector3<f64>) {
    let mut draw = || Body::new(random.pick(rests), random.between(0.8, 1.2), start::turn(random), Vector3::zeros());
    let mut bodies = vec![draw(), draw()];
    let towards = Vector3::from(random.direction());
    let far = bodies[0].radius() + bodies[1].radius();
    let mut is_apart = |distance: f64| {
        bodies[0].centre = -towards * distance;
        bodies[0].place(|x| x);
        Judge::default().all_apart(&bodies)
    };
    // The first touch on the way in, within a hundredth; then halved until it is exact enough.
    const STEPS: u32 = 100;
    let distances = (0..=STEPS).map(|step| far * (1.0 - f64::from(step) / f64::from(STEPS)));
    let mut inside = distances.into_iter().find(|&distance| !is_apart(distance)).unwrap_or(0.0);
    let mut outside = (inside + far / f64::from(STEPS)).min(far * 1.01);
    for _ in 0..20 {
        let middle = (inside + outside) / 2.0;
        if is_apart(middle) {
            outside = middle;
        } else {
            inside = middle;
        }
    }
    // Clear of what rounding to the library's precision could bring to overlap.
    is_apart(outside + far * 1e-4);
    (bodies, towards)
}
