//! Contacts compared whatever the numbers of their bodies.

use raycontact::contact::Contact;
use raycontact::math::Scalar;

/// Both ends, direction and depth of a contact.
#[derive(Clone, Debug, PartialEq)]
pub struct Ends<T> {
    pub triangles: [u32; 2],
    pub vertices: [[u32; 3]; 2],
    pub weights: [[T; 3]; 2],
    pub direction: [T; 3],
    pub depth: T,
}

/// Where a body's triangles and vertices begin in a larger one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Offset {
    pub triangle: u32,
    pub vertex: u32,
}

/// The ends of a contact, whose colliding and collided body are parts of larger ones.
pub fn ends<T: Scalar>(contact: &Contact<T>, offsets: [Offset; 2]) -> Ends<T> {
    let points = [&contact.p1, &contact.p2];
    let with = |i: usize| (points[i], offsets[i]);
    Ends {
        triangles: [0, 1].map(|i| with(i).0.triangle + with(i).1.triangle),
        vertices: [0, 1].map(|i| with(i).0.vertices.map(|vertex| vertex + with(i).1.vertex)),
        weights: points.map(|point| point.weights),
        direction: contact.direction.into(),
        depth: contact.depth,
    }
}
