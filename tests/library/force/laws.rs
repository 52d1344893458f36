//! The penalty law against finite differences and the laws of motion: force = −∂energy/∂position and differential =
//! ∂force/∂position with the contacts held, momentum and angular momentum conserved.

use crate::common::shapes;
use raycontact::contact::{ContactKind, ContactList, DetectionOptions, Sampling};
use raycontact::escape::query_pair;
use raycontact::force::{PenaltyLaw, Weighting, add_differential, add_forces, energy};
use raycontact::math::Vector3;
use raycontact::mesh::Mesh;
use raycontact::query::Octree;
use raycontact::scene::Scene;

type Field = [Vec<Vector3<f64>>; 2];

/// A torus of 2 · 24 · 12 triangles, or as many more as the square of `detail`, around z, turned by `angle` about x and moved by `shift`.
fn torus(detail: u32, angle: f64, shift: [f64; 3]) -> Mesh<f64> {
    let (around, across) = (24 * detail, 12 * detail);
    let part = |i: u32, count: u32| std::f64::consts::TAU * f64::from(i) / f64::from(count);
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..around {
        for j in 0..across {
            let (u, v) = (part(i, around), part(j, across));
            let (x, y, z) = ((1.0 + 0.4 * v.cos()) * u.cos(), (1.0 + 0.4 * v.cos()) * u.sin(), 0.4 * v.sin());
            let (y, z) = (y * angle.cos() - z * angle.sin(), y * angle.sin() + z * angle.cos());
            positions.push([x + shift[0], y + shift[1], z + shift[2]]);
            let at = |i: u32, j: u32| i % around * across + j % across;
            triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    Mesh::new(&positions, &triangles).expect("the torus is closed")
}

struct Overlap {
    positions: Field,
    list: ContactList<f64>,
}

fn overlap([first, second]: [u32; 2], sampling: Sampling<f64>, are_known_nodes: bool) -> Overlap {
    let mut meshes = [torus(first, 0.0, [0.0; 3]), torus(second, 0.7, [0.3, 0.15, 0.5])];
    if are_known_nodes {
        meshes.iter_mut().for_each(|mesh| mesh.set_carrier_spacing(0.0).expect("0 is allowed"));
    }
    let octrees = [Octree::new(&meshes[0]), Octree::new(&meshes[1])];
    let mut list = ContactList::default();
    let options = DetectionOptions { sampling, ..DetectionOptions::default() };
    query_pair(&meshes[0], &octrees[0], &meshes[1], &octrees[1], &options, &mut list).expect("octrees are new");
    assert!(list.len() > 40, "the tori overlap well");
    Overlap { positions: meshes.map(|mesh| mesh.positions().to_vec()), list }
}

fn overlaps() -> Vec<Overlap> {
    let of_triangles = [Sampling::Vertices, Sampling::default(), Sampling::Spacing(0.1)];
    // With few contacts, most of which stand for many triangles of either body.
    let of_patches = [[1, 1], [4, 4], [1, 4], [4, 1]].map(|details| (details, Sampling::Accuracy(0.05)));
    let all = of_triangles.map(|sampling| ([1, 1], sampling)).into_iter().chain(of_patches);
    let both = |(details, sampling)| [false, true].map(|are_known_nodes| overlap(details, sampling, are_known_nodes));
    all.flat_map(both).collect()
}

/// A ball that escapes from a block which has swallowed it: its contacts are all as deep as the deepest of them, however far
/// apart their points are.
fn escape() -> Overlap {
    let mut scene = Scene::new(1).expect("no threads are needed");
    let bodies = [shapes::cube(4), shapes::sphere(1).scaled(0.4).moved([0.1, 0.2, 0.3])];
    let positions = bodies.map(|body| {
        let mesh = body.mesh();
        let positions = mesh.positions().to_vec();
        scene.add(mesh);
        positions
    });
    let mut list = ContactList::default();
    scene.query(&mut list);
    assert!(list.len() > 20 && list.contacts.iter().all(|contact| contact.kind == ContactKind::Escape));
    Overlap { positions, list }
}

/// Numbers between −1 and 1 without a pattern, the same in every run.
fn noise(field: &Field, seed: f64) -> Field {
    let mut count = seed;
    [0, 1].map(|body| {
        let one = |_: &Vector3<f64>| {
            count += 1.0;
            Vector3::from_fn(|axis, _| (count * 12.9898 + axis as f64 * 78.233).sin())
        };
        field[body].iter().map(one).collect()
    })
}

fn zero(like: &Field) -> Field {
    [0, 1].map(|body| vec![Vector3::zeros(); like[body].len()])
}

fn moved(field: &Field, by: &Field, factor: f64) -> Field {
    [0, 1].map(|body| field[body].iter().zip(&by[body]).map(|(x, d)| x + d * factor).collect())
}

fn dot(a: &Field, b: &Field) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a.dot(b)).sum()
}

fn laws() -> [PenaltyLaw; 2] {
    [Weighting::Area, Weighting::Vertex].map(|w| PenaltyLaw::new(1000.0, 0.05, w).expect("a valid law"))
}

#[test]
fn force_is_the_negative_gradient_of_the_energy() {
    for overlap in overlaps() {
        for law in laws() {
            let displacement = noise(&overlap.positions, 0.5);
            let at = moved(&overlap.positions, &displacement, 0.01);
            let mut forces = zero(&at);
            add_forces(&overlap.list, &law, Some(&at), None, &mut forces);

            let h = 1e-4;
            let energy_at = |factor: f64| energy(&overlap.list, &law, Some(&moved(&at, &displacement, factor)));
            let slope = (energy_at(h) - energy_at(-h)) / (2.0 * h);
            let expected = -dot(&forces, &displacement);
            assert!((slope - expected).abs() <= 1e-6 * expected.abs(), "{slope} against {expected}");
        }
    }
}

#[test]
fn differential_is_the_derivative_of_the_force() {
    for overlap in overlaps() {
        for law in laws() {
            let displacement = noise(&overlap.positions, 0.5);
            let rest = zero(&overlap.positions);
            let force_at = |x: f64, v: f64| {
                let mut forces = zero(&overlap.positions);
                let at = moved(&overlap.positions, &displacement, x);
                let velocities = moved(&rest, &displacement, v);
                add_forces(&overlap.list, &law, Some(&at), Some(&velocities), &mut forces);
                forces
            };
            let h = 1e-3;
            for (stiffness_factor, damping_factor) in [(1.0, 0.0), (0.0, 1.0), (-0.3, 2.0)] {
                let mut differential = zero(&overlap.positions);
                let (s, d) = (stiffness_factor, damping_factor);
                add_differential(&overlap.list, &law, s, d, &displacement, &mut differential);
                let difference = moved(&force_at(s * h, d * h), &force_at(-s * h, -d * h), -1.0);
                let error = moved(&moved(&rest, &difference, 1.0 / (2.0 * h)), &differential, -1.0);
                assert!(dot(&error, &error) <= 1e-12 * dot(&differential, &differential));
            }
        }
    }
}

#[test]
fn differential_is_symmetric_and_takes_energy_out() {
    for overlap in overlaps() {
        let law = &laws()[0];
        let (a, b) = (noise(&overlap.positions, 0.5), noise(&overlap.positions, 7.5));
        let differential = |displacement: &Field| {
            let mut result = zero(&overlap.positions);
            add_differential(&overlap.list, law, 1.0, 0.0, displacement, &mut result);
            result
        };
        let (da, db) = (differential(&a), differential(&b));
        assert!((dot(&da, &b) - dot(&a, &db)).abs() <= 1e-12 * dot(&da, &da).sqrt() * dot(&b, &b).sqrt());
        assert!(dot(&a, &da) <= 0.0 && dot(&b, &db) <= 0.0);
    }
}

#[test]
fn momentum_and_angular_momentum_are_kept() {
    for overlap in overlaps() {
        for law in laws() {
            let mut forces = zero(&overlap.positions);
            add_forces(&overlap.list, &law, None::<&Field>.map(|f| &f[..]), None, &mut forces);
            let all = || overlap.positions.iter().flatten().zip(forces.iter().flatten());
            let force = all().fold(Vector3::zeros(), |sum, (_, f)| sum + f);
            let torque = all().fold(Vector3::zeros(), |sum, (x, f)| sum + x.cross(f));
            let size: f64 = all().map(|(_, f)| f.norm()).sum();
            let lever: f64 = all().map(|(x, f)| x.cross(f).norm()).sum();
            assert!(force.norm() <= 1e-12 * size, "force {force:?} of {size}");
            assert!(torque.norm() <= 1e-12 * lever, "torque {torque:?} of {lever}");
        }
    }
}

#[test]
fn laws_that_mean_nothing_are_refused_by_name() {
    let refusal = |stiffness, time| PenaltyLaw::new(stiffness, time, Weighting::Area).expect_err("no law").to_string();
    for number in [-1.5, f64::NAN, f64::INFINITY] {
        assert!(refusal(number, 0.0).contains(&format!("stiffness is {number}")));
        assert!(refusal(0.0, number).contains(&format!("damping_time is {number}")));
    }
    let law = PenaltyLaw::new(0.0, 0.25, Weighting::Area).expect("zero is allowed");
    assert_eq!(law.damping_time(), 0.25);
}

/// Where a body has moved as a whole since detection, each spring is longer by its part along the contact's direction.
#[test]
fn springs_are_as_long_as_bodies_have_moved_apart() {
    let law = PenaltyLaw::new(70.0, 0.0, Weighting::Area).expect("a valid law");
    for Overlap { positions, mut list } in overlaps().into_iter().chain([escape()]) {
        let contacts = list.contacts.clone();
        for by in [[0.0; 3], [0.02, -0.05, 0.04]].map(Vector3::from) {
            let mut moved = positions.clone();
            moved[0].iter_mut().for_each(|position| *position -= by);
            for contact in &contacts {
                list.contacts = vec![*contact];
                let sign = if contact.colliding == 0 { 1.0 } else { -1.0 };
                let depth = contact.depth + sign * by.dot(&contact.direction);
                let expected = 0.5 * law.coefficient(contact) * depth * depth;
                let found = energy(&list, &law, Some(&moved));
                assert!((found - expected).abs() < 1e-12, "{found}, {expected}");
                let mut forces = moved.each_ref().map(|body| vec![Vector3::zeros(); body.len()]);
                add_forces(&list, &law, Some(&moved), None, &mut forces);
                let net: Vector3<f64> = forces[contact.colliding as usize].iter().sum();
                assert!((net - contact.direction * (law.coefficient(contact) * depth)).norm() < 1e-12);
            }
        }
    }
}
