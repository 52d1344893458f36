//! Coulomb friction against the textbook: what holds, what slides, and how fast.

use crate::common::host::{Host, Rigid, at, box_inertia, rotation};
use crate::common::shapes::{self, Shape};
use nalgebra::{Matrix3, Vector3};
use raycontact::system::{Carriers, Material, RigidUnknowns};

type V3 = Vector3<f64>;
const G: f64 = 9.81;

/// What the body of a trial rests on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Floor {
    HalfSpace,
    Slab,
}

/// What it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    Rigid,
    Soft,
    /// A sphere of 320 triangles in a cage of eight nodes.
    Cage,
}

fn material(friction: f64) -> Material {
    Material { stiffness: 4e5, damping_time: 0.02, friction, depth_cap: 0.05 }
}

/// A body of 10 kg and about 0.4 m on a plane through the origin that is tilted about the axis y, so that it slides
/// along +x.
pub fn on_a_plane(kind: Kind, floor: Floor, tilt: f64, friction: f64) -> Host {
    let mut host = Host::new(RigidUnknowns::Eliminated);
    let turn = rotation(&V3::new(0.0, tilt, 0.0));
    host.gravity = V3::new(0.0, 0.0, -G);
    let material = material(friction);
    match floor {
        Floor::HalfSpace => {
            let normal = turn * V3::z();
            host.system.add_half_space(normal.into(), 0.0, material).expect("a floor");
        }
        Floor::Slab => {
            let slab = shapes::cube(1).map(|[x, y, z]| {
                (turn * V3::new(4.0 * x, 2.0 * y, 0.5 * z - 0.5)).into()
            });
            let body = host.scene.add(slab.mesh());
            host.system.add_moved(&host.scene, body, material).expect("a floor");
        }
    }
    match kind {
        Kind::Rigid => add_box(&mut host, material, turn * V3::new(0.0, 0.0, 0.2), turn),
        Kind::Soft => {
            let shape = shapes::cube(4).scaled(0.2).moved([0.0, 0.0, 0.2]);
            add_soft(&mut host, &shape, material, turn);
        }
        Kind::Cage => add_cage(&mut host, material, turn),
    }
    host
}

pub fn add_box(host: &mut Host, material: Material, position: V3, turn: Matrix3<f64>) {
    let body = host.scene.add(shapes::cube(1).scaled(0.2).mesh());
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
    use crate::common::host::Spring;
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

/// The velocity of the centre of mass.
pub fn speed(host: &Host) -> V3 {
    let mut momentum = V3::zeros();
    let mut mass = 0.0;
    for (node, m) in host.masses.iter().enumerate() {
        momentum += at(&host.v, node) * *m;
        mass += m;
    }
    for rigid in &host.rigids {
        momentum += V3::new(rigid.velocity[0], rigid.velocity[1], rigid.velocity[2]) * rigid.mass;
        mass += rigid.mass;
    }
    momentum / mass
}

pub fn centre(host: &Host) -> V3 {
    let mut sum = V3::zeros();
    let mut mass = 0.0;
    for (node, m) in host.masses.iter().enumerate() {
        sum += at(&host.x, node) * *m;
        mass += m;
    }
    for rigid in &host.rigids {
        sum += rigid.position * rigid.mass;
        mass += rigid.mass;
    }
    sum / mass
}

#[test]
fn explore() {
    for kind in [Kind::Rigid, Kind::Soft, Kind::Cage] {
        for floor in [Floor::HalfSpace, Floor::Slab] {
            for dt in [1.0 / 60.0, 1.0 / 240.0] {
                for friction in [0.5, 0.15] {
                    let mut host = on_a_plane(kind, floor, 0.2, friction);
                    let steps = |time: f64| (time / dt).round() as usize;
                    (0..steps(1.0)).for_each(|_| host.step(dt));
                    let (from, v) = (centre(&host), speed(&host));
                    (0..steps(1.0)).for_each(|_| host.step(dt));
                    let creep = (centre(&host) - from).norm();
                    let acceleration = (speed(&host) - v).norm();
                    let expected = G * (0.2f64.sin() - friction * 0.2f64.cos());
                    let it = host.iterations;
                    println!("{kind:?} {floor:?} 1/{:.0} mu {friction}: creep {:.3} mm/s, a {acceleration:.4} / {expected:.4}, speed {:.2e} its {it} z {:.4}",
                        1.0 / dt, 1e3 * creep, speed(&host).norm(), centre(&host).z);
                }
            }
        }
    }
}
