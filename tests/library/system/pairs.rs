//! What hosts may ask for: materials of a pair's own, contacts where bodies are; and what they may
//! know: the force of a pair, and whether a solve was right.

use super::bodies::{add_box, add_soft};
use crate::common::host::{Host, at, box_inertia, rotation};
use crate::common::shapes;
use nalgebra::{Matrix3, Vector3};
use raycontact::force::Weighting;
use raycontact::system::{ContactSystem, Material, RigidUnknowns, Surface};

type V3 = Vector3<f64>;

fn material(stiffness: f64) -> Material {
    Material { stiffness, damping_time: 0.02, friction: 0.0, depth_cap: f64::INFINITY, restitution: 0.0 }
}

fn net(forces: &[f64]) -> V3 {
    (0..forces.len() / 3).fold(V3::zeros(), |sum, node| sum + at(forces, node))
}

/// Two soft cubes of 0.4 m, the second 0.05 m into the first along x.
fn two_soft_cubes(system: ContactSystem<f64>) -> Host {
    let mut host = Host::new(RigidUnknowns::Eliminated);
    host.system = system;
    let cube = shapes::cube(2).scaled(0.2);
    add_soft(&mut host, &cube, material(1e5), Matrix3::identity());
    add_soft(&mut host, &cube.map(|[x, y, z]| [x + 0.35, y + 0.01, z + 0.02]), material(1e5), Matrix3::identity());
    host
}

fn begin(host: &mut Host, dt: f64, free: &[f64]) {
    let still = vec![0.0; host.x.len()];
    host.system.begin(&mut host.scene, dt, &host.x, &still, free).expect("a step");
}

fn forces(host: &mut Host, velocities: &[f64]) -> Vec<f64> {
    let mut forces = vec![0.0; velocities.len()];
    host.system.add_forces(velocities, &mut forces).expect("a step is under way");
    forces
}

/// A floor may be as stiff for one body as the host says, and goes back to the rule for all.
#[test]
fn a_body_and_a_half_space_may_have_a_material_of_their_own() {
    let mut host = Host::new(RigidUnknowns::Eliminated);
    add_soft(&mut host, &shapes::cube(2).scaled(0.2), material(1e5), Matrix3::identity());
    // 0.02 m of the cube lie below: that depth times its face.
    let floor = host.system.add_half_space([0.0, 0.0, 1.0], -0.18, material(3e5)).expect("a floor");
    let mut lift = |own: Option<Material>| {
        host.system.set_half_space_material(0, floor, own).expect("both are there");
        let still = vec![0.0; host.x.len()];
        begin(&mut host, 0.01, &still);
        let force = net(&forces(&mut host, &still));
        host.system.cancel();
        force.z
    };
    for (own, stiffness) in [(Some(material(7e5)), 7e5), (None, 7.5e4), (Some(material(0.0)), 0.0)] {
        let (found, expected) = (lift(own), stiffness * 0.02 * 0.16);
        assert!((found - expected).abs() <= 1e-9 * expected, "{found} N, not {expected}");
    }
}

/// By Newton's laws: what a body gains in a step comes from the other, and from the floor.
#[test]
fn the_force_of_a_pair_is_the_momentum_that_it_exchanges() {
    let mut host = Host::new(RigidUnknowns::Eliminated);
    for side in [-1.0, 1.0] {
        add_box(&mut host, material(1e5), V3::new(0.19 * side, 0.02 * side, 0.19), Matrix3::identity());
        host.rigids.last_mut().expect("it was added").velocity[0] = -side;
    }
    let floor = host.system.add_half_space([0.0, 0.0, 1.0], 0.0, material(1e5)).expect("a floor");
    let (dt, mass) = (0.01, 10.0);
    let mut most: f64 = 0.0;
    for _ in 0..20 {
        let before: Vec<V3> = host.rigids.iter().map(|rigid| V3::from_column_slice(&rigid.velocity[..3])).collect();
        host.step(dt);
        let force = |body, other| V3::from(host.system.pair_force(body, other).expect("they are there"));
        let pair = force(0, Surface::Body(1));
        assert!((pair + force(1, Surface::Body(0))).norm() <= 1e-12 * pair.norm());
        for (body, before) in [0, 1].into_iter().zip(before) {
            let other = Surface::Body(1 - body);
            let gained = V3::from_column_slice(&host.rigids[body as usize].velocity[..3]) - before;
            let given = (force(body, other) + force(body, Surface::HalfSpace(floor))) * (dt / mass);
            assert!((gained - given).norm() < 1e-9 * (1.0 + gained.norm()), "{gained:?}, not {given:?}");
        }
        most = most.max(pair.norm());
        assert_eq!(force(0, Surface::Body(0)), V3::zeros());
    }
    assert!(most > 100.0, "they have met: {most} N");
}

/// At the start of a step two cubes that will pass through each other do not touch yet; those that overlap have the law that
/// they have ahead, in whatever direction they are thought to go.
#[test]
fn a_system_may_look_where_bodies_are() {
    let dt = 0.02;
    let system = || ContactSystem::new(RigidUnknowns::Eliminated);
    for (makes, contacts) in [(system(), true), (system().looking_at_the_start(), false)] {
        let mut host = two_soft_cubes(makes);
        let nodes = host.x.len() / 2;
        host.x[nodes..].iter_mut().step_by(3).for_each(|x| *x += 0.1);
        let mut free = vec![0.0; host.x.len()];
        free[nodes..].iter_mut().step_by(3).for_each(|v| *v = -10.0);
        begin(&mut host, dt, &free);
        assert_eq!(!host.system.contacts().is_empty(), contacts);
    }
    let (mut ahead, mut start) = (two_soft_cubes(system()), two_soft_cubes(system().looking_at_the_start()));
    let still = vec![0.0; ahead.x.len()];
    let half = still.len() / 2;
    let closing: Vec<f64> = (0..still.len()).map(|k| if k >= half && k % 3 == 0 { -0.3 } else { 0.1 }).collect();
    begin(&mut ahead, dt, &still);
    begin(&mut start, dt, &closing);
    let (one, other) = (forces(&mut ahead, &closing), forces(&mut start, &closing));
    let size: f64 = one.iter().map(|f| f * f).sum::<f64>().sqrt();
    let apart: f64 = one.iter().zip(&other).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    assert!(size > 100.0 && apart < 1e-9 * size, "{apart} of {size} N");
}

/// Weighted by vertex, a contact pushes with stiffness · cos α · depth, whatever area it stands for.
#[test]
fn contacts_may_be_weighted_alike() {
    for (weighting, is_alike) in [(Weighting::Area, false), (Weighting::Vertex, true)] {
        let mut host = two_soft_cubes(ContactSystem::new(RigidUnknowns::Eliminated).weighted_by(weighting));
        let still = vec![0.0; host.x.len()];
        begin(&mut host, 1e-9, &still);
        let found = net(&forces(&mut host, &still)[still.len() / 2..]);
        let mut expected = V3::zeros();
        for contact in &host.system.contacts().contacts {
            let area = if is_alike { 1.0 } else { contact.area };
            let sign = if contact.colliding == 1 { 5e4 } else { -5e4 };
            expected += contact.direction * (sign * area * contact.cos_alpha * contact.depth);
        }
        let gap = (found - expected).norm();
        assert!(expected.norm() > 10.0 && gap < 1e-9 * expected.norm(), "{gap} of {} N", expected.norm());
    }
}

/// A light box on a soft cube, whose nodes something else holds up: a host that solves once brings the box to rest, though both
/// are expected to fall and the cube, once pushed, seems to leave the box.
#[test]
fn what_is_light_comes_to_rest_in_long_steps() {
    let mut host = Host::new(RigidUnknowns::Eliminated);
    let (dt, mass, gravity) = (0.05, 0.01, V3::new(0.0, 0.0, -10.0));
    add_soft(&mut host, &shapes::cube(2).scaled(0.2), material(2e5), Matrix3::identity());
    add_box(&mut host, material(2e5), V3::new(0.03, 0.02, 0.5), Matrix3::identity());
    let inertia = box_inertia(mass, [0.4; 3]);
    host.system.remove(1).expect("it is there");
    host.system.add_rigid(&host.scene, 1, mass, inertia, material(2e5)).expect("a light one");
    host.rigids[0].mass = mass;
    host.gravity = gravity;
    let still = vec![0.0; host.x.len()];
    let falling: Vec<f64> = (0..still.len()).map(|k| dt * gravity[k % 3]).collect();
    let mut fastest: f64 = 0.0;
    for step in 0..80 {
        host.set_motions(dt);
        host.system.begin(&mut host.scene, dt, &host.x, &still, &falling).expect("a step");
        host.system.finish(&still).expect("a step is under way");
        let velocity = host.system.rigid_velocity(1).expect("it is rigid");
        let rigid = &mut host.rigids[0];
        rigid.velocity = velocity;
        let (linear, angular) = (V3::from_column_slice(&velocity[..3]), V3::from_column_slice(&velocity[3..]));
        rigid.position += linear * dt;
        rigid.rotation = rotation(&(angular * dt)) * rigid.rotation;
        if step >= 60 {
            fastest = fastest.max(linear.norm());
            let force = host.system.pair_force(1, Surface::Body(0)).expect("they are there");
            assert!((force[2] - 0.1).abs() < 0.005, "{} N in step {step}", force[2]);
        }
    }
    assert!(fastest < 0.01, "{fastest} m/s");
}

/// It is known how wrong a solve was without another law than it was solved with.
#[test]
fn a_solve_may_be_judged_and_left_as_it_is() {
    let mut host = two_soft_cubes(ContactSystem::new(RigidUnknowns::Eliminated));
    let still = vec![0.0; host.x.len()];
    begin(&mut host, 0.01, &still);
    assert!(host.system.misjudged(&still).expect("a step is under way") < 1e-12);
    // The second cube goes off so fast that hardly anything would push.
    let half = still.len() / 2;
    let parting: Vec<f64> = (0..still.len()).map(|k| if k >= half && k % 3 == 0 { 20.0 } else { 0.0 }).collect();
    let before = forces(&mut host, &parting);
    let judged = host.system.misjudged(&parting).expect("a step is under way");
    assert_eq!(forces(&mut host, &parting), before);
    assert!((0.9..1.0).contains(&judged), "{judged}");
    assert_eq!(host.system.linearise(&parting).expect("a step is under way").to_bits(), judged.to_bits());
    let pull = net(&before[half..]).norm();
    let left = net(&forces(&mut host, &parting)[half..]).norm();
    assert!(left < 0.05 * pull, "{left} of {pull} N");
}

#[test]
fn what_is_not_there_has_no_material_and_no_force() {
    let mut host = two_soft_cubes(ContactSystem::new(RigidUnknowns::Eliminated));
    let material = Some(material(1e5));
    for message in [
        host.system.set_half_space_material(0, 0, material).expect_err("no half-space").to_string(),
        host.system.pair_force(0, Surface::HalfSpace(0)).expect_err("no half-space").to_string(),
    ] {
        assert!(message.contains("no half-space 0; 0 were added"), "{message}");
    }
    host.system
        .add_half_space([0.0, 0.0, 1.0], 0.0, Material::bearing(1e3, 0.1).expect("a material"))
        .expect("a floor");
    host.system.set_half_space_material(9, 0, material).expect_err("no body 9");
    host.system.pair_force(0, Surface::Body(9)).expect_err("no body 9");
    host.system.misjudged(&[]).expect_err("no step");
    assert_eq!(host.system.pair_force(1, Surface::Body(0)).expect("both are there"), [0.0; 3]);
}

/// A box of 0.4 m and 10 kg is borne by its buoyancy where its weight is more than the stiffness times half of its volume, and
/// says so at rest; on the same floor, twenty times as stiff, it lies 1/30 of its height deep.
#[test]
fn a_body_borne_by_its_buoyancy_is_counted_at_rest() {
    let weight = 10.0 * 9.81;
    for is_half_space in [true, false] {
        for (part_inside, expected) in [(0.6, 1), (0.03, 0)] {
            let mut host = Host::new(RigidUnknowns::Eliminated);
            host.gravity = V3::new(0.0, 0.0, -9.81);
            // Two equal materials, in series.
            let stiffness = 2.0 * weight / (part_inside * 0.4f64.powi(3));
            let material = Material { damping_time: 0.3, ..material(stiffness) };
            if is_half_space {
                host.system.add_half_space([0.0, 0.0, 1.0], 0.0, material).expect("a floor");
            } else {
                let slab = shapes::cube(1).map(|[x, y, z]| [2.0 * x, 2.0 * y, z - 1.0]);
                let body = host.scene.add(slab.mesh());
                host.system.add_moved(&host.scene, body, material).expect("a floor");
            }
            add_box(&mut host, material, V3::new(0.0, 0.0, 0.2 - 0.4 * part_inside), Matrix3::identity());
            (0..400).for_each(|_| host.step(0.01));
            let box_ = &host.rigids[0];
            let (depth, speed) = (0.2 - box_.position.z, V3::from_row_slice(&box_.velocity[..3]).norm());
            // The slab's points inside the box are nearer to its sides than to its bottom, so the slab bears less.
            let (expected_depth, margin) = (0.4 * part_inside, if is_half_space { 1e-6 } else { 0.1 });
            assert!((depth / expected_depth - 1.0).abs() < margin, "{depth} m deep, not {expected_depth}");
            assert!(speed < 1e-6, "{speed} m/s");
            assert_eq!(host.system.contacts().statistics.deep_pairs, expected, "{depth} m deep, {is_half_space}");
        }
    }
}
