//! Triangle surfaces: refinement, surfaces of revolution, swept tubes.

use crate::common::shapes::Shape;
use nalgebra::Vector3;
use std::collections::HashMap;
use std::f64::consts::TAU;

/// A closed, outward-oriented surface.
#[derive(Clone, Debug, Default)]
pub struct Surface {
    pub positions: Vec<Vector3<f64>>,
    pub triangles: Vec<[u32; 3]>,
}

impl From<Shape> for Surface {
    fn from(shape: Shape) -> Self {
        Self { positions: shape.positions.into_iter().map(Vector3::from).collect(), triangles: shape.triangles }
    }
}

impl Surface {
    /// Every point moved by `map`, which must keep outside outside.
    pub fn map(mut self, map: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Self {
        self.positions.iter_mut().for_each(|point| *point = map(*point));
        self
    }

    /// Every triangle cut into `pieces`² alike.
    pub fn refined(&self, pieces: usize) -> Self {
        let mut finer = Self { positions: self.positions.clone(), triangles: Vec::new() };
        let mut numbers = HashMap::new();
        for corners in &self.triangles {
            // The point with the weights (i, j, pieces − i − j); neighbours know those on their shared edge by the same
            // sorted name, and compute them from it.
            let mut point = |i: usize, j: usize| {
                let mut parts: Vec<(u32, usize)> = corners.iter().copied().zip([i, j, pieces - i - j]).collect();
                parts.retain(|&(_, weight)| weight > 0);
                parts.sort_unstable();
                if let [(only, _)] = parts[..] {
                    return only;
                }
                let place = |sum: Vector3<f64>, &(vertex, weight): &(u32, usize)| {
                    sum + self.positions[vertex as usize] * (weight as f64 / pieces as f64)
                };
                let position = parts.iter().fold(Vector3::zeros(), place);
                *numbers.entry(parts).or_insert_with(|| {
                    finer.positions.push(position);
                    finer.positions.len() as u32 - 1
                })
            };
            for (i, j) in (0..pieces).flat_map(|i| (0..pieces - i).map(move |j| (i, j))) {
                finer.triangles.push([point(i + 1, j), point(i, j + 1), point(i, j)]);
                if i + j + 2 <= pieces {
                    finer.triangles.push([point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]);
                }
            }
        }
        finer
    }

    /// Rings of equally many points one after another, closed by a point at either end, all outward where the rings run
    /// counter-clockwise about the way from the first end to the last.
    fn of_rings(first: Vector3<f64>, rings: &[Vec<Vector3<f64>>], last: Vector3<f64>) -> Self {
        let across = rings[0].len();
        let mut surface = Self { positions: rings.concat(), triangles: Vec::new() };
        surface.positions.extend([first, last]);
        let [first, last] = [surface.positions.len() as u32 - 2, surface.positions.len() as u32 - 1];
        let index = |ring: usize, place: usize| (ring * across + place % across) as u32;
        for place in 0..across {
            surface.triangles.push([first, index(0, place + 1), index(0, place)]);
            for ring in 0..rings.len() - 1 {
                let [a, b] = [index(ring, place), index(ring, place + 1)];
                let [c, d] = [index(ring + 1, place + 1), index(ring + 1, place)];
                surface.triangles.extend([[a, b, c], [a, c, d]]);
            }
            surface.triangles.push([last, index(rings.len() - 1, place), index(rings.len() - 1, place + 1)]);
        }
        surface
    }
}

/// A spherical shell of outer radius 1, open above the polar angle `opening` in degrees, measured from the bottom.
pub fn shell(along: usize, around: usize, opening: f64, inner: f64) -> Surface {
    let ring = |radius: f64, step: usize| {
        let polar = (opening * step as f64 / along as f64).to_radians();
        let point = |place: usize| {
            let angle = TAU * place as f64 / around as f64;
            Vector3::new(polar.sin() * angle.cos(), polar.sin() * angle.sin(), -polar.cos()) * radius
        };
        (0..around).map(point).collect::<Vec<_>>()
    };
    let outer = (1..=along).map(|step| ring(1.0, step));
    let rings: Vec<_> = outer.chain((1..=along).rev().map(|step| ring(inner, step))).collect();
    Surface::of_rings(-Vector3::z(), &rings, -Vector3::z() * inner)
}

/// A tube wound three times about the axis z.
pub fn helix(pieces: usize, across: usize) -> Surface {
    const TURNS: f64 = 3.0;
    const RADIUS: f64 = 0.4;
    const RISE: f64 = 0.28;
    const TUBE: f64 = 0.08;
    let centre = |angle: f64| Vector3::new(RADIUS * angle.cos(), RADIUS * angle.sin(), RISE * angle / TAU);
    let ring = |piece: usize| {
        let angle = TAU * TURNS * piece as f64 / pieces as f64;
        let tangent = Vector3::new(-RADIUS * angle.sin(), RADIUS * angle.cos(), RISE / TAU).normalize();
        let side = Vector3::new(-angle.cos(), -angle.sin(), 0.0);
        let up = tangent.cross(&side);
        let point = |place: usize| {
            let turn = TAU * place as f64 / across as f64;
            centre(angle) + (side * turn.cos() + up * turn.sin()) * TUBE
        };
        (0..across).map(point).collect::<Vec<_>>()
    };
    let rings: Vec<_> = (0..=pieces).map(ring).collect();
    Surface::of_rings(centre(0.0), &rings, centre(TAU * TURNS))
}
