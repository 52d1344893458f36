use crate::math::{Scalar, Vector3};
use crate::mesh::Mesh;
use crate::ray::{Hit, Ray};

/// A point on a mesh's surface. It moves with its triangle: its position is the weighted sum of the three vertices'.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint<T: Scalar> {
    /// The triangle it lies on.
    pub triangle: u32,
    /// The triangle's corners. Where the point is a vertex, that vertex comes first.
    pub vertices: [u32; 3],
    /// Barycentric weights at `vertices`; they sum to 1. A vertex has 1, 0, 0.
    pub weights: [T; 3],
    /// Where it was at detection.
    pub position: Vector3<T>,
}

impl<T: Scalar> SurfacePoint<T> {
    /// The vertices that all triangles touching the point have in common: those with a weight.
    pub(super) fn touched(&self) -> [u32; 3] {
        let [first, second, third] = self.vertices;
        let [_, b, c] = self.weights.map(|weight| weight != T::zero());
        [first, if b { second } else { first }, if c { third } else { first }]
    }

    pub(super) fn of_hit(mesh: &Mesh<T>, ray: &Ray<T>, hit: &Hit<T>) -> Self {
        Self {
            triangle: hit.triangle,
            vertices: mesh.topology().triangles()[hit.triangle as usize],
            weights: hit.weights,
            position: ray.origin + ray.direction * hit.t,
        }
    }
}

/// How a contact came about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactKind {
    /// A ray along the inward normal leaves the other body before its own: the paper's contact.
    Ray,
    /// The same from the middle of an edge that pierces the other body, where no point of either surface does.
    Edge,
    /// The pair is escaping: `direction` is the pair's, `depth` is that of its deepest point, `cos_alpha` is 1.
    Escape,
}

/// A point of one surface inside another body, and the point of that body's surface to which it is pulled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<T: Scalar> {
    /// How it came about.
    pub kind: ContactKind,
    /// The body the ray starts from.
    pub colliding: u32,
    /// The body the ray ends on; the same for a contact of a body with itself.
    pub collided: u32,
    /// The ray's origin, on the colliding body.
    pub p1: SurfacePoint<T>,
    /// The ray's end, on the collided body.
    pub p2: SurfacePoint<T>,
    /// The ray's direction, from p1 to p2: the inward normal at p1, of unit length.
    pub direction: Vector3<T>,
    /// The distance from p1 to p2, ≥ 0.
    pub depth: T,
    /// What the depth is multiplied with in the pressure, in \[0, 1\]. Under [`ContactLaw::Pressure`](super::ContactLaw) the
    /// distance from p1 to the nearest point of the collided body over the depth, which beside a flat face is the cosine of
    /// the angle between the ray and the outward normal at p2; under [`ContactLaw::RayLength`](super::ContactLaw) that cosine.
    pub cos_alpha: T,
    /// The surface area the contact stands for: that of the ray's share of the surface, times the share of the load that
    /// the rays of this direction carry; the two directions' shares sum to 1.
    pub area: T,
}
