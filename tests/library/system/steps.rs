//! What a step does beside its forces: it looks ahead, looks again, lets pairs escape, and serves explicit hosts.

use super::bodies::{add_box, add_soft};
use crate::common::host::{Host, Rigid, at, rotation, rows_of};
use crate::common::shapes;
use nalgebra::{DMatrix, Matrix3, Vector3};
use raycontact::system::{Carriers, Material, RigidUnknowns};
use std::f64::consts::TAU;

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

/// A star that falls with one of its spikes on a bumpy ground. The spike's contacts push against each other, so the pair begins
/// to escape, slantwise since that way is the shortest. The star falls on meanwhile, and that way becomes the longer one.
#[test]
fn a_star_that_falls_on_while_it_escapes_is_not_thrown() {
    let ground = shapes::block([24, 24, 2]).map(|[x, y, z]| {
        let bumps = 0.08 * (TAU * x / 6.0).cos() * (TAU * y / 6.0).cos();
        [x / 8.0 - 1.5, y / 8.0 - 1.5, z / 2.0 * (1.0 + bumps) - 0.5]
    });
    // A spike on each face of an icosahedron.
    let mut star = shapes::icosahedron().scaled(0.22);
    for [a, b, c] in std::mem::take(&mut star.triangles) {
        let tip = star.positions.len() as u32;
        let out = [a, b, c].map(|corner| V3::from(star.positions[corner as usize])).iter().sum::<V3>();
        star.positions.push((0.5 * out.normalize()).into());
        star.triangles.extend([[a, b, tip], [b, c, tip], [c, a, tip]]);
    }
    let turn = Matrix3::new(
        0.7104603695940845,
        0.5323533188164852,
        -0.46026732143539206,
        -0.09393964992845293,
        0.7199207845394537,
        0.6876695472095716,
        0.6974391768516853,
        -0.44532460961996156,
        0.5614842710702344,
    );
    let (mass, inertia, fall) = (77.23463405081533, 2.79727946, 3.132091952673165);
    // As stiff as would let it sink by 0.0003 if it lay on its whole size.
    let size: f64 = 0.934172358;
    let of_both = Material { friction: 0.5, damping_time: 0.05, ..material(mass * 9.81 / (size * size * 0.0003)) };
    for dt in [1.0 / 60.0, 1.0 / 240.0] {
        let mut host = Host::new(RigidUnknowns::Eliminated);
        host.gravity = V3::new(0.0, 0.0, -9.81);
        (host.solves, host.goal) = (3, 0.01);
        let body = host.scene.add(ground.mesh());
        host.system.add_moved(&host.scene, body, of_both).expect("a ground");
        let body = host.scene.add(star.mesh());
        let inertia = Matrix3::identity() * inertia;
        host.system.add_rigid(&host.scene, body, mass, rows_of(&inertia), of_both).expect("a star");
        let position = V3::new(0.0665978236, -0.0308173082, 1.02811951);
        let velocity = [0.0, 0.0, -fall, 0.0, 0.0, 0.0];
        host.rigids.push(Rigid { body, mass, inertia, position, rotation: turn, velocity, push: V3::zeros() });
        let energy = |host: &Host| {
            let [linear, angular] =
                [0, 3].map(|first| V3::from_column_slice(&host.rigids[0].velocity[first..first + 3]));
            let of_motion = 0.5 * (mass * linear.norm_squared() + inertia.m11 * angular.norm_squared());
            of_motion + mass * 9.81 * host.rigids[0].position.z
        };
        let start = energy(&host);
        let mut most = f64::NEG_INFINITY;
        for _ in 0..(3.0_f64 / dt).round() as usize {
            host.step(dt);
            most = most.max(energy(&host));
        }
        let gained = (most - start) / (0.5 * mass * fall * fall);
        println!("gains {gained:.3} of the energy of its fall at most, in steps of {dt:.4} s");
        assert!(gained <= 0.0, "{gained} of the energy of its fall, in steps of {dt} s");
    }
}
