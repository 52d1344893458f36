//! Quasi-static rigid motion: no masses and no velocities, each step goes where the contacts want the bodies.

use super::body::Body;
use nalgebra::{DMatrix, DVector, UnitQuaternion, Vector3};

/// A wish: body 0 should move by `depth` along `direction` at the first point, against body 1 at the second.
#[derive(Clone, Copy, Debug)]
pub struct Push {
    pub bodies: [usize; 2],
    pub points: [Vector3<f64>; 2],
    pub direction: Vector3<f64>,
    pub depth: f64,
    pub weight: f64,
}

/// How much a motion costs beside the contacts' weights.
const INERTIA: f64 = 0.05;
/// The longest way of any point in one step, in the body's sizes.
const LONGEST_STEP: f64 = 0.1;
/// How far beyond mere touching bodies are moved, in sizes of the smaller: without it they would come ever nearer to
/// touching, and the last rounding would decide.
const CLEARANCE: f64 = 1e-3;

/// Minimises Σ weight (J q − depth)² + 0.05 W |q|² over a shift and a turn of each body, W being the weights that act on
/// it, and moves the bodies by q, cut to the longest step. Turns count by the way of the body's outermost points.
/// Gives the longest way, in sizes.
pub fn step(bodies: &mut [Body], pushes: &[Push], round: impl Fn(f64) -> f64 + Copy) -> f64 {
    let count = 6 * bodies.len();
    let mut matrix = DMatrix::<f64>::zeros(count, count);
    let mut wanted = DVector::<f64>::zeros(count);
    for push in pushes {
        let row = [0, 1].map(|end| {
            let body = &bodies[push.bodies[end]];
            let along = push.direction * if end == 0 { 1.0 } else { -1.0 };
            let turn = (push.points[end] - body.centre).cross(&along) / body.radius();
            [along.x, along.y, along.z, turn.x, turn.y, turn.z]
        });
        let size = push.bodies.map(|body| bodies[body].size);
        let depth = push.depth + CLEARANCE * size[0].min(size[1]);
        let entries = || (0..12).map(|i| (6 * push.bodies[i / 6] + i % 6, row[i / 6][i % 6]));
        for (i, x) in entries() {
            wanted[i] += push.weight * x * depth;
            matrix[(i, i)] += push.weight * INERTIA;
            for (j, y) in entries() {
                matrix[(i, j)] += push.weight * x * y;
            }
        }
    }
    // Bodies that nothing touches stay.
    (0..count).filter(|&i| matrix[(i, i)] == 0.0).collect::<Vec<_>>().into_iter().for_each(|i| matrix[(i, i)] = 1.0);
    let Some(factor) = matrix.cholesky() else { return 0.0 };
    let q = factor.solve(&wanted);

    let mut longest = 0.0;
    for (body, q) in bodies.iter_mut().zip(q.as_slice().chunks(6)) {
        let (shift, turn) = (Vector3::new(q[0], q[1], q[2]), Vector3::new(q[3], q[4], q[5]));
        let way = (shift.norm() + turn.norm()) / body.size;
        let share = if way > LONGEST_STEP { LONGEST_STEP / way } else { 1.0 };
        longest = f64::max(longest, way * share);
        body.centre += shift * share;
        body.rotation = UnitQuaternion::new(turn * (share / body.radius())) * body.rotation;
        body.rotation.renormalize();
        body.place(round);
    }
    longest
}
