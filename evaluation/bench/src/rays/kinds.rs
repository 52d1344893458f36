//! What rays.

use crate::Vector;
use nalgebra::Vector3;
use raycontact::capi::rayc_ray;
use raycontact::mesh::Mesh;

/// In single precision, so that all trace the same.
#[derive(Clone, Copy)]
pub struct Ray {
    pub origin: [f32; 3],
    pub direction: [f32; 3],
}

impl From<&Ray> for rayc_ray {
    fn from(ray: &Ray) -> Self {
        Self { origin: ray.origin.map(f64::from), direction: ray.direction.map(f64::from), t_max: f64::INFINITY }
    }
}

pub struct Kind {
    pub name: &'static str,
    /// Whether neighbours in the list go nearly the same way.
    pub is_coherent: bool,
    pub rays: Vec<Ray>,
}

/// Rays that meet the first mesh, some of them from the second.
pub fn all(mesh: &Mesh<f32>, other: &Mesh<f32>, count: usize) -> Vec<Kind> {
    vec![
        Kind { name: "image", is_coherent: true, rays: image(mesh, count) },
        Kind { name: "deep", is_coherent: true, rays: inward(mesh, other) },
        Kind { name: "random", is_coherent: false, rays: random(mesh, count) },
    ]
}

fn ray(origin: Vector, direction: Vector) -> Ray {
    Ray { origin: origin.cast::<f32>().into(), direction: direction.cast::<f32>().into() }
}

/// The lower corner and the sides of the box around the mesh.
fn corner_and_sides(mesh: &Mesh<f32>) -> [Vector; 2] {
    let aabb = mesh.aabb();
    [aabb.lower.cast(), (aabb.upper - aabb.lower).cast()]
}

/// An image of the surface, seen aslant from without, line by line.
fn image(mesh: &Mesh<f32>, count: usize) -> Vec<Ray> {
    let [lower, sides] = corner_and_sides(mesh);
    let size = sides.max();
    let side = (count as f64).sqrt() as usize;
    let forward = Vector::new(-0.5, -0.6, -0.62).normalize();
    let right = forward.cross(&Vector::z()).normalize();
    let up = right.cross(&forward);
    let eye = lower + sides / 2.0 - forward * (2.0 * size);
    let at = |index: usize| (index as f64 + 0.5) / side as f64 - 0.5;
    let line = |row: usize| {
        (0..side).map(move |column| {
            let aim = forward * (2.0 * size) + right * (at(column) * size) + up * (at(row) * size);
            ray(eye, aim.normalize())
        })
    };
    (0..side).flat_map(line).collect()
}

/// Inward along the normals of the vertices of another surface that are in the box around this one, in their order: what the
/// detection of contacts traces where bodies lie deep in one another.
fn inward(mesh: &Mesh<f32>, other: &Mesh<f32>) -> Vec<Ray> {
    let vertices = (0u32..).zip(other.positions()).filter(|(_, position)| mesh.aabb().contains(position));
    let inward = |(vertex, position): (u32, &Vector3<f32>)| {
        other.vertex_normal(vertex).map(|normal| ray(position.cast(), -normal.normal.cast()))
    };
    vertices.filter_map(inward).collect()
}

/// From anywhere in the box around the mesh to anywhere.
fn random(mesh: &Mesh<f32>, count: usize) -> Vec<Ray> {
    let [lower, sides] = corner_and_sides(mesh);
    let mut random = fastrand::Rng::with_seed(7);
    let mut point = || Vector::from_fn(|_, _| random.f64());
    let mut one = || {
        let origin = lower + sides.component_mul(&point());
        loop {
            let direction = point() * 2.0 - Vector::repeat(1.0);
            let length = direction.norm();
            if (0.1..=1.0).contains(&length) {
                return ray(origin, direction / length);
            }
        }
    };
    (0..count).map(|_| one()).collect()
}
