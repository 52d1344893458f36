//! The derivative of the forces with contacts found anew, as Newton's method needs it.
//!
//! A ray's contact pushes by k · area · distance along the inward normal of its part of the surface. So with the positions
//! change: the distance, along the line to the nearest point; the area and the normal; and where the ray ends on the other
//! surface. Samples keep their places on their triangles. The halving of elements, by accuracy, is held: what it changes is
//! within the error that was asked for, but its derivative is not small.

use super::{BodiesMut, PenaltyLaw, Spring, Vectors};
use crate::contact::{Contact, ContactKind, ContactList};
use crate::math::{Scalar, Vector3, direction, length};
use crate::mesh::Mesh;
use crate::query::Tracer;

/// What a contact is between, where the contacts were found: the body that casts and the other one.
pub(crate) struct Between<'a, T: Scalar> {
    pub(crate) own: &'a Mesh<T>,
    pub(crate) other: Tracer<'a, T>,
    /// Whether the push grows with the distance to the nearest point, or with that to the plane in which the ray ends.
    pub(crate) measures_distances: bool,
}

/// How much the forces of one contact change.
struct Change<T: Scalar> {
    force: Vector3<T>,
    /// Of the weights at the end of the ray.
    weights: [T; 3],
}

/// Adds what [`add_differential`](super::add_differential) does, of contacts found anew. `between` gives what each is between.
pub(crate) fn add_whole_differential<'a, T: Scalar, P: Vectors<T>, F: BodiesMut<T> + ?Sized>(
    list: &ContactList<T>,
    law: &PenaltyLaw,
    [stiffness_factor, damping_factor]: [f64; 2],
    displacements: &[P],
    forces: &mut F,
    mut between: impl FnMut(&Contact<T>) -> Between<'a, T>,
) {
    let [factor, damping] = [stiffness_factor, damping_factor * law.damping_time()].map(T::of);
    for contact in &list.contacts {
        let spring = Spring::new(list, contact, law);
        let held = |factor: T| contact.direction * (factor * spring.coefficient * spring.along(displacements));
        let change = (contact.kind == ContactKind::Ray).then(|| between(contact).change(contact, law, displacements));
        let Some(change) = change.flatten() else {
            spring.pull(held(factor + damping), forces);
            continue;
        };
        spring.pull(change.force * factor + held(damping), forces);
        if contact.spread == Default::default() {
            let force = contact.direction * (-factor * spring.coefficient * contact.depth);
            for (vertex, weight) in contact.p2.vertices.into_iter().zip(change.weights) {
                forces.add_to(contact.collided, vertex, force * weight);
            }
        }
    }
}

impl<T: Scalar> Between<'_, T> {
    /// How a contact changes with these displacements; `None` where the triangle in which the ray ends has no normal, or there is
    /// no depth.
    fn change<P: Vectors<T>>(&self, contact: &Contact<T>, law: &PenaltyLaw, displacements: &[P]) -> Option<Change<T>> {
        let Contact { colliding, collided, p1, p2, depth, .. } = *contact;
        let moved = |body: u32, vertices: [u32; 3], weights: [T; 3]| {
            let field = &displacements[body as usize];
            vertices.into_iter().zip(weights).fold(Vector3::zeros(), |sum, (v, weight)| sum + field.get(v) * weight)
        };
        let start = moved(colliding, p1.vertices, p1.weights);
        let plane = Plane::new(p2.vertices.map(|vertex| self.other.mesh().position(vertex)))?;
        let distance_change = if self.measures_distances {
            // No farther than where the ray ends, but for rounding.
            let nearest = self.other.closest_point(&p1.position, depth + depth)?;
            let vertices = self.other.mesh().topology().triangles()[nearest.triangle as usize];
            let away = direction(&(nearest.position - p1.position)).unwrap_or(plane.normal);
            away.dot(&(moved(collided, vertices, nearest.weights) - start))
        } else {
            let foot = p1.position + plane.normal * plane.normal.dot(&(p2.position - p1.position));
            let shift = plane.weights(&(foot - p2.position));
            let weights = [0, 1, 2].map(|corner| p2.weights[corner] + shift[corner]);
            plane.normal.dot(&(moved(collided, p2.vertices, weights) - start))
        };
        let (area_change, turning) = self.element_change(contact, &displacements[colliding as usize]);
        let push = law.coefficient(contact) * depth;
        let area_change = if law.stiffness_of_area().is_some() { area_change } else { T::zero() };
        let push_change = law.weighted_stiffness(contact) * distance_change + push * area_change;
        let force = contact.direction * push_change + turning * push;
        // The end of the ray moves with its start and its direction, and slides along the ray into the triangle's plane.
        let shift = start + turning * depth - moved(collided, p2.vertices, p2.weights);
        let slide = plane.normal.dot(&shift) / plane.normal.dot(&contact.direction);
        Some(Change { force, weights: plane.weights(&(shift - contact.direction * slide)) })
    }

    /// The relative change of the area that a contact stands for, and the change of its direction.
    fn element_change<V: Vectors<T>>(&self, contact: &Contact<T>, field: &V) -> (T, Vector3<T>) {
        let (mesh, point) = (self.own, &contact.p1);
        let (mut area, mut area_change) = (T::zero(), T::zero());
        let (mut vector, mut vector_change) = (Vector3::zeros(), Vector3::zeros());
        let mut add = |triangle: u32| {
            let vertices = mesh.topology().triangles()[triangle as usize];
            let [a, b, c] = vertices.map(|vertex| mesh.position(vertex));
            let [u, v, w] = vertices.map(|vertex| field.get(vertex));
            let normal = (b - a).cross(&(c - a));
            let change = (v - u).cross(&(c - a)) + (b - a).cross(&(w - u));
            area += length(&normal);
            area_change += direction(&normal).map_or(T::zero(), |unit| unit.dot(&change));
            vector += normal;
            vector_change += change;
        };
        match contact.piece {
            0 => mesh.topology().triangles_around(point.vertices[0]).iter().for_each(|&triangle| add(triangle)),
            piece if piece >> 31 == 0 => add(point.triangle),
            piece => {
                let patches = mesh.patches();
                let patch = patches.named(!piece, point.triangle);
                patch.iter().flat_map(|&patch| patches.triangles_of(patch)).for_each(|&triangle| add(triangle));
            }
        }
        let size = length(&vector);
        if size == T::zero() {
            return (T::zero(), Vector3::zeros());
        }
        let inward = vector_change * (-T::one() / size);
        let growth = inward.dot(&contact.direction);
        // A vertex has a third of the areas around it, an element its areas added as vectors.
        let area_change = if contact.piece > 0 { growth } else { area_change / area };
        (area_change, inward - contact.direction * growth)
    }
}

/// The plane of the triangle in which a ray ends.
struct Plane<T: Scalar> {
    edges: [Vector3<T>; 2],
    /// Outward.
    normal: Vector3<T>,
    doubled_area: T,
}

impl<T: Scalar> Plane<T> {
    fn new([a, b, c]: [Vector3<T>; 3]) -> Option<Self> {
        let edges = [b - a, c - a];
        let scaled = edges[0].cross(&edges[1]);
        Some(Self { edges, normal: direction(&scaled)?, doubled_area: length(&scaled) })
    }

    /// How the barycentric weights of a point of the plane change where it moves so far.
    fn weights(&self, shift: &Vector3<T>) -> [T; 3] {
        let second = shift.cross(&self.edges[1]).dot(&self.normal) / self.doubled_area;
        let third = self.edges[0].cross(shift).dot(&self.normal) / self.doubled_area;
        [-second - third, second, third]
    }
}
