//! A body led around a closed path in contact, moved and turned, gets back what it gave: the net work over the greatest
//! energy stored on the way. Energies are work too, from where the bodies are apart.

use super::Row;
use super::cubes_aside::cube;
use crate::support::shapes::{Shape, cuboid, icosphere};
use crate::support::{Mode, Net, Vector, net_force, random};
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use std::f64::consts::TAU;

/// Steps of a path.
const STEPS: usize = 160;
/// Steps from where the bodies are apart to the path.
const WAY: usize = 60;

/// Net work of closed paths over the greatest energy on them.
pub fn measure(poses: usize, seed: u64) -> Vec<Row> {
    let mut rows = Vec::new();
    let spike = || {
        let points = [[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0], [0.0, 0.0, 1.5]];
        let triangles = [[0, 2, 1], [0, 3, 2], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]].to_vec();
        Shape { points: points.map(Vector::from).to_vec(), triangles }
    };
    let plate = || cuboid([-0.5, -0.5, -0.15], [0.5, 0.5, 0.15]);
    let pairs = [
        ("cubes", cube(1), cube(1)),
        ("plates", plate(), plate()),
        ("spike and cube", spike(), cube(1)),
        ("ball and cube", icosphere(8).scaled(0.5), cube(1)),
        ("balls", icosphere(6).scaled(0.5), icosphere(6).scaled(0.5)),
    ];
    for (name, first, second) in pairs {
        for mode in [Mode::RayLength, Mode::Default] {
            let mut random = random(seed);
            let errors = (0..poses.div_ceil(10)).map(|_| one(mode, &first, &second, &mut random)).collect();
            rows.push(Row { bodies: name.into(), mode, errors, targets: [0.01, 0.05, 0.05] });
        }
    }
    rows
}

pub fn random_vector(random: &mut impl FnMut() -> f64) -> Vector {
    loop {
        let vector = Vector::new(random(), random(), random());
        if (0.01..1.0).contains(&vector.norm_squared()) {
            return vector.normalize();
        }
    }
}

fn one(mode: Mode, first: &Shape, second: &Shape, random: &mut impl FnMut() -> f64) -> f64 {
    let still = second.mesh(|point| *point);
    let force_at = |pose: &Isometry3<f64>| {
        net_force(
            mode,
            &first.mesh(|point| pose.transform_point(&nalgebra::Point3::from(*point)).coords),
            &still,
            &pose.translation.vector,
        )
    };
    let away = random_vector(random);
    let start = UnitQuaternion::from_scaled_axis(random_vector(random) * (random() * 3.0));
    let at = |distance: f64| Isometry3::from_parts(Translation3::from(away * distance), start);
    // Where the bodies touch, from afar.
    let (mut apart, mut deep) = (2.5, 0.0);
    for _ in 0..30 {
        let middle = (apart + deep) / 2.0;
        if force_at(&at(middle)).force.norm() > 0.0 { deep = middle } else { apart = middle }
    }
    let centre = deep - 0.05 - 0.15 * (random() + 1.0) / 2.0;
    let (across, along) = (random_vector(random) * 0.06, random_vector(random) * 0.06);
    let (turn, other_turn) = (random_vector(random) * 0.1, random_vector(random) * 0.1);
    let on_path = |step: usize| {
        let (sin, cos) = (TAU * step as f64 / STEPS as f64).sin_cos();
        let turned = UnitQuaternion::from_scaled_axis(turn * sin + other_turn * (1.0 - cos));
        Isometry3::from_parts(Translation3::from(away * centre + across * sin + along * (1.0 - cos)), turned * start)
    };
    let way_in = (0..=WAY).map(|step| at(deep + (centre - deep) * step as f64 / WAY as f64));
    let mut energy = -work(&way_in.map(|pose| (pose, force_at(&pose))).collect::<Vec<_>>());
    let path: Vec<_> = (0..=STEPS).map(|step| (on_path(step), force_at(&on_path(step)))).collect();
    let mut greatest = energy;
    for step in 0..STEPS {
        energy -= work(&path[step..=step + 1]);
        greatest = greatest.max(energy);
    }
    work(&path).abs() / greatest
}

/// What the forces do on the way, by the trapezoidal rule.
fn work(way: &[(Isometry3<f64>, Net)]) -> f64 {
    way.windows(2)
        .map(|ends| {
            let [(from, first), (to, second)] = [&ends[0], &ends[1]];
            let moved = to.translation.vector - from.translation.vector;
            let turned = (to.rotation * from.rotation.inverse()).scaled_axis();
            (first.force + second.force).dot(&moved) / 2.0 + (first.torque + second.torque).dot(&turned) / 2.0
        })
        .sum()
}
