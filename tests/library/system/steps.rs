//! What a step does beside its forces: it looks ahead, looks again, lets pairs escape, and serves explicit hosts.

use super::bodies::{add_box, add_soft};
use crate::common::host::{Host, at, rotation};
use crate::common::shapes;
use nalgebra::{DMatrix, Matrix3, Vector3};
use raycontact::system::{Carriers, Material, RigidUnknowns};

type V3 = Vector3<f64>;

fn material(stiffness: f64) -> Material {
    Material { stiffness, damping_time: 0.0, friction: 0.0, depth_cap: f64::INFINITY, restitution: 0.0 }
}

/// Displaced volume times stiffness, as for a body in water: a half-space, in any pose.
#[test]
fn a_half_space_bears_the_volume_below_it() {
    let mut host = Host::new(RigidUnknowns::Kept);
    let ball = shapes::sphere(4);
    let body = host.scene.add(ball.mesh());
    let nodes = host.add_nodes(&ball.positions, 1.0);
    let normal = V3::new(0.48, -0.6, 0.64);
    host.system.add_deformable(&host.scene, body, nodes, Carriers::Nodes, material(1e6)).expect("a body");
    host.system.add_half_space(normal.into(), -0.4, material(1e3)).expect("a floor");
    let still = vec![0.0; host.x.len()];
    host.system.begin(&mut host.scene, 0.01, &host.x, &still, &still).expect("a step");
    let mut forces = still.clone();
    host.system.add_forces(&still, &mut forces).expect("a step is under way");
    let net = (0..host.masses.len()).fold(V3::zeros(), |sum, node| sum + at(&forces, node));
    // A cap of height 0.6 of the unit ball, and both stiffnesses in series.
    let volume = std::f64::consts::PI * 0.6 * 0.6 * (3.0 - 0.6) / 3.0;
    let expected = normal * (volume * 1e6 * 1e3 / (1e6 + 1e3));
    assert!((net - expected).norm() < 0.01 * expected.norm(), "{net:?}, not {expected:?}");
}

/// Two boxes that would pass through each other within one step are stopped in it.
#[test]
fn an_impact_is_met_in_the_step_in_which_it_happens() {
    let mut host = Host::new(RigidUnknowns::Eliminated);
    for side in [-1.0, 1.0] {
        add_box(&mut host, material(1e6), V3::new(0.3 * side, 0.0, 0.0), Matrix3::identity());
        host.rigids.last_mut().expect("it was added").velocity[0] = -5.0 * side;
    }
    host.step(0.05);
    let [left, right] = [0, 1].map(|k| host.rigids[k].position.x);
    assert!(left < right - 0.35, "{left} and {right}");
    let speed = host.rigids[0].velocity[0];
    assert!(speed < 2.5, "{speed}");
}

/// A row of boxes: the first is thrown at the second, which would stay where it is, and that one then meets the third.
#[test]
fn what_is_set_going_meets_the_next_in_the_same_step() {
    let run = |detects_again| {
        let mut host = Host::new(RigidUnknowns::Eliminated);
        let stiff = Material { depth_cap: 0.02, ..material(1e6) };
        for k in 0..3 {
            add_box(&mut host, stiff, V3::new(0.45 * f64::from(k), 0.0, 0.0), Matrix3::identity());
        }
        host.rigids[0].velocity[0] = 6.0;
        host.detects_again = detects_again;
        host.step(0.05);
        host.rigids[2].velocity[0]
    };
    assert_eq!(run(false), 0.0, "detection took the second to stay");
    assert!(run(true) > 0.5, "{}", run(true));
}

/// A small box inside a large one has no contact to part them, and leaves.
#[test]
fn a_swallowed_body_escapes() {
    let mut host = Host::new(RigidUnknowns::Eliminated);
    add_soft(&mut host, &shapes::cube(2).scaled(0.5), material(1e4), Matrix3::identity());
    add_box(&mut host, material(1e4), V3::new(0.05, 0.02, 0.1), rotation(&V3::new(0.1, 0.2, 0.0)));
    (0..300).for_each(|_| host.step(1.0 / 60.0));
    assert!(host.system.contacts().is_empty());
    let [a, b] = [0, 1].map(|body| *host.scene.mesh(body).expect("it is there").aabb());
    let apart = (0..3).any(|axis| a.lower[axis] > b.upper[axis] || b.lower[axis] > a.upper[axis]);
    assert!(apart, "{a:?}, {b:?}");
}

/// The bound lies below what the matrix' largest eigenvalue allows, and not far.
#[test]
fn the_longest_explicit_step_is_stable_and_no_trifle() {
    let mut host = Host::new(RigidUnknowns::Kept);
    add_soft(&mut host, &shapes::cube(3).scaled(0.2), material(1e5), Matrix3::identity());
    add_box(&mut host, material(1e5), V3::new(0.03, 0.02, 0.37), rotation(&V3::new(0.05, 0.03, 0.4)));
    let count = host.system.unknown_count();
    let (dt, mut forces) = (1e-4, vec![0.0; count]);
    host.set_motions(dt);
    let still = vec![0.0; host.x.len()];
    let longest = host.system.explicit_step(&mut host.scene, dt, &host.x, &still, &mut forces).expect("a step");
    host.system.begin(&mut host.scene, dt, &host.x, &still, &still).expect("a step");
    // As begun with no velocity, the forces are those of where the bodies are.
    let mut implicit = vec![0.0; count];
    host.system.add_forces(&vec![0.0; count], &mut implicit).expect("a step is under way");
    let size = implicit.iter().map(|force| force.abs()).fold(0.0, f64::max);
    assert!(size > 1.0);
    assert!(forces.iter().zip(&implicit).all(|(a, b)| (a - b).abs() < 1e-9 * size));

    let mut mass = DMatrix::<f64>::zeros(count, count);
    let nodes = 3 * host.masses.len();
    (0..nodes).for_each(|k| mass[(k, k)] = host.masses[k / 3]);
    let rigid = &host.rigids[0];
    let inertia = rigid.rotation * rigid.inertia * rigid.rotation.transpose();
    for row in 0..3 {
        mass[(nodes + row, nodes + row)] = rigid.mass;
        (0..3).for_each(|column| mass[(nodes + 3 + row, nodes + 3 + column)] = inertia[(row, column)]);
    }
    let mut stiffness = DMatrix::<f64>::zeros(count, count);
    let add = |row: usize, column: usize, block: [f64; 9]| {
        (0..9).for_each(|k| stiffness[(3 * row + k / 3, 3 * column + k % 3)] += block[k]);
    };
    host.system.for_each_block(1.0 / dt, add).expect("rigid bodies are kept");
    let factor = mass.cholesky().expect("positive definite").l();
    let inner = factor.solve_lower_triangular(&stiffness).expect("regular");
    let inner = factor.solve_lower_triangular(&inner.transpose()).expect("regular");
    let largest = ((&inner + inner.transpose()) * 0.5).symmetric_eigenvalues().max();
    let limit = 2.0 / largest.sqrt();
    assert!(longest <= limit && longest > 0.3 * limit, "{longest} of {limit}");
}

/// A box dropped on a floor and integrated explicitly at the bound gains nothing and comes to rest.
#[test]
fn an_explicit_host_is_stable_at_the_bound() {
    let mut host = Host::new(RigidUnknowns::Kept);
    let damped = Material { damping_time: 0.005, friction: 0.4, ..material(1e5) };
    add_box(&mut host, damped, V3::new(0.0, 0.0, 0.5), rotation(&V3::new(0.1, 0.2, 0.3)));
    host.system.add_half_space([0.0, 0.0, 1.0], 0.0, damped).expect("a floor");
    let (mut time, mut most) = (0.0, 0.0f64);
    let start = 10.0 * 9.81 * 0.5;
    while time < 3.0 {
        let mut forces = vec![0.0; 6];
        host.set_motions(1e-3);
        let longest = host.system.explicit_step(&mut host.scene, 1e-3, &[], &[], &mut forces).expect("a step");
        let dt = longest.min(0.01);
        let rigid = &mut host.rigids[0];
        let inertia = rigid.rotation * rigid.inertia * rigid.rotation.transpose();
        let spin = inertia.try_inverse().expect("regular") * V3::new(forces[3], forces[4], forces[5]);
        for axis in 0..3 {
            let gravity = if axis == 2 { -9.81 } else { 0.0 };
            rigid.velocity[axis] += dt * (forces[axis] / rigid.mass + gravity);
            rigid.velocity[axis + 3] += dt * spin[axis];
            rigid.position[axis] += dt * rigid.velocity[axis];
        }
        let [.., x, y, z] = rigid.velocity;
        rigid.rotation = rotation(&(V3::new(x, y, z) * dt)) * rigid.rotation;
        time += dt;
        most = most.max(host.kinetic() + 10.0 * 9.81 * host.rigids[0].position.z);
    }
    assert!(most < 1.02 * start, "{most} J of {start} J");
    assert!(host.kinetic() < 1e-3 * start, "it comes to rest: {}", host.kinetic());
    assert!((host.rigids[0].position.z - 0.2).abs() < 0.02);
}

/// In single precision detection only is coarser.
#[test]
fn both_precisions_agree() {
    fn net<T: raycontact::math::Scalar>() -> V3 {
        let mut scene = raycontact::scene::Scene::<T>::new(1).expect("no thread is started");
        let mut system = raycontact::system::ContactSystem::<T>::new(RigidUnknowns::Eliminated);
        let shapes = [shapes::sphere(2), shapes::sphere(2).moved([0.5, 0.4, 1.3])];
        let x: Vec<f64> = shapes.iter().flat_map(|shape| shape.positions.iter().flatten().copied()).collect();
        let count = shapes[0].positions.len() as u32;
        system.set_node_masses(&vec![1.0; 2 * count as usize]).expect("masses");
        for (shape, first) in shapes.iter().zip([0, count]) {
            let body = scene.add(shape.mesh());
            system.add_deformable(&scene, body, first..first + count, Carriers::Nodes, material(1e4)).expect("a body");
        }
        let (still, mut forces) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        system.begin(&mut scene, 0.01, &x, &still, &still).expect("a step");
        system.add_forces(&still, &mut forces).expect("a step is under way");
        (0..count as usize).fold(V3::zeros(), |sum, node| sum + at(&forces, node))
    }
    let (single, double) = (net::<f32>(), net::<f64>());
    assert!(double.norm() > 100.0 && (single - double).norm() < 1e-3 * double.norm(), "{single:?}, {double:?}");
}
