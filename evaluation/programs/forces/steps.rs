//! Over a thousand small steps of depth or of offset the force changes by little at each.

use super::Row;
use super::cubes_aside::cube;
use crate::support::shapes::{icosphere, turn};
use crate::support::{Mode, Vector, net_force};

const STEPS: usize = 1000;
const MOST: f64 = 0.005;

/// The jumps from step to step, over the range of the force on the way.
pub fn measure(_poses: usize, _seed: u64) -> Vec<Row> {
    let mut rows = Vec::new();
    let turned = turn([1.0, 2.0, 0.5], 0.7);
    let unturned = turn([0.0, 0.0, 1.0], 0.0);
    let round = |parts: usize| icosphere(parts).scaled(0.5);
    let down = |at: f64| Vector::new(0.001, 0.0, 1.0 - 0.3 * at);
    let across = |at: f64| Vector::new(0.6 * at, 0.0, 0.95);
    let over_the_edge = |at: f64| Vector::new(1.2 * at, 0.0, 0.9);
    type Way = fn(f64) -> Vector;
    let cases: [(&str, _, _, _, Way); 6] = [
        ("cubes of 12 sinking", cube(1), cube(1), unturned, down),
        ("cubes of 12 aside", cube(1), cube(1), unturned, across),
        ("cubes of 192 aside", cube(4), cube(4), unturned, across),
        ("turned cubes of 12 aside", cube(1), cube(1), turned, over_the_edge),
        ("ball over a cube's edge", round(8), cube(1), unturned, over_the_edge),
        ("balls of 1280 aside", round(8), round(8), turned, over_the_edge),
    ];
    for (name, upper, lower, turn, way) in cases {
        let lower = lower.mesh(|point| *point);
        for mode in [Mode::RayLength, Mode::Default] {
            let forces: Vec<Vector> = (0..=STEPS)
                .map(|step| {
                    let by = way(step as f64 / STEPS as f64);
                    net_force(mode, &upper.mesh(|point| turn * point + by), &lower, &Vector::zeros()).force
                })
                .collect();
            let range = (0..3)
                .map(|axis| {
                    let values = || forces.iter().map(|force| force[axis]);
                    values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
                })
                .fold(0.0, f64::max);
            let errors = forces.windows(2).map(|pair| (pair[1] - pair[0]).norm() / range).collect();
            rows.push(Row { bodies: name.into(), mode, errors, targets: [MOST; 3] });
        }
    }
    rows
}
