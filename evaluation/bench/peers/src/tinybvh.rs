//! tinybvh: its tree of two children a node, the one that can be refitted.

use crate::structure::{RayHit, Structure};
use tinybvh_rs::{INFINITE, Intersector, Ray, bvh::BVH};

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

    fn tree(&self) -> &BVH<'static> {
        self.tree.as_ref().expect("a call has ended")
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
        let mut own = Ray::new(ray.origin, ray.direction);
        own.hit.t = ray.t_max.min(INFINITE);
        let end = own.hit.t;
        self.tree().intersect(&mut own);
        if own.hit.t < end {
            let triangle = own.hit.prim as usize;
            let [a, b, c] = [0, 1, 2].map(|corner| self.points[3 * triangle + corner]);
            let [u, v] = [b, c].map(|end| [0, 1, 2].map(|axis| end[axis] - a[axis]));
            ray.normal = [0, 1, 2].map(|i| u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3]);
            (ray.t_max, ray.triangle, ray.u, ray.v) = (own.hit.t, own.hit.prim, own.hit.u, own.hit.v);
        }
    }

    /// It has no filter, so a ray goes on behind a triangle that touches its vertex.
    fn is_occluded(&self, ray: &RayHit) -> bool {
        let mut start = 0.0;
        loop {
            let origin = [0, 1, 2].map(|axis| ray.origin[axis] + start * ray.direction[axis]);
            let mut own = Ray::new(origin, ray.direction);
            let end = ray.t_max - start;
            own.hit.t = end;
            self.tree().intersect(&mut own);
            if own.hit.t >= end {
                return false;
            }
            if !self.corners[own.hit.prim as usize].contains(&ray.vertex) {
                return true;
            }
            // By the smallest step that moves it.
            start = (start + own.hit.t).max(ray.t_max * f32::EPSILON).next_up();
        }
    }
}
