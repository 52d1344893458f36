//! parry3d: its binary tree of triangles, refitted each step without changing the order in memory.

use crate::structure::{RayHit, Structure};
use parry3d::bounding_volume::Aabb;
use parry3d::math::Vec3A;
use parry3d::math::Vector;
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
use parry3d::query::Ray;

pub struct Refitted {
    tree: Bvh,
    triangles: Vec<[u32; 3]>,
    corners: Vec<[Vec3A; 3]>,
}

/// A hit of a ray on a triangle. `normal` is as long as twice the triangle's area.
struct Hit {
    t: f32,
    normal: Vec3A,
    u: f32,
    v: f32,
}

impl Refitted {
    pub fn new(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Self {
        let corners: Vec<_> = triangles.iter().map(|triangle| corners(positions, triangle)).collect();
        let leaves: Vec<Aabb> = corners.iter().map(aabb).collect();
        let mut tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves);
        // Once, for the order in memory.
        tree.refit(&mut BvhWorkspace::default());
        Self { tree, triangles: triangles.to_vec(), corners }
    }
}

fn corners(positions: &[[f32; 3]], triangle: &[u32; 3]) -> [Vec3A; 3] {
    triangle.map(|v| Vec3A::from(positions[v as usize]))
}

fn aabb(&[a, b, c]: &[Vec3A; 3]) -> Aabb {
    Aabb::new(a.min(b).min(c).into(), a.max(b).max(c).into())
}

/// After Möller and Trumbore; parry's own test also normalises the normal.
fn intersect(&[a, b, c]: &[Vec3A; 3], origin: Vec3A, direction: Vec3A) -> Option<Hit> {
    let (edge1, edge2, from) = (b - a, c - a, origin - a);
    let across = direction.cross(edge2);
    let inverse = 1.0 / edge1.dot(across);
    let u = from.dot(across) * inverse;
    let along = from.cross(edge1);
    let v = direction.dot(along) * inverse;
    let t = edge2.dot(along) * inverse;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0).then(|| Hit { t, normal: edge1.cross(edge2), u, v })
}

impl Structure for Refitted {
    fn update(&mut self, positions: &[[f32; 3]]) {
        for (index, (triangle, place)) in self.triangles.iter().zip(&mut self.corners).enumerate() {
            *place = corners(positions, triangle);
            self.tree.insert_or_update_partially(aabb(place), index as u32, 0.0);
        }
        self.tree.refit_without_opt();
    }

    fn nearest(&self, ray: &mut RayHit) {
        let (origin, direction) = (Vec3A::from(ray.origin), Vec3A::from(ray.direction));
        let traced = Ray::new(Vector::from(ray.origin), Vector::from(ray.direction));
        let test = |index: u32, _| intersect(&self.corners[index as usize], origin, direction).map(|hit| hit.t);
        if let Some((index, t)) = self.tree.cast_ray(&traced, ray.t_max, test) {
            ray.triangle = index;
            ray.t_max = t;
            let hit = intersect(&self.corners[index as usize], origin, direction).expect("it was hit");
            ray.normal = hit.normal.into();
            (ray.u, ray.v) = (hit.u, hit.v);
        }
    }

    fn is_occluded(&self, ray: &RayHit) -> bool {
        let (origin, direction) = (Vec3A::from(ray.origin), Vec3A::from(ray.direction));
        let traced = Ray::new(Vector::from(ray.origin), Vector::from(ray.direction));
        // A negative answer ends the search.
        let test = |index: u32, _| {
            let hit = intersect(&self.corners[index as usize], origin, direction)?;
            let counts = hit.t < ray.t_max && !self.triangles[index as usize].contains(&ray.vertex);
            counts.then_some(-1.0)
        };
        self.tree.cast_ray(&traced, ray.t_max, test).is_some()
    }
}
