//! The winding number of a surface around a point just under it, from the crossings of an inward ray.

use crate::math::{Scalar, direction};
use crate::mesh::Mesh;
use crate::query::tracer::Tracer;
use crate::triangle::{Hit, Ray};

/// Lists the crossings of a ray with the mesh that it starts from, but for triangles with all `touched` vertices, and gives the
/// winding number just under its origin.
pub(crate) fn winding_number<T: Scalar>(
    tracer: &Tracer<'_, T>,
    ray: &Ray<T>,
    touched: [u32; 3],
    crossings: &mut Vec<Hit<T>>,
) -> i32 {
    let triangles = tracer.mesh().topology().triangles();
    tracer.crossings(ray, crossings);
    crossings.retain(|hit| !touched.iter().all(|vertex| triangles[hit.triangle as usize].contains(vertex)));
    crossings.iter().map(Hit::sign).sum()
}

/// The first exit of a ray from inside, where it leaves a fold of the body. Entries before it lead into further folds.
pub(crate) fn way_out<T: Scalar>(crossings: &[Hit<T>]) -> Option<&Hit<T>> {
    crossings.iter().find(|hit| hit.is_exit)
}

/// The way out of another body for a ray that starts inside it, even if the ray first enters other folds of that body. `None`
/// for a ray that starts outside, and for an open mesh, which has no inside.
pub(crate) fn way_out_past_folds<T: Scalar>(
    tracer: &Tracer<'_, T>,
    ray: &Ray<T>,
    crossings: &mut Vec<Hit<T>>,
) -> Option<Hit<T>> {
    if tracer.mesh().is_open() {
        return None;
    }
    tracer.crossings(&ray.until(T::INFINITY), crossings);
    let number: i32 = crossings.iter().map(Hit::sign).sum();
    way_out(crossings).filter(|_| number > 0).copied()
}

/// The winding number under the middle of a triangle; `None` where the triangle has no normal.
pub(crate) fn winding_under<T: Scalar>(
    tracer: &Tracer<'_, T>,
    triangle: u32,
    crossings: &mut Vec<Hit<T>>,
) -> Option<i32> {
    let mesh: &Mesh<T> = tracer.mesh();
    let normal = direction(&mesh.scaled_normal(triangle))?;
    let [a, b, c] = mesh.corners(triangle);
    let third = T::one() / T::of(3.0);
    let vertices = mesh.topology().triangles()[triangle as usize];
    let ray = Ray::new((a + b + c) * third, -normal);
    Some(winding_number(tracer, &ray, vertices, crossings))
}

/// Whether a ray that starts under the surface leaves its body before its end: whether the winding number along it falls below 1.
/// So all folds of the body count as one. True too for a ray that does not start inside, and for an open mesh, which has no
/// inside.
pub(crate) fn leaves_body_before_end<T: Scalar>(
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
            number -= hit.sign();
            number < 1
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vector3;
    use crate::mesh::test_mesh::boxes;
    use crate::query::octree::Octree;

    /// Two cubes in one mesh, the smaller inside the larger, far from the origin.
    fn nested() -> Mesh<f64> {
        boxes(&[[[18.0; 3], [22.0; 3]], [[19.0; 3], [21.0; 3]]])
    }

    #[test]
    fn the_surface_winds_once_under_the_outer_cube_and_twice_under_the_inner() {
        let mut mesh = nested();
        let mut octree = Octree::new(&mesh);
        let mut crossings = Vec::new();
        let tracer = octree.tracer(&mesh).expect("fresh");
        for triangle in 0..24 {
            let expected = if triangle < 12 { 1 } else { 2 };
            assert_eq!(winding_under(&tracer, triangle, &mut crossings), Some(expected), "{triangle}");
        }
        // A triangle without a normal.
        let flat: Vec<_> = mesh.positions().to_vec();
        mesh.set_positions_with(16, |vertex| flat[if vertex == 1 { 0 } else { vertex }]).expect("finite");
        octree.update(&mesh).expect("its own");
        let tracer = octree.tracer(&mesh).expect("up to date");
        let without = (0..24).filter(|&triangle| winding_under(&tracer, triangle, &mut crossings).is_none()).count();
        assert_eq!(without, 2, "those with both ends of the edge");
    }

    /// From under the outer cube's face into the inner cube and out again, to its other side.
    #[test]
    fn a_ray_leaves_the_body_where_it_leaves_the_last_fold() {
        let mesh = nested();
        let octree = Octree::new(&mesh);
        let tracer = octree.tracer(&mesh).expect("fresh");
        let ray = Ray::new(Vector3::new(17.9, 20.1, 20.2), Vector3::x());
        let leaves = |x: f64, end: f64| {
            let ray = Ray { origin: Vector3::new(x, 20.1, 20.2), ..ray }.until(end);
            leaves_body_before_end(&tracer, &ray, [u32::MAX; 3], &mut Vec::new())
        };
        // It starts outside; inside the outer cube alone; within both.
        assert!(leaves(17.9, 0.05));
        for (start, inside_until) in [(18.5, 22.0), (19.5, 22.0), (21.5, 22.0)] {
            let way: f64 = inside_until - start;
            assert!(!leaves(start, way - 0.01) && leaves(start, way + 0.01), "from {start}");
        }
        let out = |x: f64| {
            let ray = Ray { origin: Vector3::new(x, 20.1, 20.2), ..ray };
            way_out_past_folds(&tracer, &ray, &mut Vec::new()).map(|hit| hit.t)
        };
        // The first exit, if it starts inside.
        assert_eq!([out(17.5), out(18.5), out(19.5), out(21.5)], [None, Some(2.5), Some(1.5), Some(0.5)]);
        assert_eq!(out(22.5), None);
    }
}
