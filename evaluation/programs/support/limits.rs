//! What the forces should be: exact volumes, and the law on smooth surfaces.

use super::Vector;
use nalgebra::{Isometry3, Point3};
use raycontact::mesh::Mesh;
use std::f64::consts::{PI, TAU};

/// The volume of the part of a closed mesh below z = 0, exact: −∮ min(z, 0) n_z over the surface, triangle by triangle.
pub fn volume_below_zero(mesh: &Mesh<f64>) -> f64 {
    (0..mesh.topology().triangles().len() as u32)
        .map(|triangle| {
            let corners = mesh.corners(triangle);
            let mut below: Vec<Vector> = Vec::new();
            for i in 0..3 {
                let (from, to) = (corners[i], corners[(i + 1) % 3]);
                if from.z <= 0.0 {
                    below.push(from);
                }
                if from.z * to.z < 0.0 {
                    below.push(from + (to - from) * (from.z / (from.z - to.z)));
                }
            }
            (1..below.len().saturating_sub(1))
                .map(|i| {
                    let [a, b, c] = [below[0], below[i], below[i + 1]];
                    (b - a).cross(&(c - a)).z / 2.0 * (a.z + b.z + c.z) / 3.0
                })
                .sum::<f64>()
        })
        .sum()
}

/// The law on two unit spheres whose centres are `distance` apart along x: the force on the first, along x, for
/// stiffness 1. By symmetry both spheres' rays give the same, so their shares do not matter.
pub fn spheres(distance: f64) -> f64 {
    let steps = 100_000;
    let lowest = distance / 2.0;
    let width = (1.0 - lowest) / steps as f64;
    (0..steps)
        .map(|step| {
            // Archimedes' hat box: the area between two planes across x is 2π times their distance.
            let x = lowest + (step as f64 + 0.5) * width;
            let below_the_other = 1.0 - (1.0 + distance * distance - 2.0 * distance * x).sqrt();
            -x * below_the_other * TAU * width
        })
        .sum()
}

/// Radius of a torus's tube; that of its circle is 1.
pub const TUBE: f64 = 0.4;

/// The law on two smooth tori: force on the first and its moment about `about`, for stiffness 1, `samples` points along
/// each circle and half as many across. Both are as round, so either carries half of the load.
pub fn tori(poses: [&Isometry3<f64>; 2], about: &Vector, samples: usize) -> (Vector, Vector) {
    let first = one_way(poses[0], poses[1], about, samples);
    let second = one_way(poses[1], poses[0], about, samples);
    ((first.0 - second.0) / 2.0, (first.1 - second.1) / 2.0)
}

/// The pressure on one body's surface inside the other: force and moment.
fn one_way(from: &Isometry3<f64>, onto: &Isometry3<f64>, about: &Vector, samples: usize) -> (Vector, Vector) {
    let (around, across) = (samples, samples / 2);
    let (mut force, mut torque) = (Vector::zeros(), Vector::zeros());
    let to_local = onto.inverse();
    for i in 0..around {
        for j in 0..across {
            let (u, v) = (TAU * (i as f64 + 0.5) / around as f64, TAU * (j as f64 + 0.5) / across as f64);
            let normal = Vector::new(v.cos() * u.cos(), v.cos() * u.sin(), v.sin());
            let point = from * Point3::from(Vector::new(u.cos(), u.sin(), 0.0) + normal * TUBE);
            let local = to_local * point;
            let below_the_other = TUBE - (local.coords.xy().norm() - 1.0).hypot(local.z);
            if below_the_other > 0.0 {
                let area = TUBE * (1.0 + TUBE * v.cos()) * (2.0 * PI).powi(2) / (around * across) as f64;
                let push = from * normal * (-below_the_other * area);
                force += push;
                torque += (point.coords - about).cross(&push);
            }
        }
    }
    (force, torque)
}
