//! Bodies sunk into a slab of twelve triangles: Archimedes' force, k times the volume below the slab's top, straight up.

use super::Row;
use crate::support::shapes::{Shape, cuboid, icosphere, turn};
use crate::support::{Mode, Vector, limits, net_force, random};
use raycontact::mesh::Mesh;

fn slab() -> Mesh<f64> {
    cuboid([-5.0, -5.0, -5.0], [5.0, 5.0, 0.0]).mesh(|point| *point)
}

/// Round bodies, tilted at random, sunk to half or less: |F − k V| / k V.
pub fn measure(poses: usize, seed: u64) -> Vec<Row> {
    let ellipsoid = |axes: [f64; 3]| {
        let mut shape = icosphere(16);
        shape.points.iter_mut().for_each(|point| point.component_mul_assign(&Vector::from(axes)));
        shape
    };
    let (egg, lens) = (ellipsoid([1.0, 0.7, 0.5]), ellipsoid([1.0, 1.0, 0.25]));
    let mut rows = Vec::new();
    for (name, shape) in [("ball", icosphere(16)), ("ellipsoid", egg), ("lens", lens)] {
        for mode in [Mode::RayLength, Mode::Default, Mode::Accurate] {
            let mut random = random(seed);
            let errors = (0..poses.div_ceil(10)).map(|_| sunk(mode, &shape, &mut random)).collect();
            rows.push(Row { bodies: format!("{name} in a slab"), mode, errors, targets: [0.003; 3] });
        }
    }
    rows
}

fn sunk(mode: Mode, shape: &Shape, random: &mut impl FnMut() -> f64) -> f64 {
    let tilt = turn([random(), random(), random()], 3.0 * random());
    let turned: Vec<Vector> = shape.points.iter().map(|point| tilt * point).collect();
    let height = |sign: f64| turned.iter().map(|point| sign * point.z).fold(f64::MIN, f64::max);
    let (top, bottom) = (height(1.0), -height(-1.0));
    let part = 0.1 + 0.4 * (random() + 1.0) / 2.0;
    let by = -(bottom + part * (top - bottom));
    let body = shape.mesh(|point| tilt * point + Vector::z() * by);
    let force = net_force(mode, &body, &slab(), &Vector::zeros()).force;
    let truth = Vector::z() * limits::volume_below_zero(&body);
    (force - truth).norm() / truth.norm()
}

/// A box rolled by 3° on a plane, about either axis: the tangential over the normal force.
pub fn measure_rolled(poses: usize, seed: u64) -> Vec<Row> {
    let plate = || cuboid([-0.5, -0.5, -0.15], [0.5, 0.5, 0.15]);
    let mut rows = Vec::new();
    for (name, shape) in [("cube", cuboid([-0.5; 3], [0.5; 3])), ("plate", plate())] {
        for mode in [Mode::RayLength, Mode::Default, Mode::Accurate] {
            let mut random = random(seed);
            let one = |random: &mut dyn FnMut() -> f64| {
                let roll = turn([random(), random(), 0.0], 3f64.to_radians());
                let turn_up = turn([0.0, 0.0, 1.0], 3.0 * random());
                let lowest = shape.points.iter().map(|point| (roll * point).z).fold(f64::MAX, f64::min);
                let by = Vector::z() * (-lowest - 0.06 * (random() + 1.01) / 2.0);
                let force =
                    net_force(mode, &shape.mesh(|point| turn_up * (roll * point) + by), &slab(), &Vector::zeros())
                        .force;
                force.xy().norm() / force.z
            };
            let errors = (0..poses.div_ceil(5)).map(|_| one(&mut random)).collect();
            rows.push(Row { bodies: format!("{name} rolled by 3 degrees"), mode, errors, targets: [0.002; 3] });
        }
    }
    rows
}
