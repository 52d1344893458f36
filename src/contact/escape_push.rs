use super::contact_point::Contact;
use crate::math::{Scalar, Vector3};
use crate::mesh::Mesh;

/// How an escaping pair is pushed as a whole, for hosts whose bodies are so soft that contacts would only draw them out:
/// the sum of the pair's contacts of kind `Escape`, spread evenly over all vertices of the two bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EscapePush<T: Scalar> {
    /// The pair; in a scene the smaller number comes first.
    pub bodies: [u32; 2],
    /// The direction in which the first body leaves the second, of unit length.
    pub direction: Vector3<T>,
    /// How far the two have to move apart along it, as far as the rays tell, > 0.
    pub depth: T,
    /// The area of the pair's contacts, together.
    pub area: T,
    /// How many they are.
    pub contact_count: u32,
    /// How many vertices either body has, used by triangles or not.
    pub vertex_counts: [u32; 2],
    /// The means of their positions at detection.
    pub centres: [Vector3<T>; 2],
}

impl<T: Scalar> EscapePush<T> {
    /// Of the pair's contacts.
    pub(super) fn new(
        bodies: [u32; 2],
        meshes: [&Mesh<T>; 2],
        direction: Vector3<T>,
        depth: T,
        contacts: &[Contact<T>],
    ) -> Self {
        Self {
            bodies,
            direction,
            depth,
            area: contacts.iter().fold(T::zero(), |sum, contact| sum + contact.area),
            contact_count: contacts.len() as u32,
            vertex_counts: meshes.map(|mesh| mesh.topology().vertex_count() as u32),
            centres: meshes.map(centre),
        }
    }
}

/// Summed from the box's lower corner, so that a body far from the origin loses nothing.
fn centre<T: Scalar>(mesh: &Mesh<T>) -> Vector3<T> {
    let base = mesh.aabb().lower;
    let count = mesh.topology().vertex_count();
    let sum = (0..count as u32).fold(Vector3::zeros(), |sum, vertex| sum + (mesh.position(vertex) - base));
    base + sum / T::of(count as f64)
}
