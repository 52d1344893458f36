//! Contacts, bodies and pairs of them for unit tests.

use crate::contact::options::DetectionOptions;
use crate::contact::pair::{Pair, overlap_region};
use crate::contact::point_pair::{Contact, ContactKind, SpreadNumber, SurfacePoint};
use crate::math::Vector3;
use crate::mesh::Mesh;
use crate::query::Octree;

/// A contact of body 0 or 1 with the other, at a position.
pub(crate) fn contact(
    colliding: u32,
    position: [f64; 3],
    direction: [f64; 3],
    [area, depth, cos_alpha]: [f64; 3],
) -> Contact<f64> {
    let [position, direction] = [position, direction].map(Vector3::from);
    let point = SurfacePoint { triangle: 0, vertices: [0; 3], weights: [0.0; 3], position };
    let (kind, collided, piece) = (ContactKind::Ray, 1 - colliding, 1);
    let spread = SpreadNumber::default();
    Contact { kind, colliding, collided, piece, p1: point, p2: point, direction, depth, cos_alpha, area, spread }
}

/// Asks about two meshes, bodies 0 and 1, where their boxes overlap.
pub(crate) fn with_pair<R>(
    meshes: [&Mesh<f64>; 2],
    options: &DetectionOptions<f64>,
    ask: impl FnOnce(&Pair<'_, f64>) -> R,
) -> R {
    let octrees = meshes.map(Octree::new);
    let tracers = [0, 1].map(|side| octrees[side].tracer(meshes[side]).expect("it is new"));
    let (overlap, region) = overlap_region(meshes[0].aabb(), meshes[1].aabb());
    let (bodies, tracers) = ([0, 1], [&tracers[0], &tracers[1]]);
    ask(&Pair::new(bodies, tracers, [&overlap, &region], options))
}
