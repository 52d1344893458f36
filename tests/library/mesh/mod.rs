//! Surfaces: files, orientation, and what no mesh can have.

mod holes;
mod obj_files;
mod orientation;
mod refused_numbers;

use crate::common::shapes;
use raycontact::math::Scalar;

/// Each triangle gives a third of its area to each corner, in sizes too whose squared areas underflow.
fn areas_of_vertices_add_up<T: Scalar>() {
    for exponent in [0, -30] {
        let size = f64::exp2(f64::from(exponent));
        let mesh = shapes::cube(3).scaled(size).mesh::<T>();
        let area_of = |vertex: usize| mesh.vertex_normal(vertex as u32).expect("it has one").area.to_f64();
        let sum: f64 = (0..mesh.positions().len()).map(area_of).sum();
        assert!((sum / (24.0 * size * size) - 1.0).abs() < 1e-5, "2^{exponent}: {sum:e}");
    }
}

#[test]
fn areas_of_vertices_add_up_to_the_surface() {
    areas_of_vertices_add_up::<f32>();
    areas_of_vertices_add_up::<f64>();
}
