//! The triangles around each vertex of a surface: whether they cover a plane once, or fold over.

use crate::math::{Scalar, Vector3, direction, length, margins};
use crate::mesh::Mesh;
use crate::self_contact::nearness::rounding;

/// A triangle as its fans see it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facet<T: Scalar> {
    scaled_normal: Vector3<T>,
    /// Twice its area.
    pub(crate) area: T,
    pub(crate) longest_edge: T,
}

impl<T: Scalar> Facet<T> {
    pub(crate) fn new(corners: &[Vector3<T>; 3]) -> Self {
        let [a, b, c] = corners;
        let longest = (b - a).norm_squared().max((c - b).norm_squared()).max((a - c).norm_squared());
        let scaled_normal = (b - a).cross(&(c - a));
        Self { scaled_normal, area: length(&scaled_normal), longest_edge: longest.sqrt() }
    }
}

/// Fans seen as flatter than this touch.
pub(crate) fn least_altitude<T: Scalar>(mesh: &Mesh<T>) -> T {
    rounding(mesh) * T::of(margins::ALTITUDE_OF_FAN)
}

/// Looks along the mean normal of the triangles around a vertex. If each is seen from outside and they go around only once,
/// they cover a plane once, and none crosses another. Returns the least altitude of a triangle seen so, 0 if they do not,
/// and the least cosine between its normal and the line of sight.
pub(crate) fn altitude_of_fan<T: Scalar>(mesh: &Mesh<T>, vertex: u32, facet: impl Fn(u32) -> Facet<T>) -> (T, T) {
    let around = mesh.topology().triangles_around(vertex);
    let sum = around.iter().fold(Vector3::zeros(), |sum, &t| sum + facet(t).scaled_normal);
    let Some(axis) = direction(&sum) else { return (T::zero(), T::zero()) };
    let corners = |triangle: u32| {
        let corners = mesh.topology().triangles()[triangle as usize];
        let first = if corners[0] == vertex { 0 } else { 1 + usize::from(corners[1] != vertex) };
        [1, 2].map(|i| mesh.position(corners[(first + i) % 3]) - mesh.position(vertex))
    };
    // In how many triangles does a direction within the first one lie?
    let [p, q] = corners(around[0]);
    let across = (p + q).cross(&axis);
    let mut turns = 0;
    let (mut least, mut least_cosine) = (T::INFINITY, T::INFINITY);
    for &triangle in around {
        let facet = facet(triangle);
        let seen = facet.scaled_normal.dot(&axis);
        let (altitude, cosine) = (seen / facet.longest_edge, seen / facet.area);
        least_cosine = if cosine >= least_cosine { least_cosine } else { cosine };
        // Written so that NaN becomes the least, and then 0.
        least = if altitude >= least { least } else { altitude };
        let [p, q] = corners(triangle);
        turns += u32::from(p.dot(&across) >= T::zero() && q.dot(&across) < T::zero());
    }
    if turns == 1 && least > T::zero() { (least, least_cosine) } else { (T::zero(), T::zero()) }
}

/// How far the triangles of a fan may be strained. They are seen at no less than `cosine`, and `part` is the least altitude that
/// is allowed as a part of theirs.
///
/// The strain s of a triangle is the Frobenius norm of F − 1, where F maps the triangle's plane from rest. Its scaled normal
/// changes by at most √2 s + s²/2 of its length, less than 1.665 s for s up to ½, and edges grow by at most s of their length.
/// So its altitude as seen is still at least (1 − 1.665 s / cosine) / (1 + s) of what it was.
pub(crate) fn strain_of_fan<T: Scalar>(cosine: T, part: T) -> T {
    let most = T::of(margins::STRAIN) * (T::one() - part) * cosine / (cosine + T::of(1.67));
    // Written so that NaN counts as none.
    if most > T::zero() { most } else { T::zero() }
}

/// Around how many vertices the surface folds over.
pub(crate) fn count_folds<T: Scalar>(mesh: &Mesh<T>) -> usize {
    let altitude = |vertex: u32| altitude_of_fan(mesh, vertex, |triangle| Facet::new(&mesh.corners(triangle))).0;
    mesh.topology().surface_vertices().iter().filter(|&&vertex| altitude(vertex) == T::zero()).count()
}
