//! Contacts for unit tests.

use super::{Contact, ContactKind, SurfacePoint};
use crate::math::Vector3;

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
