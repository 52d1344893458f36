//! Materials, masses and motions over all decades: what a system takes keeps momentum and gives numbers, and the rest is
//! refused.

use super::bodies::{add_box, add_soft};
use crate::common::host::{Host, Rigid, at, box_inertia, rotation};
use crate::common::shapes;
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use raycontact::system::{Material, RigidUnknowns, Surface, SystemError};

type V3 = Vector3<f64>;

const DT: f64 = 0.01;
const MATERIAL: Material =
    Material { stiffness: 1e6, damping_time: 0.05, friction: 0.5, depth_cap: 0.01, restitution: 0.0 };
/// Body 2 falls on bodies 0 and 1, which lie side by side and overlap a little.
const PLACES: [[f64; 3]; 3] = [[0.0; 3], [1.98, 0.1, 0.2], [0.9, 0.3, 1.97]];

fn add_cube(host: &mut Host, place: usize, mass: f64, inertia: [[f64; 3]; 3], material: Material, turn: Matrix3<f64>) {
    let body = host.scene.add(shapes::cube(1).mesh());
    host.system.add_rigid(&host.scene, body, mass, inertia, material).expect("a cube");
    let velocity = if place == 2 { [0.3, 0.1, -1.0, 0.2, 0.0, 0.1] } else { [0.0; 6] };
    host.rigids.push(Rigid {
        body,
        mass,
        inertia: Matrix3::from_fn(|i, j| inertia[i][j]),
        position: turn * V3::from(PLACES[place]),
        rotation: turn,
        velocity,
        push: V3::zeros(),
    });
}

fn cubes(count: usize, material: Material, angle: [f64; 3]) -> Host {
    let mut host = Host::new(RigidUnknowns::Eliminated);
    for place in 3 - count..3 {
        add_cube(&mut host, place, 1.0, box_inertia(1.0, [2.0; 3]), material, rotation(&V3::from(angle)));
    }
    host
}

/// One step without nodes.
fn step(host: &mut Host) -> Result<(), SystemError> {
    host.set_motions(DT);
    host.system.begin(&mut host.scene, DT, &[], &[], &[])?;
    assert!(!host.system.contacts().is_empty());
    for _ in 0..6 {
        let wrong = host.system.linearise(&[])?;
        if !host.system.detect_again(&mut host.scene, &[])? && wrong < 1e-3 {
            break;
        }
    }
    host.system.finish(&[])?;
    for rigid in &mut host.rigids {
        rigid.velocity = host.system.rigid_velocity(rigid.body).expect("it is rigid");
    }
    Ok(())
}

/// Where detection looks for rigid bodies, and for nodes after them: there contacts act.
fn predicted(host: &Host) -> Vec<V3> {
    let rigids = host.rigids.iter().map(|rigid| rigid.position + V3::from_row_slice(&rigid.velocity[..3]) * DT);
    rigids.chain((0..host.masses.len()).map(|node| at(&host.x, node) + at(&host.v, node) * DT)).collect()
}

/// Linear momentum, angular momentum about the origin of bodies in these places, and the sum of what each has of either.
fn momentum(host: &Host, places: &[V3]) -> ([V3; 2], f64) {
    let (mut sums, mut size) = ([V3::zeros(); 2], 0.0);
    let mut add = |linear: V3, angular: V3| {
        sums[0] += linear;
        sums[1] += angular;
        size += linear.norm() + angular.norm();
    };
    for (rigid, place) in host.rigids.iter().zip(places) {
        let [a, b, c, d, e, f] = rigid.velocity;
        let inertia = rigid.rotation * rigid.inertia * rigid.rotation.transpose();
        let linear = V3::new(a, b, c) * rigid.mass;
        add(linear, place.cross(&linear) + inertia * V3::new(d, e, f));
    }
    for (node, place) in places[host.rigids.len()..].iter().enumerate() {
        let linear = at(&host.v, node) * host.masses[node];
        add(linear, place.cross(&linear));
    }
    (sums, size)
}

/// Three bodies wedged in one another exchange far more than they have, and sums keep no more than some roundings of that.
fn assert_kept(host: &Host, places: &[V3], before: [V3; 2], what: &str) {
    let (after, size) = momentum(host, places);
    let pairs = (0..4).flat_map(|a| (0..a).map(move |b| (a, Surface::Body(b))));
    let force = |(a, b)| host.system.pair_force(a, b).map_or(0.0, |force| V3::from(force).norm());
    let exchanged = pairs.map(force).sum::<f64>() * DT;
    for (k, name) in ["linear", "angular"].into_iter().enumerate() {
        let lost = (after[k] - before[k]).norm();
        assert!(
            lost < 1e-9 * size + 1e-13 * exchanged,
            "{what}: {name} momentum, {lost:e} of {size} and {exchanged:e}"
        );
    }
}

#[test]
fn eliminated_bodies_keep_their_momentum_or_are_refused() {
    for angle in [[0.0; 3], [0.3, -1.1, 0.7]] {
        for count in [2, 3] {
            for friction in [0.0, 0.5] {
                let mut refused = 0;
                for eighth in 24..=190 {
                    let stiffness = 10_f64.powf(f64::from(eighth) / 8.0);
                    let mut host = cubes(count, Material { stiffness, friction, ..MATERIAL }, angle);
                    let places = predicted(&host);
                    let before = momentum(&host, &places).0;
                    let what = format!("{count} cubes at {angle:?}, friction {friction}, {stiffness:e} N/m³");
                    match step(&mut host) {
                        Ok(()) => {
                            assert_kept(&host, &places, before, &what);
                            // They are stopped, not passed through.
                            let up = rotation(&V3::from(angle)) * V3::z();
                            let speed = |k: usize| up.dot(&V3::from_row_slice(&host.rigids[k].velocity[..3]));
                            let closing = speed(0) - speed(count - 1);
                            assert!(count > 2 || closing < 0.9, "{what}: {closing} m/s");
                            assert!(refused == 0, "{what}: taken, though a softer one was refused");
                        }
                        Err(error) => {
                            assert!(matches!(error, SystemError::TooStiff { .. }), "{what}: {error}");
                            assert!(error.to_string().contains("softer material"), "{error}");
                            assert!(stiffness > 1e14, "{what}: refused");
                            refused += 1;
                        }
                    }
                }
                assert!(refused > 0);
            }
        }
    }
}

/// Three cubes of this stiffness, and a soft one that falls onto the upper. Only contact acts.
fn soft_on_cubes(stiffness: f64, friction: f64) -> Host {
    let material = Material { friction, ..MATERIAL };
    let mut host = cubes(3, material, [0.0; 3]);
    for (a, b) in [(0, 1), (1, 2), (0, 2)] {
        host.system.set_pair_material(a, b, Some(Material { stiffness, ..material })).expect("no step");
    }
    add_soft(&mut host, &shapes::cube(2).scaled(0.2), Material { stiffness: 1e4, ..material }, Matrix3::identity());
    host.springs.clear();
    for node in 0..host.masses.len() {
        (0..3).for_each(|axis| host.x[3 * node + axis] += [0.9, 0.3, 3.155][axis]);
        host.v[3 * node + 2] = -2.0;
    }
    host
}

/// The nodes' velocities with which the forces of the rows, as they are held, agree to rounding: a direct solve, column by
/// column, and corrected.
fn solve(host: &mut Host, v: &mut [f64]) -> Result<(), SystemError> {
    let count = v.len();
    let mut matrix = DMatrix::<f64>::zeros(count, count);
    for column in 0..count {
        let (mut one, mut product) = (vec![0.0; count], vec![0.0; count]);
        one[column] = 1.0;
        host.system.add_product(DT, &one, &mut product)?;
        product[column] += host.masses[column / 3];
        matrix.set_column(column, &DVector::from_vec(product));
    }
    let factor = matrix.lu();
    for _ in 0..4 {
        let mut forces = vec![0.0; count];
        host.system.add_forces(v, &mut forces)?;
        let left = |k: usize| DT * forces[k] - host.masses[k / 3] * (v[k] - host.v[k]);
        let change = factor.solve(&DVector::from_iterator(count, (0..count).map(left))).expect("regular");
        v.iter_mut().zip(&change).for_each(|(v, change)| *v += change);
    }
    Ok(())
}

/// One step that ends with the velocities solved for last.
fn step_solved(host: &mut Host, solves: usize) -> Result<(), SystemError> {
    host.set_motions(DT);
    host.system.begin(&mut host.scene, DT, &host.x, &host.v, &host.v)?;
    let mut v = host.v.clone();
    for number in 0..solves {
        if number > 0 {
            host.system.linearise(&v)?;
        }
        solve(host, &mut v)?;
    }
    host.system.finish(&v)?;
    host.v = v;
    for rigid in &mut host.rigids {
        rigid.velocity = host.system.rigid_velocity(rigid.body).expect("it is rigid");
    }
    Ok(())
}

#[test]
fn nodes_and_stiff_eliminated_bodies_keep_their_momentum() {
    for friction in [0.0, 0.5] {
        for half in 8..=40 {
            let stiffness = 10_f64.powf(f64::from(half) / 2.0);
            for solves in 1..=3 {
                let mut host = soft_on_cubes(stiffness, friction);
                let places = predicted(&host);
                let before = momentum(&host, &places).0;
                let what = format!("friction {friction}, {stiffness:e} N/m³, solved {solves} times");
                match step_solved(&mut host, solves) {
                    Ok(()) => {
                        let touches =
                            |contact: &raycontact::contact::Contact<f64>| contact.colliding.max(contact.collided) == 3;
                        assert!(host.system.contacts().contacts.iter().any(touches));
                        assert_kept(&host, &places, before, &what);
                    }
                    Err(error) => {
                        assert!(matches!(error, SystemError::TooStiff { .. }), "{what}: {error}");
                        assert!(stiffness > 1e13, "{what}: refused");
                    }
                }
            }
        }
    }
}

/// A step that was refused has not begun.
#[test]
fn after_a_stiffness_was_refused_the_host_goes_on() {
    let mut host = cubes(2, Material { stiffness: 1e20, ..MATERIAL }, [0.0; 3]);
    let mut other = cubes(2, Material { stiffness: 1e20, ..MATERIAL }, [0.0; 3]);
    let error = step(&mut host).expect_err("too stiff");
    assert!(matches!(error, SystemError::TooStiff { body: 0 | 1, .. }), "{error}");
    assert!(matches!(host.system.linearise(&[]), Err(SystemError::NoStep)));
    let softer = Some(MATERIAL);
    for host in [&mut host, &mut other] {
        host.system.set_pair_material(0, 1, softer).expect("no step is under way");
        step(host).expect("soft enough");
        step(host).expect("soft enough");
    }
    assert_eq!(host.rigids[0].velocity, other.rigids[0].velocity);
}

/// A box that strikes a second one, which then pushes a third: by far too stiffly.
fn strike(third: [f64; 2]) -> Host {
    let mut host = Host::new(RigidUnknowns::Eliminated);
    for x in [0.0, 0.39, 5.0] {
        add_box(&mut host, MATERIAL, V3::new(x, 0.01 * x, 0.0), Matrix3::identity());
    }
    // So that there is something to remember.
    (0..2).for_each(|_| host.step(DT));
    for (rigid, [x, speed]) in host.rigids.iter_mut().zip([[0.0, 6.0], [0.405, 0.0], third]) {
        (rigid.position.x, rigid.velocity[0]) = (x, speed);
    }
    host.system.set_pair_material(1, 2, Some(Material { stiffness: 1e19, ..MATERIAL })).expect("no step");
    host
}

/// The third box leaves the second, or is not met yet: only a later call finds that they push.
#[test]
fn a_step_refused_under_way_has_not_begun() {
    for third in [[0.79, 1.0], [0.81, 0.0]] {
        for first_dt in [1e-5, DT] {
            let run = |is_refused: bool| {
                let mut host = strike(third);
                if is_refused {
                    host.set_motions(DT);
                    let Host { system, scene, .. } = &mut host;
                    system.begin(scene, DT, &[], &[], &[]).expect("they do not push yet");
                    let touches = third[1] > 0.0;
                    assert_eq!(system.contacts().contacts.iter().any(|contact| contact.collided == 2), touches);
                    let mut result = system.linearise(&[]).map(|_| false);
                    if !touches {
                        result.expect("they have not met");
                        result = system.detect_again(scene, &[]);
                    }
                    let error = result.expect_err("they push");
                    assert!(matches!(error, SystemError::TooStiff { body: 1 | 2, .. }), "{error}");
                    assert!(matches!(system.finish(&[]), Err(SystemError::NoStep)));
                }
                // Once with a shorter step, once with a softer material.
                if first_dt < DT {
                    host.step(first_dt);
                }
                host.system.set_pair_material(1, 2, None).expect("no step");
                (0..3).for_each(|_| host.step(DT));
                host.rigids.iter().map(|rigid| (rigid.position, rigid.velocity)).collect::<Vec<_>>()
            };
            let met = run(false);
            assert!(met[2].1[0] > 1.5, "{met:?}");
            assert_eq!(run(true), met);
        }
    }
}

fn finite(numbers: &[f64]) -> bool {
    numbers.iter().all(|x| x.is_finite())
}

/// Two steps of two cubes, with all that a host may ask; true if nothing was refused.
fn asks_all(unknowns: RigidUnknowns, number: usize, value: f64) -> Result<(), SystemError> {
    let (mut material, mut masses, mut dt) = (MATERIAL, [1.0; 2], DT);
    let mut host = Host::new(unknowns);
    let scene = &mut host.scene;
    let bodies = [0, 1].map(|_| scene.add(shapes::cube(1).mesh()));
    let mut inertia = box_inertia(1.0, [2.0; 3]);
    let mut velocity = [0.3, 0.1, -1.0, 0.2, 0.0, 0.1];
    match number {
        0 => material.stiffness = value,
        1 => material.damping_time = value,
        2 => material.friction = value,
        3 => material.depth_cap = value,
        4 => masses[1] = value,
        5 => inertia = inertia.map(|row| row.map(|x| x * value)),
        6 => velocity[2] = -value,
        7 => velocity[0] = value,
        8 => velocity[5] = value,
        9 => dt = value,
        _ => (material.stiffness, material.friction) = (value, value),
    }
    let system = &mut host.system;
    for (k, &body) in bodies.iter().enumerate() {
        system.add_rigid(scene, body, masses[k], inertia, material)?;
    }
    let mut motion = raycontact::system::Motion {
        position: [0.3, 0.0, 1.9],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        velocity: [0.3, 0.0, -0.2, 0.0, 0.0, 0.0],
        free_velocity: [0.3, 0.0, -0.2, 0.0, 0.0, 0.0],
    };
    for step in 0..2 {
        if step == 1 {
            motion.velocity = velocity;
        }
        system.set_motion(bodies[1], &motion)?;
        system.begin(scene, dt, &[], &[], &[])?;
        let count = system.unknown_count();
        let mut unknowns = vec![0.0; count];
        for round in 0..3 {
            if count > 0 && round > 0 {
                unknowns[6..].copy_from_slice(&velocity);
            }
            let what = || format!("number {number}, {value:e}, step {step}, round {round}");
            let [mut forces, mut product] = [vec![0.0; count], vec![0.0; count]];
            system.add_forces(&unknowns, &mut forces)?;
            assert!(finite(&forces), "forces {forces:?}: {}", what());
            system.add_product(1.0 / dt, &forces, &mut product)?;
            assert!(finite(&product), "product {product:?}: {}", what());
            let energy = system.energy(&unknowns)?;
            assert!(energy.is_finite() && energy >= 0.0, "energy {energy}: {}", what());
            let wrong = system.linearise(&unknowns)?;
            assert!((0.0..=1.0).contains(&wrong), "wrong {wrong}: {}", what());
            system.detect_again(scene, &unknowns)?;
        }
        system.finish(&unknowns)?;
        for body in bodies {
            let velocity = system.rigid_velocity(body)?;
            assert!(finite(&velocity), "velocity {velocity:?}, number {number}, {value:e}, step {step}");
        }
    }
    Ok(())
}

/// Finite stiffnesses of 1e160 and frictions of 1e150 once gave forces, energies and products that were none.
#[test]
fn what_is_taken_gives_numbers() {
    for unknowns in [RigidUnknowns::Kept, RigidUnknowns::Eliminated] {
        for number in 0..=10 {
            let taken = |exponent: &i32| asks_all(unknowns, number, 10_f64.powi(*exponent)).is_ok();
            let taken: Vec<i32> = (-320..=308).step_by(4).filter(taken).collect();
            // What users have is taken.
            let needed = match number {
                1 => -20..=4,
                5 | 6 | 8 | 9 => 0..=0,
                _ => -20..=8,
            };
            assert!(needed.step_by(4).all(|exponent| taken.contains(&exponent)), "{unknowns:?}, {number}: {taken:?}");
            let refused = if number == 3 { 0 } else { 40 };
            assert!(taken.len() < 158 - refused, "{unknowns:?}, {number}: {taken:?}");
        }
    }
}
