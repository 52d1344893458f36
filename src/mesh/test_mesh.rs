//! Meshes for unit tests.

use crate::cuboid::CUBOID_FACES;
use crate::math::{Aabb, Scalar, Vector3};
use crate::mesh::Mesh;
use std::f64::consts::TAU;

/// The positions of a torus of `around` × `across` squares that ripples from step to step; with a vertex of no triangle
/// far away.
pub(crate) fn torus_positions([around, across]: [u32; 2], step: u32) -> Vec<[f64; 3]> {
    let vertices = (0..around).flat_map(|i| (0..across).map(move |j| (i, j)));
    let at = |(i, j): (u32, u32)| {
        let (u, v) = (TAU * f64::from(i) / f64::from(around), TAU * f64::from(j) / f64::from(across));
        let radius = 1.0 + 0.3 * v.cos() + 0.02 * (5.0 * u + f64::from(step)).sin();
        [radius * u.cos(), radius * u.sin(), 0.3 * v.sin()]
    };
    vertices.map(at).chain([[9.0, 9.0, 9.0]]).collect()
}

/// That torus.
pub(crate) fn torus_at<T: Scalar>(sides: [u32; 2], step: u32) -> Mesh<T> {
    let positions: Vec<_> = torus_positions(sides, step).into_iter().map(|point| point.map(T::of)).collect();
    Mesh::new(&positions, &torus_triangles(sides)).expect("it is closed")
}

/// The same at step 0.
pub(crate) fn torus(sides: [u32; 2]) -> Mesh<f64> {
    torus_at(sides, 0)
}

/// The triangles of a torus of `around` × `across` vertices.
pub(crate) fn torus_triangles([around, across]: [u32; 2]) -> Vec<[u32; 3]> {
    let at = |i: u32, j: u32| i % around * across + j % across;
    let squares = (0..around).flat_map(|i| (0..across).map(move |j| (i, j)));
    let two = |(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    squares.flat_map(two).collect()
}

/// A cube of twice this half side.
pub(crate) fn cube_about<T: Scalar>(centre: impl Into<Vector3<T>>, half_side: f64) -> Aabb<T> {
    let (centre, half_side) = (centre.into(), T::of(half_side));
    Aabb { lower: centre.add_scalar(-half_side), upper: centre.add_scalar(half_side) }
}

/// A body of boxes, each from its lower to its upper corner; eight vertices of each, numbered along x first.
pub(crate) fn boxes(corners: &[[[f64; 3]; 2]]) -> Mesh<f64> {
    let corner = |k: usize| {
        let ends = corners[k / 8];
        [0, 1, 2].map(|axis| ends[k >> axis & 1][axis])
    };
    let positions: Vec<_> = (0..8 * corners.len()).map(corner).collect();
    let numbers = 0..corners.len() as u32;
    let triangles: Vec<_> = numbers.flat_map(|k| CUBOID_FACES.map(|face| face.map(|vertex| 8 * k + vertex))).collect();
    Mesh::new(&positions, &triangles).expect("they are closed")
}
