use super::Cells;
use super::wide::PACKET_SIZE;
use crate::math::Scalar;
use crate::mesh::Mesh;
use crate::ray::{Hit, PreparedRay, Ray, ShearedRay, TriangleTest};
use std::cmp::Ordering;

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

    /// All crossings along the ray up to its end, nearest first, into `crossings`, which is cleared first. Where the
    /// ray has no end, their signs (exit +1, entry −1) sum to the winding number of the mesh at the origin: a ray
    /// through an edge or a vertex crosses the surface there as often as one that passes beside it. Always watertight.
    pub fn crossings(&self, ray: &Ray<T>, crossings: &mut Vec<Hit<T>>) {
        crossings.clear();
        let sheared = ShearedRay::new(ray);
        let prepared = PreparedRay::Watertight(sheared);
        self.visit(ray, &prepared, &mut |triangle| {
            let crossing = sheared.crossing(&self.mesh.corners(triangle), triangle);
            crossings.extend(crossing.filter(|hit| hit.t <= ray.t_max));
            ray.t_max
        });
        crossings.sort_unstable_by(|a, b| {
            a.t.partial_cmp(&b.t).unwrap_or(Ordering::Equal).then(a.triangle.cmp(&b.triangle))
        });
        // A triangle that lives in several cells was offered several times.
        crossings.dedup_by_key(|hit| hit.triangle);
    }

    /// [`nearest_hit`](Self::nearest_hit) of each of many rays, into `hits`, which is cleared first. Fastest where
    /// each 16 rays are neighbours.
    pub fn nearest_hits(&self, rays: &[Ray<T>], hits: &mut Vec<Option<Hit<T>>>) {
        hits.clear();
        hits.resize(rays.len(), None);
        for (rays, hits) in rays.chunks(PACKET_SIZE).zip(hits.chunks_mut(PACKET_SIZE)) {
            self.visit_packet(rays, &mut |place, prepared, triangle| {
                self.keep_nearer(&rays[place], prepared, triangle, &mut hits[place]);
                hits[place].map_or(rays[place].t_max, |hit| hit.t)
            });
        }
    }

    fn keep_nearer(&self, ray: &Ray<T>, prepared: &PreparedRay<T>, triangle: u32, nearest: &mut Option<Hit<T>>) {
        let hit = prepared.intersect(&self.mesh.corners(triangle), triangle);
        if let Some(hit) = hit.filter(|hit| hit.t <= ray.t_max && nearest.is_none_or(|n| hit.is_before(&n))) {
            *nearest = Some(hit);
        }
    }

    /// For each ray whether it meets a triangle strictly before its `t_max`; into `found`, which is cleared first. The
    /// triangles that have all three vertices in `touched` do not count: those a ray starts from. For a ray from a vertex
    /// it names that one three times, from an edge its two vertices, from a face its three.
    pub fn are_hit_before_end(&self, rays: &[Ray<T>], touched: &[[u32; 3]], found: &mut Vec<bool>) {
        found.clear();
        found.resize(rays.len(), false);
        let triangles = self.mesh.topology().triangles();
        let packets = rays.chunks(PACKET_SIZE).zip(touched.chunks(PACKET_SIZE)).zip(found.chunks_mut(PACKET_SIZE));
        for ((rays, touched), found) in packets {
            self.visit_packet(rays, &mut |place, prepared, triangle| {
                let corners = triangles[triangle as usize];
                found[place] |= !touched[place].iter().all(|vertex| corners.contains(vertex))
                    && prepared
                        .intersect(&self.mesh.corners(triangle), triangle)
                        .is_some_and(|hit| hit.t < rays[place].t_max);
                if found[place] { -T::INFINITY } else { rays[place].t_max }
            });
        }
    }

    fn visit_packet(&self, rays: &[Ray<T>], visitor: &mut impl FnMut(usize, &PreparedRay<T>, u32) -> T) {
        let prepare = |place: usize| PreparedRay::new(&rays[place.min(rays.len() - 1)], self.test);
        let prepared: [_; PACKET_SIZE] = std::array::from_fn(prepare);
        match self.cells {
            Cells::Wide(cells) => {
                let mut visitor = |place: usize, triangle: u32| visitor(place, &prepared[place], triangle);
                cells.visit_packet(rays, &prepared, self.mesh.aabb(), &mut visitor);
            }
            Cells::Classic(cells) => {
                for (place, ray) in rays.iter().enumerate() {
                    let mut visitor = |triangle| visitor(place, &prepared[place], triangle);
                    cells.visit(ray, self.mesh.aabb(), &mut visitor);
                }
            }
        }
    }

    /// Offers every triangle that the ray may meet up to the `t` that `visitor` last returned, perhaps several times.
    fn visit(&self, ray: &Ray<T>, prepared: &PreparedRay<T>, visitor: &mut impl FnMut(u32) -> T) {
        match self.cells {
            Cells::Wide(cells) => cells.visit(ray, prepared, self.mesh.aabb(), visitor),
            Cells::Classic(cells) => cells.visit(ray, self.mesh.aabb(), visitor),
        }
    }
}
