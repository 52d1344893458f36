use super::Cells;
use crate::math::Scalar;
use crate::mesh::Mesh;
use crate::ray::{Hit, PreparedRay, Ray, TriangleTest};

/// A mesh together with its up-to-date octree: what rays are traced in.
#[derive(Clone, Copy, Debug)]
pub struct Tracer<'a, T: Scalar> {
    cells: &'a Cells<T>,
    mesh: &'a Mesh<T>,
    test: TriangleTest,
}

impl<'a, T: Scalar> Tracer<'a, T> {
    pub(super) fn new(cells: &'a Cells<T>, mesh: &'a Mesh<T>) -> Self {
        Self { cells, mesh, test: TriangleTest::default() }
    }

    /// The same, deciding with another triangle test.
    pub fn with_test(self, test: TriangleTest) -> Self {
        Self { test, ..self }
    }

    /// The mesh.
    pub fn mesh(&self) -> &'a Mesh<T> {
        self.mesh
    }

    /// The first hit along the ray; at equal `t` the triangle with the smallest index. With the watertight test it is
    /// the same to the bit as [`nearest_hit_of_all`](Self::nearest_hit_of_all).
    pub fn nearest_hit(&self, ray: &Ray<T>) -> Option<Hit<T>> {
        let prepared = PreparedRay::new(ray, self.test);
        let mut nearest = None;
        self.visit(ray, &prepared, &mut |triangle| {
            self.keep_nearer(ray, &prepared, triangle, &mut nearest);
            nearest.map_or(ray.t_max, |hit| hit.t)
        });
        nearest
    }

    /// [`nearest_hit`](Self::nearest_hit) by testing every triangle, without the octree: slow, and the standard it is
    /// held to.
    pub fn nearest_hit_of_all(&self, ray: &Ray<T>) -> Option<Hit<T>> {
        let prepared = PreparedRay::new(ray, self.test);
        let mut nearest = None;
        for triangle in 0..self.mesh.topology().triangles().len() as u32 {
            self.keep_nearer(ray, &prepared, triangle, &mut nearest);
        }
        nearest
    }

    fn keep_nearer(&self, ray: &Ray<T>, prepared: &PreparedRay<T>, triangle: u32, nearest: &mut Option<Hit<T>>) {
        let hit = prepared.intersect(&self.mesh.corners(triangle), triangle);
        if let Some(hit) = hit.filter(|hit| hit.t <= ray.t_max && nearest.is_none_or(|n| hit.is_before(&n))) {
            *nearest = Some(hit);
        }
    }

    /// Whether the ray meets a triangle strictly before its `t_max`, not counting the triangles around `vertex`.
    pub fn is_hit_before_end(&self, ray: &Ray<T>, vertex: u32) -> bool {
        let prepared = PreparedRay::new(ray, self.test);
        let mut found = false;
        self.visit(ray, &prepared, &mut |triangle| {
            found |= !self.mesh.topology().triangles()[triangle as usize].contains(&vertex)
                && prepared.intersect(&self.mesh.corners(triangle), triangle).is_some_and(|hit| hit.t < ray.t_max);
            if found { -T::INFINITY } else { ray.t_max }
        });
        found
    }

    /// Offers every triangle that the ray may meet up to the `t` that `visitor` last returned, perhaps several times.
    fn visit(&self, ray: &Ray<T>, prepared: &PreparedRay<T>, visitor: &mut impl FnMut(u32) -> T) {
        match self.cells {
            Cells::Wide(cells) => cells.visit(ray, prepared, self.mesh.aabb(), visitor),
            Cells::Classic(cells) => cells.visit(ray, self.mesh.aabb(), visitor),
        }
    }
}
