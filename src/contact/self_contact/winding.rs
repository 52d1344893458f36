//! How often a surface winds around a point just under it: the signs of the crossings of an inward ray (exit +1,
//! entry −1) sum to it.

use crate::contact::SurfacePoint;
use crate::contact::samples::Sample;
use crate::math::{Scalar, direction};
use crate::mesh::Mesh;
use crate::octree::Tracer;
use crate::ray::{Hit, Ray};

/// The inward ray of a sample through its own mesh, without an end.
pub(super) fn inward_ray<T: Scalar>(sample: &Sample<T>) -> Ray<T> {
    Ray::new(sample.point.position, -sample.normal)
}

/// The crossings of a ray from `start` with its own mesh, but for the triangles it starts from, into `crossings`; gives
/// the winding number under `start`.
pub(super) fn winding_number<T: Scalar>(
    tracer: &Tracer<'_, T>,
    ray: &Ray<T>,
    touched: [u32; 3],
    crossings: &mut Vec<Hit<T>>,
) -> i32 {
    let triangles = tracer.mesh().topology().triangles();
    tracer.crossings(ray, crossings);
    crossings.retain(|hit| !touched.iter().all(|vertex| triangles[hit.triangle as usize].contains(vertex)));
    crossings.iter().map(sign).sum()
}

/// Where a ray from inside first leaves a fold of the body: its first exit. Entries before it lead into further folds.
pub(super) fn way_out<T: Scalar>(crossings: &[Hit<T>]) -> Option<&Hit<T>> {
    crossings.iter().find(|hit| hit.is_exit)
}

/// The way out of another body, for a ray that starts inside it, whatever folds of it the ray enters first; `None` for one
/// that starts outside, and where the mesh is open: it has no inside.
pub(in crate::contact) fn way_out_past_folds<T: Scalar>(
    tracer: &Tracer<'_, T>,
    ray: &Ray<T>,
    crossings: &mut Vec<Hit<T>>,
) -> Option<Hit<T>> {
    if tracer.mesh().is_open() {
        return None;
    }
    tracer.crossings(&ray.until(T::INFINITY), crossings);
    let number: i32 = crossings.iter().map(sign).sum();
    way_out(crossings).filter(|_| number > 0).copied()
}

/// What a crossing adds to the winding number at the ray's origin.
fn sign<T: Scalar>(crossing: &Hit<T>) -> i32 {
    if crossing.is_exit { 1 } else { -1 }
}

/// The winding number under the middle of a triangle; `None` where the triangle has no normal.
pub(super) fn winding_under<T: Scalar>(
    tracer: &Tracer<'_, T>,
    triangle: u32,
    crossings: &mut Vec<Hit<T>>,
) -> Option<i32> {
    let mesh: &Mesh<T> = tracer.mesh();
    let normal = direction(&mesh.scaled_normal(triangle))?;
    let [a, b, c] = mesh.corners(triangle);
    let third = T::one() / T::of(3.0);
    let vertices = mesh.topology().triangles()[triangle as usize];
    let point = SurfacePoint { triangle, vertices, weights: [third; 3], position: (a + b + c) * third };
    let ray = Ray::new(point.position, -normal);
    Some(winding_number(tracer, &ray, vertices, crossings))
}

/// Whether a ray that starts under the surface has left its body before its end, folds of the body counted as one: where
/// the winding number along it has fallen below 1. A ray that does not start inside has, and any
/// of an open mesh, which has no inside.
pub(in crate::contact) fn leaves_body_before_end<T: Scalar>(
    tracer: &Tracer<'_, T>,
    ray: &Ray<T>,
    touched: [u32; 3],
    crossings: &mut Vec<Hit<T>>,
) -> bool {
    if tracer.mesh().is_open() {
        return true;
    }
    let mut number = winding_number(tracer, &ray.until(T::INFINITY), touched, crossings);
    let mut before_end = crossings.iter().take_while(|hit| hit.t < ray.t_max);
    number < 1
        || before_end.any(|hit| {
            number -= sign(hit);
            number < 1
        })
}
