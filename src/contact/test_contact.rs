//! Contacts and bodies for unit tests.

use super::{Contact, ContactKind, SurfacePoint};
use crate::math::Vector3;
use crate::mesh::Mesh;

/// A contact of body 0 or 1 with the other, at a position.
pub(super) fn contact(
    colliding: u32,
    position: [f64; 3],
    direction: [f64; 3],
    [area, depth, cos_alpha]: [f64; 3],
) -> Contact<f64> {
    let [position, direction] = [position, direction].map(Vector3::from);
    let point = SurfacePoint { triangle: 0, vertices: [0; 3], weights: [0.0; 3], position };
    let (kind, collided) = (ContactKind::Ray, 1 - colliding);
    Contact { kind, colliding, collided, p1: point, p2: point, direction, depth, cos_alpha, area }
}

/// A body of boxes, each from its lower to its upper corner; eight vertices of each, numbered along x first.
pub(super) fn boxes(corners: &[[[f64; 3]; 2]]) -> Mesh<f64> {
    const FACES: [[u32; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let corner = |k: usize| {
        let ends = corners[k / 8];
        [0, 1, 2].map(|axis| ends[k >> axis & 1][axis])
    };
    let positions: Vec<_> = (0..8 * corners.len()).map(corner).collect();
    let faces = (0..corners.len() as u32).flat_map(|k| FACES.map(|face| face.map(|vertex| 8 * k + vertex)));
    let triangles: Vec<_> = faces.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh::new(&positions, &triangles).expect("they are closed")
}
