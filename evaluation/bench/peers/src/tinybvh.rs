//! tinybvh: its tree of two children a node, the one that can be refitted.

use crate::structure::{RayHit, Structure};
use tinybvh_rs::{INFINITE, Intersection, Intersector, Ray, bvh::BVH};

/// Of a ray: how far behind a triangle that touches its vertex it goes on.
const STEP_BEHIND: f32 = 1e-5;

/// Its rays are of 128 bytes in C++, at multiples of 64; the crate's own are of 64, and their constructor writes beyond them.
#[repr(C, align(64))]
struct LargeRay {
    ray: Ray,
    room: [u8; 64],
}

impl LargeRay {
    fn new(origin: [f32; 3], direction: [f32; 3], end: f32) -> Self {
        let mut ray = Ray { origin, dir: direction, r_d: direction.map(f32::recip), ..Ray::default() };
        // The mask that meets everything.
        ray.padding_0 = 0xFFFF;
        ray.hit.t = end.min(INFINITE);
        Self { ray, room: [0; 64] }
    }
}

pub struct Refitted {
    /// Refers to `points`; always there between the calls.
    tree: Option<BVH<'static>>,
    /// Of the corners, triangle by triangle, as it wants them.
    points: Vec<[f32; 4]>,
    corners: Vec<[u32; 3]>,
}

impl Refitted {
    pub fn new(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Self {
        let mut refitted =
            Self { tree: None, points: vec![[0.0; 4]; 3 * triangles.len()], corners: triangles.to_vec() };
        refitted.place(positions);
        refitted.tree = Some(BVH::new(refitted.lasting().into()).expect("triangles have three corners"));
        refitted
    }

    fn place(&mut self, positions: &[[f32; 3]]) {
        for (point, &corner) in self.points.iter_mut().zip(self.corners.as_flattened()) {
            point[..3].copy_from_slice(&positions[corner as usize]);
        }
    }

    fn lasting(&self) -> &'static [[f32; 4]] {
        // SAFETY: the tree is given up before the points are written or freed.
        unsafe { std::slice::from_raw_parts(self.points.as_ptr(), self.points.len()) }
    }

    fn trace(&self, origin: [f32; 3], direction: [f32; 3], end: f32) -> Intersection {
        let mut large = LargeRay::new(origin, direction, end);
        self.tree.as_ref().expect("a call has ended").intersect(&mut large.ray);
        large.ray.hit
    }
}

impl Structure for Refitted {
    fn update(&mut self, positions: &[[f32; 3]]) {
        let tree = self.tree.take().expect("a call has ended").data();
        self.place(positions);
        let mut tree = tree.bvh(self.lasting().into()).expect("there are as many points as before");
        tree.refit();
        self.tree = Some(tree);
    }

    fn nearest(&self, ray: &mut RayHit) {
        let own = self.trace(ray.origin, ray.direction, ray.t_max);
        if own.t < ray.t_max.min(INFINITE) {
            let triangle = own.prim as usize;
            let [a, b, c] = [0, 1, 2].map(|corner| self.points[3 * triangle + corner]);
            let [u, v] = [b, c].map(|end| [0, 1, 2].map(|axis| end[axis] - a[axis]));
            ray.normal = [0, 1, 2].map(|i| u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3]);
            (ray.t_max, ray.triangle, ray.u, ray.v) = (own.t, own.prim, own.u, own.v);
        }
    }

    /// It has no filter, so a ray goes on behind a triangle that touches its vertex.
    fn is_occluded(&self, ray: &RayHit) -> bool {
        let mut start = 0.0;
        loop {
            let origin = [0, 1, 2].map(|axis| ray.origin[axis] + start * ray.direction[axis]);
            let end = ray.t_max - start;
            let own = self.trace(origin, ray.direction, end);
            if own.t >= end {
                return false;
            }
            if !self.corners[own.prim as usize].contains(&ray.vertex) {
                return true;
            }
            start += own.t + STEP_BEHIND * ray.t_max;
        }
    }
}
