//! Bodies of 10 kg and about 0.4 m, one of each kind.

use crate::common::host::{Host, Rigid, Spring, at, box_inertia};
use crate::common::shapes::{self, Shape};
use nalgebra::{Matrix3, Vector3};
use raycontact::system::{Carriers, Material};

type V3 = Vector3<f64>;

pub fn add_box(host: &mut Host, material: Material, position: V3, turn: Matrix3<f64>) {
    add_rigid(host, &shapes::cube(1).scaled(0.2), material, position, turn);
}

/// With the inertia of that box, whatever its shape.
pub fn add_rigid(host: &mut Host, shape: &Shape, material: Material, position: V3, turn: Matrix3<f64>) {
    let body = host.scene.add(shape.mesh());
    let inertia = box_inertia(10.0, [0.4; 3]);
    host.system.add_rigid(&host.scene, body, 10.0, inertia, material).expect("a box");
    host.rigids.push(Rigid {
        body,
        mass: 10.0,
        inertia: Matrix3::from_fn(|i, j| inertia[i][j]),
        position,
        rotation: turn,
        velocity: [0.0; 6],
        push: V3::zeros(),
    });
}

fn lattice(host: &mut Host, nodes: std::ops::Range<u32>, reach: f64, stiffness: f64) {
    for a in nodes.start as usize..nodes.end as usize {
        for b in a + 1..nodes.end as usize {
            let length = (at(&host.x, b) - at(&host.x, a)).norm();
            if length < reach {
                host.springs.push(Spring { ends: [a, b], length, stiffness });
            }
        }
    }
}

pub fn add_soft(host: &mut Host, shape: &Shape, material: Material, turn: Matrix3<f64>) {
    let shape = shape.map(|p| (turn * V3::from(p)).into());
    let body = host.scene.add(shape.mesh());
    let nodes = host.add_nodes(&shape.positions, 10.0 / shape.positions.len() as f64);
    lattice(host, nodes.clone(), 0.5, 2000.0);
    host.system.add_deformable(&host.scene, body, nodes, Carriers::Nodes, material).expect("a body");
}

/// A scan in a cage: a lumpy ball by trilinear weights of the corners of a box.
pub fn add_cage(host: &mut Host, material: Material, turn: Matrix3<f64>) {
    let ball = shapes::sphere(2).map(|[x, y, z]| {
        let lump = 1.0 + 0.05 * (9.0 * x).sin() * (7.0 * y).cos();
        [0.2 * lump * x, 0.2 * lump * y, 0.12 * z.clamp(-0.8, 0.8) / 0.8]
    });
    let corners: Vec<V3> = (0..8)
        .map(|i| V3::new((i & 1) as f64 * 0.5 - 0.25, (i >> 1 & 1) as f64 * 0.5 - 0.25, (i >> 2) as f64 * 0.3 - 0.15))
        .collect();
    let (mut offsets, mut nodes, mut weights) = (vec![0], vec![], vec![]);
    for &[x, y, z] in &ball.positions {
        let part = [x / 0.5 + 0.5, y / 0.5 + 0.5, z / 0.3 + 0.5];
        for i in 0..8u32 {
            nodes.push(i);
            weights.push((0..3).map(|k| if i >> k & 1 == 1 { part[k] } else { 1.0 - part[k] }).product::<f64>());
        }
        offsets.push(nodes.len() as u32);
    }
    let up = turn * V3::new(0.0, 0.0, 0.12);
    let place = |p: V3| -> [f64; 3] { (turn * p + up).into() };
    let body = host.scene.add(ball.map(|p| place(p.into())).mesh());
    let placed: Vec<_> = corners.into_iter().map(place).collect();
    let range = host.add_nodes(&placed, 10.0 / 8.0);
    lattice(host, range.clone(), 10.0, 4000.0);
    let carriers = Carriers::Weights { offsets: &offsets, nodes: &nodes, weights: &weights };
    host.system.add_deformable(&host.scene, body, range, carriers, material).expect("a cage");
}
