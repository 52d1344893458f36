//! A nut on a bolt: threads that overlap by less than an edge is long, everywhere around. As the nut is screwed along, the force
//! stays.

use super::Row;
use crate::support::shapes::{Shape, turn};
use crate::support::{Mode, Vector, net_force, sampled_net_force};
use raycontact::contact::Sampling;
use std::collections::HashMap;
use std::f64::consts::TAU;

const RADIUS: f64 = 1.0;
/// How far the thread rises, and how long one turn of it is.
const HEIGHT: f64 = 0.15;
const PITCH: f64 = 0.3;
/// How far the flanks overlap along the axis.
const OVERLAP: f64 = 0.02;
/// Edges along one turn of the thread's profile.
const PROFILE: usize = 8;
/// Samples of the judge lie this far apart: some hundred thousand.
const DENSE: f64 = 0.01;
/// So many places on the way of a whole turn: a prime, so that at none the facets meet as at another.
const PLACES: usize = 17;

/// The error of the axial force to that of dense samples, and how far it is from its mean on the way.
pub fn measure(_poses: usize, _seed: u64) -> Vec<Row> {
    let (bolt, nut) = (bolt(64, 8), nut(48, 3));
    let still = bolt.mesh(|point| *point);
    let mut forces = Vec::new();
    let mut errors = Vec::new();
    for place in 0..PLACES {
        let part = place as f64 / PLACES as f64;
        let turned = turn([0.0, 0.0, 1.0], TAU * part);
        let by = Vector::z() * (PITCH * (part - 0.5) + OVERLAP);
        let nut = nut.mesh(|point| turned * point + by);
        let force = net_force(Mode::Default, &nut, &still, &Vector::zeros()).force.z;
        let dense = sampled_net_force(Sampling::Spacing(DENSE), &nut, &still).force.z;
        errors.push((force - dense).abs() / dense.abs());
        forces.push(force);
    }
    let mean = forces.iter().sum::<f64>() / PLACES as f64;
    let variation = forces.iter().map(|force| (force - mean).abs() / mean.abs()).collect();
    let row =
        |bodies: &str, errors, target| Row { bodies: bodies.into(), mode: Mode::Default, errors, targets: [target; 3] };
    vec![row("nut on a bolt", errors, 0.02), row("nut on a bolt (to its mean as it is screwed)", variation, 0.03)]
}

/// Points on a thread of so many turns: `sides` around, then along; edges follow the thread.
fn thread(sides: usize, turns: usize, radius: impl Fn(f64) -> f64) -> Shape {
    let along = turns * PROFILE + 1;
    let middle = turns as f64 / 2.0;
    let mut points = Vec::new();
    for side in 0..=sides {
        let part = side as f64 / sides as f64;
        for place in 0..along {
            let turns = place as f64 / PROFILE as f64;
            // From 0 to 1 and back along each turn.
            let rise = 1.0 - (2.0 * turns.fract() - 1.0).abs();
            let (sin, cos) = (TAU * part).sin_cos();
            points.push(Vector::new(radius(rise) * cos, radius(rise) * sin, PITCH * (turns + part - middle - 0.5)));
        }
    }
    // Once around, a point is one turn further on.
    let corner = |side: usize, place: usize| {
        if side == sides && place + PROFILE < along { place + PROFILE } else { side * along + place }
    };
    let mut triangles = Vec::new();
    for side in 0..sides {
        for place in 0..along - 1 {
            let [a, b] = [corner(side, place), corner(side + 1, place)];
            let [c, d] = [corner(side + 1, place + 1), corner(side, place + 1)];
            triangles.extend([[a, b, c], [a, c, d]].map(|corners| corners.map(|corner| corner as u32)));
        }
    }
    Shape { points, triangles }
}

/// The edges that belong to one triangle, turned around, each with the one that follows it.
fn border(triangles: &[[u32; 3]]) -> HashMap<u32, u32> {
    let mut edges: HashMap<(u32, u32), u32> = HashMap::new();
    let around = |&[a, b, c]: &[u32; 3]| [(a, b), (b, c), (c, a)];
    triangles.iter().flat_map(around).for_each(|edge| *edges.entry(edge).or_default() += 1);
    edges.keys().filter(|(a, b)| !edges.contains_key(&(*b, *a))).map(|&(a, b)| (b, a)).collect()
}

fn bolt(sides: usize, turns: usize) -> Shape {
    let mut shape = thread(sides, turns, |rise| RADIUS + HEIGHT * (rise - 0.5));
    let border = border(&shape.triangles);
    let middle = shape.points.len() as u32;
    let end = PITCH * turns as f64 / 2.0;
    shape.points.extend([Vector::z() * -end, Vector::z() * end]);
    for (&from, &to) in &border {
        let top = u32::from(shape.points[from as usize].z > 0.0);
        shape.triangles.push([from, to, middle + top]);
    }
    closed(shape)
}

fn nut(sides: usize, turns: usize) -> Shape {
    let inner = thread(sides, turns, |rise| RADIUS + HEIGHT * (rise - 0.5) + 0.002);
    let outer = thread(sides, turns, |_| 1.5 * RADIUS);
    let count = inner.points.len() as u32;
    let points = [inner.points, outer.points].concat();
    let mut triangles: Vec<[u32; 3]> = outer.triangles.iter().map(|corners| corners.map(|c| c + count)).collect();
    triangles.extend(inner.triangles.iter().map(|&[a, b, c]| [a, c, b]));
    for (&from, &to) in &border(&inner.triangles) {
        triangles.extend([[to, from, from + count], [to, from + count, to + count]]);
    }
    closed(Shape { points, triangles })
}

/// Without the points that no triangle uses, and in an order that does not change from run to run.
fn closed(shape: Shape) -> Shape {
    let mut numbers = vec![u32::MAX; shape.points.len()];
    let mut points = Vec::new();
    let mut triangles = shape.triangles;
    triangles.sort_unstable();
    for corner in triangles.iter_mut().flatten() {
        let number = &mut numbers[*corner as usize];
        if *number == u32::MAX {
            *number = points.len() as u32;
            points.push(shape.points[*corner as usize]);
        }
        *corner = *number;
    }
    let shape = Shape { points, triangles };
    assert!(
        border(&shape.triangles).is_empty() && shape.volume() > 0.0,
        "it is closed, and its triangles face outward"
    );
    shape
}
