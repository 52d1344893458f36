//! A unit cube set down a little beside the middle of another: the force has to be normal, but for the little that the
//! uneven edges make.

use super::Row;
use crate::support::shapes::{Shape, cuboid};
use crate::support::{Mode, Vector, net_force, random};
use raycontact::mesh::Mesh;

/// Cut into so many squares along an edge.
pub fn cube(parts: usize) -> Shape {
    let mut shape = cuboid([-0.5; 3], [0.5; 3]);
    for _ in 0..parts.ilog2() {
        shape = halved(&shape);
    }
    shape
}

/// Every triangle as four.
fn halved(shape: &Shape) -> Shape {
    let mut points = shape.points.clone();
    let mut known = std::collections::HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *known.entry((a.min(b), a.max(b))).or_insert_with(|| {
            points.push((points[a as usize] + points[b as usize]) * 0.5);
            points.len() as u32 - 1
        })
    };
    let mut triangles = Vec::new();
    for &[a, b, c] in &shape.triangles {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    Shape { points, triangles }
}

/// The largest lateral part as a part of what is allowed, 1.2 · d / (2 (1 − s)) for cubes d deep and aside by s.
pub fn measure(poses: usize, seed: u64) -> Vec<Row> {
    let mut rows = Vec::new();
    for parts in [1, 4, 16] {
        let (lower, shape) = (cube(parts).mesh(|point| *point), cube(parts));
        for mode in [Mode::RayLength, Mode::Default] {
            let mut random = random(seed);
            let count = if parts > 4 { poses.div_ceil(10) } else { poses };
            let errors = (0..count).map(|_| one(mode, &lower, &shape, &mut random)).collect();
            rows.push(Row { bodies: format!("cubes of {}", 12 * parts * parts), mode, errors, targets: [1.0; 3] });
        }
    }
    rows
}

fn one(mode: Mode, lower: &Mesh<f64>, shape: &Shape, random: &mut impl FnMut() -> f64) -> f64 {
    let mut unit = || (random() + 1.0) / 2.0;
    // Evenly over the orders of magnitude.
    let (aside, depth) = (0.001 * 500f64.powf(unit()), 0.01 * 10f64.powf(unit()));
    let upper = shape.mesh(|point| point + Vector::new(aside, 0.0, 1.0 - depth));
    let force = net_force(mode, &upper, lower, &Vector::zeros()).force;
    force.xy().norm() / force.z / (1.2 * depth / (2.0 * (1.0 - aside)))
}
