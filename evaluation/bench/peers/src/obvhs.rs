//! obvhs: a binary tree of the best build it has without splitting triangles, refitted each step.

use crate::structure::{RayHit, Structure};
use glam::Vec3A;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use obvhs::ray::{Ray, RayHit as Hit};
use obvhs::{BvhBuildParams, rt_triangle::RtTriangle, triangle::Triangle};
use std::time::Duration;

pub struct Refitted {
    tree: Bvh2,
    /// In the tree's order, as it likes them best.
    triangles: Vec<RtTriangle>,
    corners: Vec<[u32; 3]>,
}

impl Refitted {
    pub fn new(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Self {
        let corner = |v: u32| Vec3A::from(positions[v as usize]);
        let shapes: Vec<Triangle> =
            triangles.iter().map(|&[a, b, c]| Triangle { v0: corner(a), v1: corner(b), v2: corner(c) }).collect();
        let settings = BvhBuildParams { pre_split: false, ..BvhBuildParams::very_slow_build() };
        let mut tree = build_bvh2_from_tris(&shapes, settings, &mut Duration::default());
        tree.reorder_in_stack_traversal_order();
        let corners = tree.primitive_indices.iter().map(|&index| triangles[index as usize]).collect();
        let mut refitted = Self { tree, triangles: Vec::new(), corners };
        refitted.update(positions);
        refitted
    }

    fn ray(ray: &RayHit) -> Ray {
        Ray::new(ray.origin.into(), ray.direction.into(), 0.0, ray.t_max)
    }
}

impl Structure for Refitted {
    fn update(&mut self, positions: &[[f32; 3]]) {
        let corner = |v: u32| Vec3A::from(positions[v as usize]);
        self.triangles.clear();
        self.triangles.extend(self.corners.iter().map(|&[a, b, c]| RtTriangle::new(corner(a), corner(b), corner(c))));
        for node in self.tree.nodes.iter_mut().filter(|node| node.is_leaf()) {
            let first = node.first_index as usize;
            let corners = &self.corners[first..first + node.prim_count as usize];
            let mut points = corners.as_flattened().iter().map(|&v| corner(v));
            let start = points.next().expect("leaves are not empty");
            let (lower, upper) = points.fold((start, start), |(lower, upper), p| (lower.min(p), upper.max(p)));
            node.set_aabb(obvhs::aabb::Aabb::new(lower, upper));
        }
        self.tree.refit_all();
    }

    fn nearest(&self, ray: &mut RayHit) {
        let mut hit = Hit::none();
        self.tree.ray_traverse(Self::ray(ray), &mut hit, |ray, index| self.triangles[index].intersect(ray));
        if hit.primitive_id != u32::MAX {
            let place = hit.primitive_id as usize;
            let triangle = &self.triangles[place];
            ray.triangle = self.tree.primitive_indices[place];
            ray.t_max = hit.t;
            ray.normal = (-triangle.ng).into();
            let weights = triangle.compute_barycentric(&Self::ray(ray));
            (ray.u, ray.v) = (weights.x, weights.y);
        }
    }

    fn is_occluded(&self, ray: &RayHit) -> bool {
        !self.tree.ray_traverse_miss(Self::ray(ray), |traced, index| {
            let t = self.triangles[index].intersect(traced);
            let is_own = || self.corners[index].contains(&ray.vertex);
            if t < ray.t_max && is_own() { f32::INFINITY } else { t }
        })
    }
}
