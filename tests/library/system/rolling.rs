//! What rolls, slides or spins on a floor keeps its speed, whatever the damping of the surfaces.

use super::bodies::add_rigid;
use crate::common::host::Host;
use crate::common::shapes;
use nalgebra::{Matrix3, Vector3};
use raycontact::system::{Material, RigidUnknowns};

type V3 = Vector3<f64>;
const RADIUS: f64 = 0.2;
const WEIGHT: f64 = 98.1;

/// A rigid ball of 5120 triangles, 2 mm deep in a half-space or a slab, with the default damping.
fn on_a_floor(is_slab: bool, friction: f64, velocity: [f64; 6]) -> Host {
    let stiffness = WEIGHT / (std::f64::consts::PI * RADIUS * 0.002 * 0.002);
    let of_pair = Material { stiffness, friction, ..Material::bearing(1.0, 1.0).expect("a material") };
    // In series with another like it.
    let material = Material { stiffness: 2.0 * stiffness, ..of_pair };
    let mut host = Host::new(RigidUnknowns::Eliminated);
    host.gravity = V3::new(0.0, 0.0, -9.81);
    if is_slab {
        let slab = shapes::cube(1).map(|[x, y, z]| [8.0 * x, 2.0 * y, 0.5 * z - 0.5]);
        let body = host.scene.add(slab.mesh());
        host.system.add_moved(&host.scene, body, material).expect("a floor");
    } else {
        host.system.add_half_space([0.0, 0.0, 1.0], 0.0, material).expect("a floor");
    }
    let ball = shapes::sphere(4).scaled(RADIUS);
    add_rigid(&mut host, &ball, material, V3::new(0.0, 0.0, RADIUS - 0.002), Matrix3::identity());
    host.rigids[0].velocity = velocity;
    host
}

#[test]
fn a_ball_that_rolls_or_spins_keeps_its_speed_at_the_default_damping() {
    let turn = 1.0 / RADIUS;
    for (is_slab, dt) in [false, true].into_iter().flat_map(|slab| [1.0 / 60.0, 1.0 / 240.0].map(|dt| (slab, dt))) {
        for (what, friction, velocity, of) in
            [("rolls", 0.5, [1.0, 0.0, 0.0, 0.0, turn, 0.0], 0), ("spins", 0.0, [0.0, 0.0, 0.0, 0.0, 0.0, turn], 5)]
        {
            let mut host = on_a_floor(is_slab, friction, velocity);
            (0..(4.0_f64 / dt).round() as usize).for_each(|_| host.step(dt));
            let kept = host.rigids[0].velocity[of] / velocity[of];
            println!("{what}, slab {is_slab}, {dt:.4} s: {kept:.4} of its speed after 4 s");
            assert!((0.95..1.02).contains(&kept), "{what}, slab {is_slab}, {dt} s: {kept}");
        }
    }
}

/// Damping is for what bodies do to one another: a ball that falls while it rolls bounces as one that does not roll.
#[test]
fn a_ball_that_rolls_is_damped_as_it_falls() {
    let rebound = |velocity: [f64; 6]| {
        let mut host = on_a_floor(true, 0.5, velocity);
        host.rigids[0].position.z = RADIUS + 0.05;
        let mut highest = 0.0_f64;
        for step in 0..240 {
            host.step(1.0 / 240.0);
            highest = if step > 30 { highest.max(host.rigids[0].position.z - RADIUS) } else { 0.0 };
        }
        highest
    };
    let [still, rolling] = [0.0, 1.0].map(|speed| rebound([speed, 0.0, 0.0, 0.0, speed / RADIUS, 0.0]));
    println!("rebound to {still} m, and to {rolling} m as it rolls");
    assert!(still < 0.005 && rolling < 0.005, "{still} m, {rolling} m");
}
