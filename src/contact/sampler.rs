use super::cutter::Cutter;
use super::samples::{Sample, VERTEX, vertex_point};
use crate::math::{Aabb, Scalar, direction, length};
use crate::mesh::Mesh;
use crate::octree::Tracer;

/// Offers the samples of `mesh` inside `region`, which is the overlap box with a margin, in the order of its vertices or
/// triangles; without a cutter rays start at vertices.
pub(super) fn for_each_sample<T: Scalar>(
    mesh: &Mesh<T>,
    region: &Aabb<T>,
    cutter: Option<Cutter<'_, T>>,
    offer: impl FnMut(Sample<T>),
) {
    match cutter {
        Some(cutter) => on_faces(mesh, cutter, 0..mesh.topology().triangles().len() as u32, offer),
        None => at_vertices(mesh, region, mesh.topology().surface_vertices().iter().copied(), offer),
    }
}

/// The same, without a look at what the octree knows to lie elsewhere. The lists are room.
pub(super) fn for_each_sample_near<T: Scalar>(
    tracer: &Tracer<'_, T>,
    region: &Aabb<T>,
    cutter: Option<Cutter<'_, T>>,
    [groups, places]: [&mut Vec<u32>; 2],
    offer: impl FnMut(Sample<T>),
) {
    let mesh = tracer.mesh();
    match cutter {
        Some(cutter) if tracer.list_triangles_near(cutter.region, groups, places) => {
            on_faces(mesh, cutter, places.iter().copied(), offer);
        }
        None if tracer.list_vertices_near(region, groups, places) => {
            at_vertices(mesh, region, places.iter().copied(), offer);
        }
        cutter => for_each_sample(mesh, region, cutter, offer),
    }
}

fn at_vertices<T: Scalar>(
    mesh: &Mesh<T>,
    region: &Aabb<T>,
    vertices: impl Iterator<Item = u32>,
    mut offer: impl FnMut(Sample<T>),
) {
    for vertex in vertices.filter(|&vertex| region.contains(&mesh.position(vertex))) {
        if let Some(normal) = mesh.vertex_normal(vertex) {
            let point = vertex_point(mesh, vertex);
            offer(Sample { point, normal: normal.normal, area: normal.area, piece: VERTEX });
        }
    }
}

fn on_faces<T: Scalar>(
    mesh: &Mesh<T>,
    mut cutter: Cutter<'_, T>,
    triangles: impl Iterator<Item = u32>,
    mut offer: impl FnMut(Sample<T>),
) {
    for triangle in triangles {
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
