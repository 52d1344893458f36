//! What the forces should be: exact volumes, and the law on smooth surfaces.

use super::Vector;
use nalgebra::Isometry3;
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
            let start = Vector::new(x, (1.0 - x * x).sqrt(), 0.0);
            let direction = -start;
            let from_other = start - Vector::x() * distance;
            let half = from_other.dot(&direction);
            let depth = -half + (half * half - from_other.norm_squared() + 1.0).sqrt();
            let cos_alpha = (from_other + direction * depth).dot(&direction).clamp(0.0, 1.0);
            // The own surface lies at depth 2.
            if depth < 2.0 { depth * cos_alpha * direction.x * TAU * width } else { 0.0 }
        })
        .sum()
}

/// Radius of a torus's tube; that of its circle is 1.
pub const TUBE: f64 = 0.4;

/// One body's rays against another.
struct OneWay {
    force: Vector,
    torque: Vector,
    claim: f64,
}

/// The law on two smooth tori: force on the first and its moment about `about`, for stiffness 1, `samples` rays along
/// each circle and half as many across. The load is shared between the two as the library does.
pub fn tori(poses: [&Isometry3<f64>; 2], about: &Vector, samples: usize) -> (Vector, Vector) {
    let first = one_way(poses[0], poses[1], about, samples);
    let second = one_way(poses[1], poses[0], about, samples);
    let share = first.claim / (first.claim + second.claim);
    let mix = |a: Vector, b: Vector| a * share - b * (1.0 - share);
    (mix(first.force, second.force), mix(first.torque, second.torque))
}

fn one_way(from: &Isometry3<f64>, onto: &Isometry3<f64>, about: &Vector, samples: usize) -> OneWay {
    let (around, across) = (samples, samples / 2);
    let (mut force, mut torque) = (Vector::zeros(), Vector::zeros());
    let (mut depths, mut directions) = (0.0, Vector::zeros());
    let to_local = onto.inverse();
    for i in 0..around {
        for j in 0..across {
            let (u, v) = (TAU * (i as f64 + 0.5) / around as f64, TAU * (j as f64 + 0.5) / across as f64);
            let normal = Vector::new(v.cos() * u.cos(), v.cos() * u.sin(), v.sin());
            let start = from * nalgebra::Point3::from(Vector::new(u.cos(), u.sin(), 0.0) + normal * TUBE);
            let direction = -(from * normal);
            let ray = [(to_local * start).coords, to_local * direction];
            let Some((depth, cos_alpha)) = way_out(&ray) else { continue };
            // The tube's own far side.
            if depth >= 2.0 * TUBE {
                continue;
            }
            let area = TUBE * (1.0 + TUBE * v.cos()) * (2.0 * PI).powi(2) / (around * across) as f64;
            let pull = direction * (depth * cos_alpha * area);
            force += pull;
            torque += (start.coords - about).cross(&pull);
            depths += depth * area;
            directions += direction * (depth * area);
        }
    }
    OneWay { force, torque, claim: depths - directions.norm() }
}

/// Depth and cos α of a ray that starts inside the torus: the first root of its quartic
/// (|p|² + 1 − r²)² = 4 (x² + y²).
fn way_out(&[start, direction]: &[Vector; 2]) -> Option<(f64, f64)> {
    let (flat, flat_direction) = (start.xy(), direction.xy());
    let sum = [start.norm_squared() + 1.0 - TUBE * TUBE, 2.0 * start.dot(&direction), 1.0];
    let circle = [flat.norm_squared(), 2.0 * flat.dot(&flat_direction), flat_direction.norm_squared()];
    let quartic = [
        sum[0] * sum[0] - 4.0 * circle[0],
        2.0 * sum[0] * sum[1] - 4.0 * circle[1],
        sum[1] * sum[1] + 2.0 * sum[0] * sum[2] - 4.0 * circle[2],
        2.0 * sum[1] * sum[2],
        sum[2] * sum[2],
    ];
    if quartic[0] >= 0.0 {
        return None;
    }
    // A ray inside both tubes is out after less than the larger torus's width.
    let depth = roots(&quartic, 3.0).into_iter().find(|&t| t > 0.0)?;
    let end = start + direction * depth;
    let inward = end.xy().norm();
    let outward = Vector::new(end.x * (1.0 - 1.0 / inward), end.y * (1.0 - 1.0 / inward), end.z).normalize();
    Some((depth, outward.dot(&direction).clamp(0.0, 1.0)))
}

/// The roots of a polynomial (constant first) between 0 and `end`, ascending: its derivative's roots part it into
/// monotone stretches, each searched by bisection.
fn roots(polynomial: &[f64], end: f64) -> Vec<f64> {
    if polynomial.len() < 2 {
        return Vec::new();
    }
    let derivative: Vec<f64> = polynomial.iter().enumerate().skip(1).map(|(power, c)| c * power as f64).collect();
    let value = |t: f64| polynomial.iter().rev().fold(0.0, |sum, c| sum * t + c);
    let mut bounds = roots(&derivative, end);
    bounds.insert(0, 0.0);
    bounds.push(end);
    let mut found = Vec::new();
    for pair in bounds.windows(2) {
        let (mut low, mut high) = (pair[0], pair[1]);
        let rising = value(low) < 0.0;
        if rising == (value(high) < 0.0) {
            continue;
        }
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            if (value(middle) < 0.0) == rising { low = middle } else { high = middle }
        }
        found.push((low + high) / 2.0);
    }
    found
}
