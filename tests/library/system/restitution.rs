//! Restitution against its definition, energy and momentum: rigid balls and boxes of 10 kg on floors and on one another.

use super::bodies::{add_box, add_rigid};
use crate::common::host::{Host, rotation};
use crate::common::shapes;
use nalgebra::{Matrix3, Vector3};
use raycontact::system::{Material, RigidUnknowns};

type V3 = Vector3<f64>;
const G: f64 = 9.81;
const STEPS: [f64; 3] = [1.0 / 60.0, 1.0 / 240.0, 2e-3];

fn material(restitution: f64, damping_time: f64) -> Material {
    Material { damping_time, restitution, ..Material::bearing(1e5, 0.01).expect("a material") }
}

fn host(gravity: f64) -> Host {
    let mut host = Host::new(RigidUnknowns::Eliminated);
    host.gravity = V3::new(0.0, 0.0, -gravity);
    host
}

/// A half-space, or the upper side of a still box.
fn add_floor(host: &mut Host, is_mesh: bool, material: Material) {
    if is_mesh {
        let slab = shapes::cube(4).map(|[x, y, z]| [10.0 * x, 10.0 * y, 0.5 * z - 0.5]);
        let body = host.scene.add(slab.mesh());
        host.system.add_moved(&host.scene, body, material).expect("a floor");
    } else {
        host.system.add_half_space([0.0, 0.0, 1.0], 0.0, material).expect("a floor");
    }
}

fn add_body(host: &mut Host, is_ball: bool, material: Material, position: V3, turn: Matrix3<f64>) {
    if is_ball {
        add_rigid(host, &shapes::sphere(3).scaled(0.2), material, position, turn);
    } else {
        add_box(host, material, position, turn);
    }
}

/// Of motion and height.
fn energy(host: &Host) -> f64 {
    host.kinetic() + host.rigids.iter().map(|rigid| rigid.mass * G * rigid.position.z).sum::<f64>()
}

/// All kinds of bodies, floors, steps, damping times and coefficients.
fn for_each_kind(mut trial: impl FnMut(bool, bool, f64, f64, f64)) {
    for (is_ball, is_mesh) in [(true, false), (true, true), (false, false), (false, true)] {
        for (dt, damping_time) in STEPS.into_iter().flat_map(|dt| [0.0, 0.05].map(|time| (dt, time))) {
            [0.5, 0.9].into_iter().for_each(|restitution| trial(is_ball, is_mesh, dt, damping_time, restitution));
        }
    }
}

#[test]
fn what_falls_on_a_floor_rises_as_restitution_says() {
    let mut worst = [0.0_f64; 2];
    for_each_kind(|is_ball, is_mesh, dt, damping_time, restitution| {
        let mut host = host(G);
        // The larger of two counts.
        add_floor(&mut host, is_mesh, material(0.0, damping_time));
        add_body(
            &mut host,
            is_ball,
            material(restitution, damping_time),
            V3::new(0.03, 0.02, 1.2),
            Matrix3::identity(),
        );
        let (start, mut fastest) = (energy(&host), 0.0_f64);
        let mut risen = 0.0;
        for _ in 0..(1.0 / dt) as usize {
            let before = host.rigids[0].velocity[2];
            host.step(dt);
            let now = host.rigids[0].velocity[2];
            worst[1] = worst[1].max(energy(&host) / start - 1.0);
            if now > 0.0 && fastest > 0.0 && risen == 0.0 {
                risen = now;
            }
            fastest = fastest.max(-before.min(now));
        }
        let error = (risen / fastest - restitution).abs();
        println!("{is_ball} {is_mesh} {dt:.4} {damping_time} {restitution}: {}", risen / fastest);
        worst[0] = worst[0].max(error);
        assert!(error < 0.03, "{is_ball} {is_mesh} {dt} {damping_time} {restitution}: {}", risen / fastest);
        assert!(worst[1] < 1e-12, "energy rises by {}", worst[1]);
    });
    println!("restitution wrong by up to {}, energy gained {}", worst[0], worst[1]);
}

#[test]
fn what_meets_parts_as_restitution_says_and_keeps_momentum() {
    let (mut worst, mut lost) = (0.0_f64, 0.0_f64);
    for_each_kind(|is_ball, other_is_ball, dt, damping_time, restitution| {
        let mut host = host(0.0);
        let own = material(restitution, damping_time);
        add_body(&mut host, is_ball, own, V3::zeros(), Matrix3::identity());
        add_body(&mut host, other_is_ball, own, V3::new(0.55, 0.0, 0.0), Matrix3::identity());
        host.rigids[0].velocity[0] = 2.0;
        (0..(0.3 / dt) as usize).for_each(|_| host.step(dt));
        let [a, b] = [0, 1].map(|k| host.rigids[k].velocity);
        let parted = (b[0] - a[0]) / 2.0;
        println!("{is_ball} {other_is_ball} {dt:.4} {damping_time} {restitution}: {parted}");
        worst = worst.max((parted - restitution).abs());
        lost = lost.max((0..3).map(|k| (a[k] + b[k] - if k == 0 { 2.0 } else { 0.0 }).abs()).fold(0.0, f64::max));
        assert!(worst < 0.03 && lost < 1e-12, "{is_ball} {other_is_ball} {dt} {damping_time} {restitution}: {parted}");
    });
    println!("restitution wrong by up to {worst}, momentum by {lost} of 2 m/s");
}

/// A glancing ball keeps what goes along the floor.
#[test]
fn only_motion_into_a_floor_returns() {
    for (is_mesh, dt) in [false, true].into_iter().flat_map(|is_mesh| STEPS.map(|dt| (is_mesh, dt))) {
        let mut host = host(0.0);
        let slippery = Material { friction: 0.0, ..material(0.9, 0.05) };
        add_floor(&mut host, is_mesh, slippery);
        add_body(&mut host, true, slippery, V3::new(-0.5, 0.0, 0.6), Matrix3::identity());
        host.rigids[0].velocity = [3.0, 0.0, -4.0, 0.0, 0.0, 0.0];
        (0..(0.3 / dt) as usize).for_each(|_| host.step(dt));
        let [x, y, z, ..] = host.rigids[0].velocity;
        println!("{is_mesh} {dt:.4}: {x} {y} {z}");
        assert!((x - 3.0).abs() < 0.15 && y.abs() < 0.15 && (z - 3.6).abs() < 0.12, "{is_mesh} {dt}: {x} {y} {z}");
    }
}

#[test]
fn a_box_at_rest_stays_at_rest() {
    for (is_mesh, dt) in [false, true].into_iter().flat_map(|is_mesh| STEPS.map(|dt| (is_mesh, dt))) {
        let fastest = |restitution: f64| {
            let mut host = host(G);
            add_floor(&mut host, is_mesh, material(restitution, 0.05));
            add_box(&mut host, material(restitution, 0.05), V3::new(0.0, 0.0, 0.2), Matrix3::identity());
            let (start, mut fastest) = (energy(&host), 0.0_f64);
            for _ in 0..(2.0 / dt) as usize {
                host.step(dt);
                assert!(energy(&host) <= start * (1.0 + 1e-12));
                fastest = host.rigids[0].velocity.iter().fold(fastest, |most, v| most.max(v.abs()));
            }
            fastest
        };
        let [bouncing, dull] = [0.9, 0.0].map(fastest);
        println!("{is_mesh} {dt:.4}: {bouncing} {dull} m/s");
        assert_eq!(bouncing, dull, "{is_mesh} {dt}");
    }
}

/// Tilted boxes and balls that fall on one another.
#[test]
fn bouncing_bodies_gain_no_energy() {
    for (is_mesh, dt) in [false, true].into_iter().flat_map(|is_mesh| STEPS.map(|dt| (is_mesh, dt))) {
        let mut host = host(G);
        let own = material(0.9, 0.05);
        add_floor(&mut host, is_mesh, own);
        for k in 0..5 {
            let turn = rotation(&V3::new(0.3 * k as f64, 0.2, 0.5 - 0.3 * k as f64));
            let at = V3::new(0.05 * k as f64, -0.04 * k as f64, 0.4 + 0.7 * k as f64);
            add_body(&mut host, k % 2 == 1, own, at, turn);
        }
        let (start, mut highest) = (energy(&host), 0.0_f64);
        for _ in 0..(3.0 / dt) as usize {
            host.step(dt);
            highest = highest.max(energy(&host) / start);
        }
        println!("{is_mesh} {dt:.4}: up to {highest} of the energy, {} J of motion left", host.kinetic());
        assert!(highest <= 1.0, "{is_mesh} {dt}: {highest}");
    }
}

/// Apart by little, balls hand on (1 + e) / 2 of the speed each.
#[test]
fn a_cradle_hands_on_what_restitution_leaves() {
    for dt in STEPS {
        let mut host = host(0.0);
        let ball = shapes::sphere(3).scaled(0.2);
        for k in 0..5 {
            add_rigid(&mut host, &ball, material(0.9, 0.05), V3::new(0.41 * k as f64, 0.0, 0.0), Matrix3::identity());
        }
        host.rigids[0].velocity[0] = 0.5;
        (0..(1.0 / dt) as usize).for_each(|_| host.step(dt));
        let speeds: Vec<f64> = host.rigids.iter().map(|ball| ball.velocity[0]).collect();
        println!("{dt:.4}: {speeds:?}");
        for (k, speed) in speeds.iter().enumerate() {
            let expected = if k == 4 { 0.95_f64.powi(4) } else { 0.05 * 0.95_f64.powi(k as i32) };
            assert!((speed / 0.5 - expected).abs() < 0.01, "{dt}: {speeds:?}");
        }
        assert!((speeds.iter().sum::<f64>() - 0.5).abs() < 1e-12);
    }
}
