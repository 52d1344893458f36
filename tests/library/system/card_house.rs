//! Two cards that lean on one another: edges on a floor, and an edge on an edge.

use crate::common::host::{Host, Rigid, box_inertia, rotation};
use crate::common::shapes;
use nalgebra::{Matrix3, Vector3};
use raycontact::system::{Material, RigidUnknowns};

type V3 = Vector3<f64>;
const MASS: f64 = 0.2;
const G: f64 = 9.81;
/// Length, width and thickness, in m.
const LARGE: [f64; 3] = [0.2, 0.2, 0.01];
const SMALL: [f64; 3] = [0.09, 0.06, 0.002];

/// Cards that lean by 70 degrees against the floor, and sink into it by about that much; friction of 0.18 would hold their feet.
fn cards(edges: [f64; 3], sink: f64, friction: f64) -> Host {
    let lean = 70_f64.to_radians();
    // A right angle on its edge bears about stiffness · width · 1.5 sink².
    let stiffness = MASS * G / (1.5 * edges[1] * sink * sink);
    let pair = Material { stiffness, friction, ..Material::bearing(1.0, 1.0).expect("a material") };
    let material = Material { stiffness: 2.0 * stiffness, ..pair };
    let mut host = Host::new(RigidUnknowns::Eliminated);
    host.gravity = V3::new(0.0, 0.0, -G);
    let slab = shapes::cube(1).map(|[x, y, z]| [x, y, 0.25 * z - 0.25]);
    let floor = host.scene.add(slab.mesh());
    host.system.add_moved(&host.scene, floor, material).expect("a floor");
    for side in [-1.0, 1.0] {
        // The card's length lies along x before it is turned, up for the one on the left.
        let turn = rotation(&V3::new(0.0, side * lean, 0.0));
        let half = V3::from(edges) * 0.5;
        let reach = half.x * lean.cos() + half.z * lean.sin();
        let height = half.x * lean.sin() + half.z * lean.cos();
        let card = shapes::cube(1).map(|[x, y, z]| [half.x * x, half.y * y, half.z * z]);
        let body = host.scene.add(card.mesh());
        let inertia = box_inertia(MASS, edges);
        host.system.add_rigid(&host.scene, body, MASS, inertia, material).expect("a card");
        host.rigids.push(Rigid {
            body,
            mass: MASS,
            inertia: Matrix3::from_fn(|i, j| inertia[i][j]),
            position: V3::new(side * (reach - 0.3 * sink), 0.0, height - sink),
            rotation: turn,
            velocity: [0.0; 6],
            push: V3::zeros(),
        });
    }
    host
}

/// How far a card moves from the first second to the last, in mm.
fn creep(edges: [f64; 3], sink: f64, friction: f64, dt: f64, time: f64) -> f64 {
    let mut host = cards(edges, sink, friction);
    let run = |host: &mut Host, time: f64| (0..(time / dt).round() as usize).for_each(|_| host.step(dt));
    run(&mut host, 1.0);
    let from: Vec<V3> = host.rigids.iter().map(|card| card.position).collect();
    run(&mut host, time - 1.0);
    let way = host.rigids.iter().zip(&from).map(|(card, from)| (card.position - from).norm());
    let way = 1e3 * way.fold(0.0, f64::max);
    println!("{edges:?}, {sink} m deep, friction {friction}, {dt:.4} s: {way:.4} mm in {time} s");
    way
}

#[test]
fn a_house_of_cards_stands() {
    for (sink, dt, time) in [(1e-4, 1.0 / 60.0, 5.0), (5e-4, 1.0 / 60.0, 5.0), (2e-4, 1.0 / 240.0, 2.0)] {
        assert!(creep(LARGE, sink, 0.5, dt, time) < 0.01, "{sink} m, {dt} s");
    }
}

#[test]
#[ignore = "takes half an hour"]
fn a_house_of_cards_stands_for_a_minute() {
    let cases = [1e-4, 2e-4, 5e-4].into_iter().flat_map(|sink| [1.0 / 60.0, 1.0 / 240.0].map(|dt| (sink, dt)));
    let ways = cases.map(|(sink, dt)| [LARGE, SMALL].map(|edges| creep(edges, sink, 0.5, dt, 60.0)));
    assert!(ways.flatten().fold(0.0, f64::max) < 1.0);
}
