//! The implicit midpoint rule on the contact system: a step is begun with half its length, and what the solve gives are the
//! velocities in its middle.

use super::bodies::{add_box, add_rigid, add_soft};
use crate::common::host::{Host, rotation};
use crate::common::shapes;
use nalgebra::{Matrix3, Vector3};
use raycontact::contact::DetectionOptions;
use raycontact::system::{Material, RigidUnknowns};

type V3 = Vector3<f64>;

fn host() -> Host {
    let mut host = Host::new(RigidUnknowns::Eliminated);
    host.scene.set_options(DetectionOptions { escape: false, ..DetectionOptions::default() });
    (host.solves, host.goal) = (20, 1e-9);
    host
}

fn undamped(stiffness: f64) -> Material {
    Material { stiffness, damping_time: 0.0, friction: 0.0, depth_cap: f64::INFINITY, restitution: 0.0 }
}

/// Rigid balls of 10 kg and 0.4 m in a row, a little apart, the first with 1 m/s towards the others.
fn row_of_balls(count: usize) -> Host {
    let mut host = host();
    let ball = shapes::sphere(3).scaled(0.2);
    for k in 0..count {
        add_rigid(&mut host, &ball, undamped(4e6), V3::new(0.401 * k as f64, 0.0, 0.0), Matrix3::identity());
    }
    host.rigids[0].velocity[0] = 1.0;
    host
}

/// Lets them collide; gives the number of steps with contacts.
fn collide(host: &mut Host, dt: f64, seconds: f64) -> usize {
    let mut touching = 0;
    for _ in 0..(seconds / dt) as usize {
        host.midpoint_step(dt);
        touching += usize::from(!host.system.contacts().is_empty());
    }
    touching
}

/// Implicit Euler loses a sixth of the speed here.
#[test]
fn balls_part_as_fast_as_they_met() {
    let mut host = row_of_balls(2);
    let touching = collide(&mut host, 2e-3, 0.3);
    assert!((25..40).contains(&touching), "{touching} steps in contact");
    let parted = host.rigids[1].velocity[0] - host.rigids[0].velocity[0];
    let mut by_euler = row_of_balls(2);
    (0..150).for_each(|_| by_euler.step(2e-3));
    let euler = by_euler.rigids[1].velocity[0] - by_euler.rigids[0].velocity[0];
    println!("{touching} steps in contact, restitution {parted}, by implicit Euler {euler}");
    assert!(euler < 0.9, "{euler}");
    assert!((0.98..1.005).contains(&parted), "restitution {parted}");
}

#[test]
fn a_newtons_cradle_hands_on_its_speed() {
    let mut host = row_of_balls(5);
    collide(&mut host, 2e-3, 0.6);
    let last = host.rigids[4].velocity[0];
    println!("the last of five balls: {last} m/s");
    assert!((0.98..1.005).contains(&last), "{last} m/s");
    // Compliant balls of one size leave some of the motion to the fourth.
    assert!(host.rigids[..4].iter().all(|ball| ball.velocity[0].abs() < 0.035));
}

/// What the rule does not keep is the energy of an impact in which contacts come and go: the longer the steps, the more is won.
/// Ten milliseconds are thirteen steps in contact.
#[test]
fn a_turned_box_gains_little_energy() {
    for (dt, most) in [(2e-3, 0.01), (5e-3, 0.02), (1e-2, 0.05)] {
        let mut host = host();
        for (position, turn) in [([0.0; 3], [0.0; 3]), ([0.5, 0.03, 0.02], [0.0, 0.1, 0.3])] {
            add_box(&mut host, undamped(4e6), V3::from(position), rotation(&V3::from(turn)));
        }
        host.rigids[0].velocity[0] = 1.0;
        let before = host.kinetic();
        let touching = collide(&mut host, dt, 0.4);
        let gained = host.kinetic() / before - 1.0;
        println!("{dt} s: {touching} steps in contact, energy gained {gained}");
        assert!(touching > 5 && gained.abs() < most, "{dt} s: {gained}");
    }
}

#[test]
fn a_bounce_is_of_order_two() {
    let height = |dt: f64| {
        let mut host = host();
        host.gravity = V3::new(0.0, 0.0, -9.81);
        host.system.add_half_space([0.0, 0.0, 1.0], 0.0, undamped(1e5)).expect("a floor");
        add_soft(&mut host, &shapes::sphere(2).scaled(0.2).moved([0.0, 0.0, 0.25]), undamped(1e5), Matrix3::identity());
        host.v.iter_mut().skip(2).step_by(3).for_each(|z| *z = -1.0);
        (0..(0.4 / dt).round() as usize).for_each(|_| host.midpoint_step(dt));
        host.x.iter().skip(2).step_by(3).sum::<f64>() / host.masses.len() as f64
    };
    let heights: Vec<f64> = (0..6).map(|k| height(0.02 / f64::from(1 << k))).collect();
    let errors: Vec<f64> = heights[..4].iter().map(|height| (height - heights[5]).abs()).collect();
    // Steps of 20, 10, 5 and 2.5 ms.
    let order = (errors[0] / errors[3]).log2() / 3.0;
    println!("order {order}");
    assert!(order >= 1.8 && errors.is_sorted_by(|one, next| one >= next), "order {order}: {errors:?}");
}
