use super::cutter::Cutter;
use super::samples::{Sample, vertex_point};
use crate::math::{Aabb, Scalar, direction, length};
use crate::mesh::Mesh;

/// Offers the samples of `mesh` inside `region`, which is the overlap box with a margin, in the order of its vertices or
/// triangles; without a cutter rays start at vertices.
pub(super) fn for_each_sample<T: Scalar>(
    mesh: &Mesh<T>,
    region: &Aabb<T>,
    cutter: Option<Cutter<'_, T>>,
    offer: impl FnMut(Sample<T>),
) {
    match cutter {
        Some(cutter) => on_faces(mesh, cutter, offer),
        None => at_vertices(mesh, region, offer),
    }
}

fn at_vertices<T: Scalar>(mesh: &Mesh<T>, region: &Aabb<T>, mut offer: impl FnMut(Sample<T>)) {
    for &vertex in mesh.topology().surface_vertices() {
        if !region.contains(&mesh.positions()[vertex as usize]) {
            continue;
        }
        if let Some(normal) = mesh.vertex_normal(vertex) {
            offer(Sample { point: vertex_point(mesh, vertex), normal: normal.normal, area: normal.area });
        }
    }
}

fn on_faces<T: Scalar>(mesh: &Mesh<T>, mut cutter: Cutter<'_, T>, mut offer: impl FnMut(Sample<T>)) {
    for triangle in 0..mesh.topology().triangles().len() as u32 {
        let corners = mesh.corners(triangle);
        if !Aabb::of_triangle(&corners).overlaps(cutter.region) {
            continue;
        }
        let scaled_normal = mesh.scaled_normal(triangle);
        if let Some(normal) = direction(&scaled_normal) {
            let area = length(&scaled_normal) * T::of(0.5);
            cutter.cut(mesh, triangle, normal, area, &mut |piece| offer(piece.sample));
        }
    }
}
