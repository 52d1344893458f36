//! What a contact system refuses, and that it then has changed nothing.

use super::bodies::add_soft;
use crate::common::host::{Host, box_inertia};
use crate::common::shapes;
use nalgebra::Matrix3;
use raycontact::mesh::Mesh;
use raycontact::scene::Scene;
use raycontact::system::{Carriers, ContactSystem, Material, Motion, RigidUnknowns, SystemError};

const FINE: Material =
    Material { stiffness: 1e4, damping_time: 0.01, friction: 0.3, depth_cap: 0.05, restitution: 0.0 };
const UNTURNED: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn still() -> Motion {
    Motion { position: [0.0; 3], rotation: UNTURNED, velocity: [0.0; 6], free_velocity: [0.0; 6] }
}

/// Asserts that it is refused so, with words that say what.
#[track_caller]
fn refused<V>(result: Result<V, SystemError>, is_it: impl Fn(&SystemError) -> bool, words: &str) {
    let error = result.err().expect("it is refused");
    assert!(is_it(&error), "{error:?}");
    assert!(error.to_string().contains(words), "\"{error}\" does not say \"{words}\"");
}

macro_rules! refuses {
    ($call:expr, $error:pat, $words:expr) => {
        refused($call, |error| matches!(error, $error), $words)
    };
}

fn cube(scene: &mut Scene<f64>) -> u32 {
    scene.add(shapes::cube(1).scaled(0.2).mesh())
}

#[test]
fn materials_out_of_range_are_refused_by_name() {
    let mut host = Host::new(RigidUnknowns::Eliminated);
    let body = cube(&mut host.scene);
    let wrong = [
        (Material { stiffness: -1.0, ..FINE }, "stiffness is -1"),
        (Material { stiffness: f64::INFINITY, ..FINE }, "stiffness is inf"),
        (Material { damping_time: f64::NAN, ..FINE }, "damping_time is NaN"),
        (Material { friction: -0.1, ..FINE }, "friction is -0.1"),
        (Material { depth_cap: 0.0, ..FINE }, "depth_cap is 0"),
        (Material { depth_cap: f64::NAN, ..FINE }, "depth_cap is NaN"),
        (Material { restitution: -0.1, ..FINE }, "restitution is -0.1; it must be from 0 to 1"),
        (Material { restitution: 1.1, ..FINE }, "restitution is 1.1"),
        (Material { restitution: f64::NAN, ..FINE }, "restitution is NaN"),
    ];
    for (material, words) in wrong {
        refuses!(host.system.add_moved(&host.scene, body, material), SystemError::Material { .. }, words);
        refuses!(host.system.add_half_space([0.0, 0.0, 1.0], 0.0, material), SystemError::Material { .. }, words);
    }
    for (pressure, depth) in [(0.0, 1.0), (1.0, 0.0), (f64::NAN, 1.0), (1.0, f64::INFINITY)] {
        refuses!(Material::bearing(pressure, depth), SystemError::Material { .. }, "above 0");
        refuses!(Material::elastic(pressure, 0.3, depth), SystemError::Material { .. }, "above 0");
    }
    for ratio in [-1.0, 0.5, f64::NAN] {
        refuses!(Material::elastic(1e5, ratio, 0.1), SystemError::Material { .. }, "poissons_ratio");
    }
    host.system.add_moved(&host.scene, body, FINE).expect("nothing was added before");
    refuses!(host.system.add_moved(&host.scene, body, FINE), SystemError::BodyTwice { body: 0 }, "already");
    let negative = Material { friction: -1.0, ..FINE };
    refuses!(host.system.set_pair_material(body, body, Some(negative)), SystemError::Material { .. }, "friction");
    refuses!(
        host.system.set_pair_material(body, 9, Some(FINE)),
        SystemError::UnknownBody { body: 9 },
        "no such body 9"
    );
    refuses!(host.system.add_half_space([0.0, 0.0, 2.0], 0.0, FINE), SystemError::Normal { .. }, "length 2");
    refuses!(host.system.add_half_space([0.0, 0.0, 1.0], f64::NAN, FINE), SystemError::NotFinite { .. }, "offset");
}

#[test]
fn bodies_that_mean_nothing_are_refused() {
    let mut host = Host::new(RigidUnknowns::Eliminated);
    let body = cube(&mut host.scene);
    let (system, scene) = (&mut host.system, &host.scene);
    let inertia = box_inertia(1.0, [0.4; 3]);
    refuses!(system.add_moved(scene, 7, FINE), SystemError::NotInScene { body: 7 }, "no body 7");
    for mass in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        refuses!(system.add_rigid(scene, body, mass, inertia, FINE), SystemError::Mass { node: None, .. }, "mass");
    }
    let turned = |a: f64, b: f64, c: f64| [[a, b, 0.0], [c, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for wrong in [
        [[0.0; 3]; 3],
        turned(-1.0, 0.0, 0.0),
        turned(1.0, 1.0, 1.0),
        turned(1.0, 0.2, 0.0),
        turned(f64::NAN, 0.0, 0.0),
    ] {
        refuses!(system.add_rigid(scene, body, 1.0, wrong, FINE), SystemError::Inertia, "singular");
    }
    let mut added = [[0.0; 6]; 6];
    refuses!(system.set_added_inertia(body, added), SystemError::UnknownBody { .. }, "");
    system.add_rigid(scene, body, 1.0, turned(1.0, 0.0, 0.0), FINE).expect("rigid");
    for (row, column, wrong) in [(1, 4, 0.5), (2, 2, -1.0), (5, 5, -1.5)] {
        added[row][column] = wrong;
        refuses!(system.set_added_inertia(body, added), SystemError::Inertia, "positive definite");
        added[row][column] = 0.0;
    }
    added[3][3] = f64::NAN;
    refuses!(system.set_added_inertia(body, added), SystemError::NotFinite { .. }, "added[21]");
    added[3][3] = -0.5;
    system.set_added_inertia(body, added).expect("half of its own is left");
    system.remove(body).expect("it is there");
    refuses!(system.set_node_masses(&[1.0, 0.0]), SystemError::Mass { node: Some(1), .. }, "node 1 is 0");
    refuses!(system.set_node_masses(&[-1.0]), SystemError::Mass { node: Some(0), .. }, "node 0 is -1");
    refuses!(
        system.add_deformable(scene, body, 0..8, Carriers::Nodes, FINE),
        SystemError::WrongCount { .. },
        "node masses"
    );
    system.set_node_masses(&[1.0; 9]).expect("masses");
    refuses!(
        system.add_deformable(scene, body, 0..7, Carriers::Nodes, FINE),
        SystemError::NodeRange { vertex: 7, node: 7, count: 7 },
        "node 7 of 7"
    );
    let offsets: Vec<u32> = (0..=8).collect();
    let nodes: Vec<u32> = (0..8).collect();
    let mut weights = vec![1.0; 8];
    let mut table = |offsets: &[u32], nodes: &[u32], weights: &[f64]| {
        system.add_deformable(scene, body, 0..9, Carriers::Weights { offsets, nodes, weights }, FINE)
    };
    weights[3] = 0.9;
    refuses!(table(&offsets, &nodes, &weights), SystemError::WeightSum { vertex: 3, .. }, "vertex 3 sum to 0.9");
    weights[3] = f64::NAN;
    refuses!(table(&offsets, &nodes, &weights), SystemError::NotFinite { index: 3, .. }, "weights[3]");
    weights[3] = 1.0;
    refuses!(table(&offsets[1..], &nodes, &weights), SystemError::WrongCount { expected: 9, .. }, "offsets");
    refuses!(table(&offsets, &nodes[1..], &weights), SystemError::WrongCount { .. }, "weights");
    let mut wrong = offsets.clone();
    wrong[4] = 99;
    refuses!(table(&wrong, &nodes, &weights), SystemError::Offsets { .. }, "offsets");
    wrong = offsets.iter().map(|offset| offset + 1).collect();
    wrong[8] = 8;
    refuses!(table(&wrong, &nodes, &weights), SystemError::Offsets { .. }, "offsets");
    table(&offsets, &nodes, &weights).expect("nothing was added before");
    refuses!(system.set_node_masses(&[1.0; 8]), SystemError::WrongCount { expected: 9, .. }, "masses has 8");
    refuses!(system.set_motion(body, &still()), SystemError::UnknownBody { .. }, "no such body");
}

#[test]
fn motions_that_are_none_are_refused() {
    let mut host = Host::new(RigidUnknowns::Eliminated);
    let body = cube(&mut host.scene);
    host.system.add_moved(&host.scene, body, FINE).expect("a body");
    for wrong in [[[0.0; 3]; 3], [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [[f64::NAN; 3]; 3]] {
        let motion = Motion { rotation: wrong, ..still() };
        refuses!(host.system.set_motion(body, &motion), SystemError::Rotation { body: 0 }, "orthonormal");
    }
    let far = Motion { position: [0.0, f64::INFINITY, 0.0], ..still() };
    refuses!(host.system.set_motion(body, &far), SystemError::NotFinite { index: 1, .. }, "position[1]");
    let fast = Motion { velocity: [0.0, 0.0, 0.0, 0.0, f64::NAN, 0.0], ..still() };
    refuses!(host.system.set_motion(body, &fast), SystemError::NotFinite { index: 4, .. }, "velocity[4]");
    refuses!(host.system.rigid_velocity(body), SystemError::UnknownBody { .. }, "no such body");
}

#[test]
fn steps_are_begun_once_with_what_they_need_and_finished_once() {
    let mut host = Host::new(RigidUnknowns::Eliminated);
    add_soft(&mut host, &shapes::cube(2).scaled(0.2), FINE, Matrix3::identity());
    add_soft(&mut host, &shapes::cube(2).scaled(0.2).moved([0.0, 0.0, 0.35]), FINE, Matrix3::identity());
    let count = host.x.len();
    let Host { scene, system, x, v, .. } = &mut host;
    let mut out = vec![0.0; count];
    refuses!(system.add_forces(v, &mut out), SystemError::NoStep, "begin one first");
    refuses!(system.add_product(1.0, v, &mut out), SystemError::NoStep, "begin one first");
    refuses!(system.for_each_block(1.0, |_, _, _| ()), SystemError::NoStep, "begin one first");
    refuses!(system.compressed_rows(1.0), SystemError::NoStep, "begin one first");
    refuses!(system.energy(v), SystemError::NoStep, "begin one first");
    refuses!(system.linearise(v), SystemError::NoStep, "begin one first");
    refuses!(system.detect_again(scene, v), SystemError::NoStep, "begin one first");
    refuses!(system.finish(v), SystemError::NoStep, "begin one first");
    for dt in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        refuses!(system.begin(scene, dt, x, v, v), SystemError::StepLength { .. }, "above 0");
    }
    refuses!(system.begin(scene, 0.01, &x[3..], v, v), SystemError::WrongCount { what: "positions", .. }, "positions");
    refuses!(
        system.begin(scene, 0.01, x, &v[1..], v),
        SystemError::WrongCount { what: "velocities", .. },
        "velocities"
    );
    let mut wrong = v.clone();
    wrong[5] = f64::NAN;
    refuses!(system.begin(scene, 0.01, x, v, &wrong), SystemError::NotFinite { index: 5, .. }, "free_velocities[5]");
    let lone = cube(scene);
    refuses!(system.begin(scene, 0.01, x, v, v), SystemError::UnknownBody { body: 2 }, "body 2");
    scene.remove(lone).expect("it was added");
    let gone: Mesh<f64> = scene.remove(1).expect("it was added");
    refuses!(system.begin(scene, 0.01, x, v, v), SystemError::NotInScene { body: 1 }, "no body 1");
    let again = scene.add(gone);
    system.remove(1).expect("it is there");
    let half = count as u32 / 3 / 2;
    system.add_deformable(scene, again, half..2 * half, Carriers::Nodes, FINE).expect("a body");

    system.begin(scene, 0.01, x, v, v).expect("nothing was begun before");
    assert!(!system.contacts().is_empty());
    refuses!(system.begin(scene, 0.01, x, v, v), SystemError::StepUnderWay, "finish it first");
    refuses!(system.remove(0), SystemError::StepUnderWay, "finish it first");
    refuses!(system.set_node_masses(&[]), SystemError::StepUnderWay, "finish it first");
    refuses!(system.add_half_space([0.0, 0.0, 1.0], 0.0, FINE), SystemError::StepUnderWay, "finish it first");
    refuses!(system.add_forces(&v[1..], &mut out), SystemError::WrongCount { .. }, "velocities");
    refuses!(system.add_forces(v, &mut out[1..]), SystemError::WrongCount { .. }, "forces");
    refuses!(system.add_product(1.0, &wrong, &mut out), SystemError::NotFinite { .. }, "change[5]");
    refuses!(system.add_product(f64::NAN, v, &mut out), SystemError::NotFinite { .. }, "factor");
    refuses!(system.compressed_rows(f64::NAN), SystemError::NotFinite { .. }, "factor");
    assert!(out.iter().all(|&force| force == 0.0), "nothing was added");
    refuses!(system.linearise(&wrong), SystemError::NotFinite { .. }, "velocities[5]");
    refuses!(system.finish(&wrong), SystemError::NotFinite { .. }, "velocities[5]");
    system.finish(v).expect("it is still under way");
    refuses!(system.finish(v), SystemError::NoStep, "begin one first");
    system.begin(scene, 0.01, x, v, v).expect("a step");
    system.cancel();
    system.cancel();
    refuses!(system.finish(v), SystemError::NoStep, "begin one first");
}

#[test]
fn what_needs_rigid_unknowns_asks_for_them() {
    let mut scene = Scene::new(1).expect("no thread is started");
    let mut system = ContactSystem::<f64>::new(RigidUnknowns::Eliminated);
    let body = cube(&mut scene);
    system.add_rigid(&scene, body, 1.0, box_inertia(1.0, [0.4; 3]), FINE).expect("a body");
    refuses!(system.explicit_step(&mut scene, 0.01, &[], &[], &mut []), SystemError::Eliminated, "unknowns kept");
    system.begin(&mut scene, 0.01, &[], &[], &[]).expect("a step");
    refuses!(system.for_each_block(1.0, |_, _, _| ()), SystemError::Eliminated, "unknowns kept");
    refuses!(system.compressed_rows(1.0), SystemError::Eliminated, "unknowns kept");
}

/// Places move up, and what was at them is not taken for another's.
#[test]
fn velocities_of_rigid_bodies_are_not_mistaken_after_a_removal() {
    let mut scene = Scene::new(1).expect("no thread is started");
    let mut system = ContactSystem::<f64>::new(RigidUnknowns::Eliminated);
    let [first, second] = [0, 1].map(|_| cube(&mut scene));
    for (body, x) in [(first, 0.0), (second, 9.0)] {
        system.add_rigid(&scene, body, 1.0, box_inertia(1.0, [0.4; 3]), FINE).expect("a body");
        let velocity = [x, 0.0, 0.0, 0.0, 0.0, 0.0];
        let motion = Motion { position: [x, 0.0, 0.0], velocity, free_velocity: velocity, ..still() };
        system.set_motion(body, &motion).expect("it is rigid");
    }
    refuses!(system.rigid_velocity(second), SystemError::UnknownBody { .. }, "no such body 1");
    system.begin(&mut scene, 0.01, &[], &[], &[]).expect("a step");
    system.finish(&[]).expect("a step is under way");
    assert_eq!(system.rigid_velocity(second).expect("it is rigid")[0], 9.0);
    system.remove(first).expect("it is there");
    refuses!(system.rigid_velocity(second), SystemError::UnknownBody { .. }, "no such body 1");
}

#[test]
fn positions_beyond_range_are_refused() {
    let mut scene = Scene::<f32>::new(1).expect("no thread is started");
    let mut system = ContactSystem::<f32>::new(RigidUnknowns::Eliminated);
    let body = scene.add(shapes::cube(1).mesh());
    system.set_node_masses(&[1.0; 8]).expect("masses");
    system.add_deformable(&scene, body, 0..8, Carriers::Nodes, FINE).expect("a body");
    let (mut x, mut v) = (vec![0.0; 24], vec![0.0; 24]);
    v[7] = 1e24;
    refuses!(system.begin(&mut scene, 1e20, &x, &v, &v), SystemError::Mesh { body: 0, .. }, "body 0");
    x[7] = 1e300;
    refuses!(system.begin(&mut scene, 0.01, &x, &v, &v), SystemError::BeyondRange { index: 7, .. }, "positions[7]");
    refuses!(system.finish(&v), SystemError::NoStep, "begin one first");
}
