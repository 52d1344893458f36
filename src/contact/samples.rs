use super::SurfacePoint;
use crate::math::{Aabb, Scalar, Vector3};
use crate::mesh::Mesh;

/// A surface point that casts a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample<T: Scalar> {
    pub(super) point: SurfacePoint<T>,
    /// Outward, of unit length.
    pub(super) normal: Vector3<T>,
    /// The surface it stands for.
    pub(super) area: T,
}

impl<T: Scalar> Sample<T> {
    /// The vertices that all triangles touching the point have in common: the point's own, those with a weight.
    pub(super) fn touched(&self) -> [u32; 3] {
        let [first, second, third] = self.point.vertices;
        let [_, b, c] = self.point.weights.map(|weight| weight != T::zero());
        [first, if b { second } else { first }, if c { third } else { first }]
    }
}

/// Offers a sample at each vertex of the surface inside `region`; returns how many have no normal.
pub(super) fn at_vertices<T: Scalar>(mesh: &Mesh<T>, region: &Aabb<T>, mut offer: impl FnMut(Sample<T>)) -> u64 {
    let mut without_normal = 0;
    for &vertex in mesh.topology().surface_vertices() {
        if !region.contains(&mesh.positions()[vertex as usize]) {
            continue;
        }
        match mesh.vertex_normal(vertex) {
            Some(normal) => {
                offer(Sample { point: vertex_point(mesh, vertex), normal: normal.normal, area: normal.area })
            }
            None => without_normal += 1,
        }
    }
    without_normal
}

fn vertex_point<T: Scalar>(mesh: &Mesh<T>, vertex: u32) -> SurfacePoint<T> {
    let triangle = mesh.topology().triangles_around(vertex)[0];
    let mut vertices = mesh.topology().triangles()[triangle as usize];
    let place = vertices.iter().position(|&v| v == vertex).expect("triangle lies around its vertex");
    vertices.rotate_left(place);
    let weights = [T::one(), T::zero(), T::zero()];
    SurfacePoint { triangle, vertices, weights, position: mesh.positions()[vertex as usize] }
}
