//! Coulomb friction against the textbook: what holds, what slides, and how fast.

use super::bodies::{add_box, add_cage, add_soft};
use crate::common::host::{Host, at, rotation};
use crate::common::shapes;
use nalgebra::Vector3;
use raycontact::system::{Material, RigidUnknowns};

type V3 = Vector3<f64>;
const G: f64 = 9.81;

/// What the body of a trial rests on.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Floor {
    HalfSpace,
    Slab,
}

/// What it is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Rigid,
    Soft,
    /// A sphere of 320 triangles in a cage of eight nodes.
    Cage,
}

/// Stiff enough that bodies sink in by less than a millimetre: deeper, a box's front edge digs into a slab.
fn material(friction: f64) -> Material {
    Material { stiffness: 4e6, damping_time: 0.02, friction, depth_cap: 0.05, restitution: 0.0 }
}

/// A body of 10 kg and about 0.4 m on a plane through the origin that is tilted about the axis y, so that it slides
/// along +x.
fn on_a_plane(kind: Kind, floor: Floor, tilt: f64, friction: f64) -> Host {
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
            let slab = shapes::cube(1).map(|[x, y, z]| (turn * V3::new(4.0 * x, 2.0 * y, 0.5 * z - 0.5)).into());
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

/// The velocity of the centre of mass.
fn speed(host: &Host) -> V3 {
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

fn centre(host: &Host) -> V3 {
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

const TILT: f64 = 0.2;
const STEPS: [f64; 2] = [1.0 / 60.0, 1.0 / 240.0];

fn run(host: &mut Host, time: f64, dt: f64) {
    (0..(time / dt).round() as usize).for_each(|_| host.step(dt));
}

/// Along the plane, downward.
fn downhill() -> V3 {
    V3::new(TILT.cos(), 0.0, -TILT.sin())
}

fn does_not_creep(kind: Kind) {
    for (floor, dt) in [Floor::HalfSpace, Floor::Slab].into_iter().flat_map(|floor| STEPS.map(|dt| (floor, dt))) {
        let mut host = on_a_plane(kind, floor, TILT, 0.5);
        run(&mut host, 1.0, dt);
        let from = centre(&host);
        run(&mut host, 1.0, dt);
        let creep = (centre(&host) - from).dot(&downhill());
        assert!(creep.abs() < 1e-3, "{kind:?} on {floor:?} at {dt} s creeps {creep} m/s");
    }
}

#[test]
fn a_rigid_body_that_friction_holds_does_not_creep() {
    does_not_creep(Kind::Rigid);
}

#[test]
fn a_soft_body_that_friction_holds_does_not_creep() {
    does_not_creep(Kind::Soft);
}

#[test]
fn a_caged_body_that_friction_holds_does_not_creep() {
    does_not_creep(Kind::Cage);
}

/// A box that leans on its lower edge, held by little more friction than it needs, in a host that solves once and linearises
/// nothing: what friction may bear is then a prediction for each row, and loads differ from row to row.
#[test]
fn a_single_solve_knows_which_rows_bear_the_load() {
    let (dt, tilt, friction) = (0.02, 0.3, 0.36);
    for floor in [Floor::HalfSpace, Floor::Slab] {
        let mut host = on_a_plane(Kind::Rigid, floor, tilt, friction);
        let mut settled = V3::zeros();
        for step in 0..250 {
            host.set_motions(dt);
            host.system.begin(&mut host.scene, dt, &[], &[], &[]).expect("a step");
            host.system.finish(&[]).expect("a step is under way");
            let rigid = &mut host.rigids[0];
            rigid.velocity = host.system.rigid_velocity(rigid.body).expect("it is rigid");
            let [linear, angular] = [0, 3].map(|k| V3::from_column_slice(&rigid.velocity[k..k + 3]));
            rigid.position += linear * dt;
            rigid.rotation = rotation(&(angular * dt)) * rigid.rotation;
            if step == 99 {
                settled = rigid.position;
            }
        }
        let way = (host.rigids[0].position - settled).norm();
        assert!(way < 1e-6, "{way} m in 3 s on a {floor:?}");
    }
}

#[test]
fn what_slides_is_as_fast_as_the_textbook_says() {
    let friction = 0.1;
    let expected = G * (TILT.sin() - friction * TILT.cos());
    let trials = [
        (Kind::Rigid, Floor::HalfSpace),
        (Kind::Rigid, Floor::Slab),
        (Kind::Soft, Floor::HalfSpace),
        (Kind::Soft, Floor::Slab),
        (Kind::Cage, Floor::HalfSpace),
    ];
    for ((kind, floor), dt) in trials.into_iter().flat_map(|trial| STEPS.map(|dt| (trial, dt))) {
        let mut host = on_a_plane(kind, floor, TILT, friction);
        run(&mut host, 0.5, dt);
        let before = speed(&host).dot(&downhill());
        run(&mut host, 1.0, dt);
        let found = speed(&host).dot(&downhill()) - before;
        assert!((found - expected).abs() < 0.01 * expected, "{kind:?} on {floor:?} at {dt} s: {found}, not {expected}");
    }
}

/// A force that grows until the box gives way.
#[test]
fn a_pushed_box_starts_to_slide_at_the_load_times_the_coefficient() {
    let (friction, dt) = (0.4, 1.0 / 60.0);
    for floor in [Floor::HalfSpace, Floor::Slab] {
        for angle in [0.0, 0.7, 2.0] {
            let mut host = on_a_plane(Kind::Rigid, floor, 0.0, friction);
            run(&mut host, 0.5, dt);
            let most = friction * 10.0 * G;
            let along = V3::new(f64::cos(angle), f64::sin(angle), 0.0);
            let mut slides_at = 0.0;
            for step in 0..600 {
                let force = most * 1.2 * f64::from(step) / 600.0;
                host.rigids[0].push = along * force;
                host.step(dt);
                if speed(&host).dot(&along) > 0.003 {
                    slides_at = force;
                    break;
                }
            }
            assert!((slides_at - most).abs() < 0.02 * most, "{floor:?}, {angle}: slides at {slides_at} N of {most} N");
        }
    }
}

/// A box thrown along the floor stops after v² / 2 μ g, whichever way it goes.
#[test]
fn friction_is_the_same_in_all_directions_and_takes_energy_only() {
    let (friction, dt) = (0.3, 1.0 / 240.0);
    for angle in [0.0, 0.4, 1.0, 2.6, 4.0] {
        let mut host = on_a_plane(Kind::Rigid, Floor::HalfSpace, 0.0, friction);
        run(&mut host, 0.5, dt);
        let along = V3::new(f64::cos(angle), f64::sin(angle), 0.0);
        (0..3).for_each(|axis| host.rigids[0].velocity[axis] += 1.5 * along[axis]);
        let from = centre(&host);
        let mut before = host.kinetic();
        for _ in 0..240 {
            host.step(dt);
            // The box rocks forward as it brakes, which takes some of the load's energy.
            assert!(host.kinetic() <= before + 1e-3, "{} J after {before} J", host.kinetic());
            before = host.kinetic();
        }
        let way = centre(&host) - from;
        let expected = 1.5 * 1.5 / (2.0 * friction * G);
        assert!((way.dot(&along) - expected).abs() < 0.02 * expected, "{angle}: {way:?}, not {expected}");
        assert!(way.cross(&along).xy().norm() < 0.01 * expected, "{angle}: it goes aside, {way:?}");
        assert!(host.kinetic() < 1e-9, "{angle}: it rests");
    }
}
