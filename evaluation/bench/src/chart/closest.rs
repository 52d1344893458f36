//! The closest-feature method of the pose benchmark, as one of the methods measured.

use super::proximity::{Surface, repulsions};
use super::tree::Tree;
use crate::host::{Host, HostBody};
use crate::method::{Key, Method, Push, Stages};
use crate::workload::{Body, Workload};
use nalgebra::Vector3;
use std::collections::HashMap;

struct Follower {
    positions: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
    tree: Tree,
    size: f64,
}

pub struct Closest {
    bodies: Vec<Follower>,
    pushes: Vec<Push>,
}

impl Follower {
    fn new(body: &Body, host: &HostBody) -> Self {
        let positions: Vec<_> = host.double().iter().map(|&p| Vector3::from(p)).collect();
        let sides = body.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        // Each edge belongs to two triangles, in opposite directions.
        let edges = sides.filter(|[from, to]| from < to).collect();
        let tree = Tree::new(&positions, &body.triangles);
        let bounds = tree.bounds();
        let size = (bounds.upper - bounds.lower).max();
        Self { positions, triangles: body.triangles.clone(), edges, tree, size }
    }
}

impl Surface for Follower {
    fn size(&self) -> f64 {
        self.size
    }

    fn positions(&self) -> &[Vector3<f64>] {
        &self.positions
    }

    fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    fn edges(&self) -> impl Iterator<Item = [u32; 2]> {
        self.edges.iter().copied()
    }

    fn tree(&self) -> &Tree {
        &self.tree
    }
}

impl Closest {
    pub fn new(workload: &Workload, host: &Host) -> Self {
        let bodies = workload.bodies.iter().zip(&host.bodies).map(|(body, host)| Follower::new(body, host)).collect();
        Self { bodies, pushes: Vec::new() }
    }
}

impl Method for Closest {
    fn step(&mut self, host: &Host) -> Option<Stages> {
        for (body, host) in self.bodies.iter_mut().zip(&host.bodies) {
            body.positions.clear();
            body.positions.extend(host.double().iter().map(|&p| Vector3::from(p)));
            body.tree.refit(&body.positions, &body.triangles);
        }
        self.pushes.clear();
        self.pushes.extend(repulsions(&self.bodies).into_iter().map(|repulsion| Push {
            bodies: repulsion.bodies.map(|body| body as u32),
            point: repulsion.points[0],
            force: repulsion.direction * repulsion.depth,
            area: None,
            vertices: Vec::new(),
        }));
        None
    }

    /// It knows points, not triangles.
    fn contacts(&self) -> Vec<Key> {
        Vec::new()
    }

    /// With the vertices that lie where they push; those of pairs of edges lie between.
    fn pushes(&self) -> Vec<Push> {
        let bits = |p: &Vector3<f64>| [p.x.to_bits(), p.y.to_bits(), p.z.to_bits()];
        let mut vertices = HashMap::new();
        for (number, body) in (0..).zip(&self.bodies) {
            vertices.extend((0..).zip(&body.positions).map(|(vertex, p)| ((number, bits(p)), vertex)));
        }
        let mut pushes = self.pushes.clone();
        for push in &mut pushes {
            let found = vertices.get(&(push.bodies[0], bits(&push.point)));
            push.vertices.extend(found.map(|&vertex| [push.bodies[0], vertex]));
        }
        pushes
    }
}
