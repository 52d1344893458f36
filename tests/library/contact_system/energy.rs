//! Closed systems never gain energy.

use super::friction::{add_box, add_cage, add_soft};
use crate::common::host::{Host, rotation};
use crate::common::random::Random;
use crate::common::shapes;
use nalgebra::Vector3;
use raycontact::contact::ContactList;
use raycontact::response::{PenaltyLaw, Weighting, energy};
use raycontact::system::{Material, RigidUnknowns};

type V3 = Vector3<f64>;

/// In J: of the contacts where the bodies are.
fn stored(host: &mut Host, material: &Material) -> f64 {
    let law = PenaltyLaw::new(material.combined(material).stiffness, 0.0, Weighting::Area).expect("a law");
    let mut list = ContactList::default();
    host.scene.query(&mut list);
    energy(&list.contacts, &law, None::<&[Vec<V3>]>)
}

fn closed(seed: u64) -> (Host, Material) {
    let mut random = Random::new(seed);
    let friction = if seed % 2 == 0 { 0.0 } else { 0.4 };
    let material = Material { stiffness: 2e4, damping_time: 0.0, friction, depth_cap: f64::INFINITY };
    let mut host = Host::new(RigidUnknowns::Eliminated);
    for k in 0..2 + seed % 2 {
        let turn = rotation(&V3::from(random.point(1.5)));
        let by = V3::from(random.point(0.18));
        let nodes = host.masses.len();
        match (seed / 2 + k) % 3 {
            0 => add_box(&mut host, material, V3::zeros(), turn),
            1 => add_soft(&mut host, &shapes::cube(2).scaled(0.2), material, turn),
            _ => add_cage(&mut host, material, turn),
        }
        for node in nodes..host.masses.len() {
            (0..3).for_each(|axis| host.x[3 * node + axis] += by[axis]);
        }
        if nodes == host.masses.len() {
            host.rigids.last_mut().expect("it was added").position = by;
        }
    }
    (host, material)
}

#[test]
fn explore_energy() {
    let mut worst: f64 = 0.0;
    for seed in 0..60 {
        let (mut host, material) = closed(seed);
        let dt = [1.0 / 240.0, 1.0 / 60.0, 0.05][seed as usize % 3];
        host.step(1e-9);
        let start = host.kinetic() + host.elastic() + stored(&mut host, &material);
        let (mut most, mut at_step) = (0.0f64, 0);
        for step in 0..300 {
            host.step(dt);
            let e = host.kinetic() + host.elastic();
            if e > most { most = e; at_step = step; }
        }
        let end = host.kinetic() + host.elastic();
        let escapes = host.system.contacts().statistics;
        worst = worst.max(most / start);
        println!("{seed} dt {dt:.4} bodies {} start {start:.3} most {most:.3} ({:.3}) at {at_step} end {end:.4} escaping {}", 2 + seed % 2, most / start, escapes.escaping_pairs);
    }
    println!("worst {worst}");
}
