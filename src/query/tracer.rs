use crate::bvh::{Candidates, PacketHits};
use crate::math::Scalar;
use crate::memory::{self, Room};
use crate::mesh::Mesh;
use crate::query::octree::{Octree, OctreeError, Tree};
use crate::query::patch_levels::{PatchLevels, PatchesOfGroups};
use crate::simd::{Kernel, LANE_COUNT, Lanes, Mask, dispatch, lanes_of};
use crate::triangle::{Hit, PreparedRay, Ray, RayPacket, ShearedRay, TriangleTest};
use std::cmp::Ordering;

/// A mesh together with its up-to-date octree: what rays are traced in.
#[derive(Clone, Copy, Debug)]
pub struct Tracer<'a, T: Scalar> {
    pub(crate) tree: &'a Tree<T>,
    patches: &'a PatchLevels<PatchesOfGroups>,
    mesh: &'a Mesh<T>,
    pub(crate) test: TriangleTest,
}

impl<T: Scalar> Octree<T> {
    /// Joins octree and mesh for tracing.
    ///
    /// # Errors
    /// [`OctreeError`], where the two do not belong together or the octree is stale.
    pub fn tracer<'a>(&'a self, mesh: &'a Mesh<T>) -> Result<Tracer<'a, T>, OctreeError> {
        if !mesh.shares_topology_with(&self.topology) {
            return Err(OctreeError::OtherMesh);
        }
        if self.stamp != mesh.stamp() {
            return Err(OctreeError::Stale);
        }
        Ok(Tracer { tree: &self.tree, patches: &self.patches, mesh, test: TriangleTest::default() })
    }
}

impl<'a, T: Scalar> Tracer<'a, T> {
    /// The same, deciding with another triangle test.
    pub fn with_test(self, test: TriangleTest) -> Self {
        Self { test, ..self }
    }

    /// The mesh.
    pub fn mesh(&self) -> &'a Mesh<T> {
        self.mesh
    }

    /// The largest patches of at most about this area at the reference positions, by the groups that they reach into.
    pub(crate) fn patches_of_groups(&self, area: T) -> &'a PatchesOfGroups {
        let group = |group, offer: &mut dyn FnMut(u32)| self.triangles_of(group, offer);
        self.patches.at(self.mesh, area, |area| PatchesOfGroups::new(self.mesh, area, self.group_count(), group))
    }

    /// The first hit along the ray; at equal `t` the triangle with the smallest index. With the watertight test it is
    /// the same to the bit as [`nearest_hit_of_all`](Self::nearest_hit_of_all).
    pub fn nearest_hit(&self, ray: &Ray<T>) -> Option<Hit<T>> {
        self.nearest_hit_of(*ray, |hit| hit)
    }

    /// What `then` makes of the first hit along the ray, given in numbers of any type.
    pub(crate) fn nearest_hit_of<O>(&self, ray: impl Into<Ray<T>>, then: impl FnOnce(Option<Hit<T>>) -> O) -> O {
        if let (Tree::Bvh(tree), TriangleTest::Watertight) = (self.tree, self.test) {
            return tree.nearest_of_ray(self.mesh, ray, then);
        }
        then(self.nearest_of_visited(&ray.into()))
    }

    fn nearest_of_visited(&self, ray: &Ray<T>) -> Option<Hit<T>> {
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
            if let Some(hit) = crossing.filter(|hit| hit.t <= ray.t_max) {
                crossings.room_for(1).push(hit);
            }
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
        memory::refill_with(hits, None, rays.len());
        self.nearest_hits_into(rays, hits);
    }

    /// [`nearest_hits`](Self::nearest_hits) into as many elements as there are rays.
    pub(crate) fn nearest_hits_into(&self, rays: &[Ray<T>], hits: &mut [Option<Hit<T>>]) {
        dispatch::<T, _>(NearestHits { tracer: self, rays, hits });
    }

    fn keep_nearer(&self, ray: &Ray<T>, prepared: &PreparedRay<T>, triangle: u32, nearest: &mut Option<Hit<T>>) {
        let hit = prepared.intersect(&self.mesh.corners(triangle), triangle);
        if let Some(hit) = hit.filter(|hit| hit.t <= ray.t_max && nearest.is_none_or(|n| hit.is_before(&n))) {
            *nearest = Some(hit);
        }
    }

    /// For each ray whether it leaves the mesh, that is, meets a triangle from inside, strictly before its `t_max`; into `found`,
    /// which is cleared first. Triangles that have all of a ray's `touched` vertices do not count: those it starts from. A ray
    /// from a vertex names it three times, one from an edge its two vertices, one from a face its three.
    pub fn leave_before_end(&self, rays: &[Ray<T>], touched: &[[u32; 3]], found: &mut Vec<bool>) {
        memory::refill_with(found, false, rays.len());
        dispatch::<T, _>(LeaveBeforeEnd { tracer: self, rays, touched, found });
    }

    /// [`nearest_hit`](Self::nearest_hit) of each ray of a packet.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn nearest_of_packet<L: Lanes<T>>(
        &self,
        packet: &RayPacket<T>,
        list: &mut Candidates<T>,
        hits: &mut PacketHits<T>,
    ) {
        match (self.tree, self.test) {
            (Tree::Bvh(tree), TriangleTest::Watertight) => tree.nearest::<L>(self.mesh, packet, list, hits),
            _ => self.nearest_one_by_one(packet, hits),
        }
    }

    fn nearest_one_by_one(&self, packet: &RayPacket<T>, hits: &mut PacketHits<T>) {
        (hits.found, hits.exits) = (0, 0);
        for lane in lanes_of(packet.present) {
            if let Some(hit) = self.nearest_hit(&packet.ray(lane)) {
                hits.set(lane, &hit);
            }
        }
    }

    /// [`leave_before_end`](Self::leave_before_end) of the rays in `asked`, given their ends.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn hidden_of_packet<L: Lanes<T>>(
        &self,
        packet: &RayPacket<T>,
        asked: Mask,
        end: &[T; LANE_COUNT],
        touched: &[[u32; LANE_COUNT]; 3],
        list: &mut Candidates<T>,
    ) -> Mask {
        match (self.tree, self.test) {
            (Tree::Bvh(tree), TriangleTest::Watertight) => {
                tree.hidden::<L>(self.mesh, packet, asked, end, touched, list)
            }
            _ => self.hidden_one_by_one(packet, asked, end, touched),
        }
    }

    fn hidden_one_by_one(
        &self,
        packet: &RayPacket<T>,
        asked: Mask,
        end: &[T; LANE_COUNT],
        touched: &[[u32; LANE_COUNT]; 3],
    ) -> Mask {
        let triangles = self.mesh.topology().triangles();
        let mut hidden = 0;
        for lane in lanes_of(asked) {
            let ray = packet.ray(lane).until(end[lane]);
            let prepared = PreparedRay::new(&ray, self.test);
            let mut is_hidden = false;
            self.visit(&ray, &prepared, &mut |triangle| {
                let corners = triangles[triangle as usize];
                is_hidden |= !touched.iter().all(|vertices| corners.contains(&vertices[lane]))
                    && prepared
                        .intersect(&self.mesh.corners(triangle), triangle)
                        .is_some_and(|hit| hit.is_exit && hit.t < ray.t_max);
                if is_hidden { -T::INFINITY } else { ray.t_max }
            });
            hidden |= Mask::from(is_hidden) << lane;
        }
        hidden
    }

    /// Offers every triangle that the ray may meet up to the `t` that `visitor` last returned, perhaps several times.
    fn visit(&self, ray: &Ray<T>, prepared: &PreparedRay<T>, visitor: &mut impl FnMut(u32) -> T) {
        match self.tree {
            Tree::Bvh(tree) => tree.visit(ray, prepared, self.mesh, visitor),
            Tree::PaperOctree(tree) => tree.visit(ray, self.mesh.aabb(), visitor),
        }
    }
}

/// [`Tracer::nearest_hits`].
struct NearestHits<'a, 'b, T: Scalar> {
    tracer: &'a Tracer<'b, T>,
    rays: &'a [Ray<T>],
    hits: &'a mut [Option<Hit<T>>],
}

impl<T: Scalar> Kernel<T> for NearestHits<'_, '_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let Tracer { tree, mesh, test, .. } = self.tracer;
        if let (Tree::Bvh(tree), TriangleTest::Watertight, false) = (tree, test, L::PACKETS_PAY) {
            for (ray, hit) in self.rays.iter().zip(self.hits) {
                *hit = tree.nearest_of_ray_on::<L>(mesh, *ray);
            }
            return;
        }
        let (mut packet, mut list, mut found) = (RayPacket::empty(), Candidates::new(), PacketHits::empty());
        for (rays, hits) in self.rays.chunks(LANE_COUNT).zip(self.hits.chunks_mut(LANE_COUNT)) {
            packet.set_rays::<L>(rays);
            self.tracer.nearest_of_packet::<L>(&packet, &mut list, &mut found);
            for (lane, hit) in hits.iter_mut().enumerate() {
                *hit = found.get(lane);
            }
        }
    }
}

/// [`Tracer::leave_before_end`].
struct LeaveBeforeEnd<'a, 'b, T: Scalar> {
    tracer: &'a Tracer<'b, T>,
    rays: &'a [Ray<T>],
    touched: &'a [[u32; 3]],
    found: &'a mut [bool],
}

impl<T: Scalar> Kernel<T> for LeaveBeforeEnd<'_, '_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let (mut packet, mut list) = (RayPacket::empty(), Candidates::new());
        let all_touched = self.touched.chunks(LANE_COUNT);
        for ((rays, some_touched), found) in
            self.rays.chunks(LANE_COUNT).zip(all_touched).zip(self.found.chunks_mut(LANE_COUNT))
        {
            packet.set_rays::<L>(rays);
            let mut touched = [[0; LANE_COUNT]; 3];
            for (lane, of_ray) in some_touched.iter().enumerate() {
                (0..3).for_each(|k| touched[k][lane] = of_ray[k]);
            }
            let end = packet.t_max;
            let hidden = self.tracer.hidden_of_packet::<L>(&packet, packet.present, &end, &touched, &mut list);
            for (lane, found) in found.iter_mut().enumerate() {
                *found = hidden >> lane & 1 == 1;
            }
        }
    }
}
