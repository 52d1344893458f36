//! Momentum, gradients and the matrix, for each kind of body and of row.

use super::bodies::{add_box, add_cage, add_soft};
use crate::common::host::{Host, at, dot, rotation};
use crate::common::random::Random;
use crate::common::shapes;
use nalgebra::{DMatrix, Vector3};
use raycontact::contact::{DetectionOptions, Sampling};
use raycontact::system::{CompressedRows, Material, RigidUnknowns};

type V3 = Vector3<f64>;

pub const DT: f64 = 0.01;

pub fn material(friction: f64, damping_time: f64) -> Material {
    Material { stiffness: 2e4, damping_time, friction, depth_cap: 0.03, restitution: 0.0 }
}

/// Two overlapping bodies of the kinds named, deep enough for all that rows know: the cap, friction, the far corner.
pub fn overlap(kinds: [&str; 2], rigid: RigidUnknowns, material: Material) -> Host {
    let mut host = Host::new(rigid);
    for (k, kind) in kinds.into_iter().enumerate() {
        let turn = rotation(&V3::new(0.3 * k as f64, 0.2, 0.5 * k as f64));
        let nodes = host.masses.len();
        match kind {
            "rigid" => add_box(&mut host, material, V3::new(0.0, 0.0, 0.2), turn),
            "soft" | "fine" | "finest" => {
                let cells = [("soft", 3), ("fine", 16), ("finest", 40)].into_iter().find(|(name, _)| *name == kind);
                let shape = shapes::cube(cells.expect("it is one of them").1).scaled(0.2).moved([0.0, 0.0, 0.2]);
                add_soft(&mut host, &shape, material, turn);
            }
            "cage" => add_cage(&mut host, material, turn),
            _ => unreachable!("{kind}"),
        }
        let flat = kinds.iter().filter(|kind| **kind == "cage").count();
        let by = V3::new(0.05, 0.03, 0.3 - 0.07 * flat as f64) * k as f64;
        (nodes..host.masses.len()).for_each(|node| (0..3).for_each(|axis| host.x[3 * node + axis] += by[axis]));
        if kind == "rigid" && k == 1 {
            host.rigids.last_mut().expect("it was added").position += by;
        }
    }
    host
}

pub const PAIRS: [[&str; 2]; 6] =
    [["soft", "soft"], ["soft", "cage"], ["cage", "cage"], ["rigid", "soft"], ["cage", "rigid"], ["rigid", "rigid"]];

pub fn random(count: usize, size: f64, seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed);
    (0..count).map(|_| size * random.signed()).collect()
}

/// Begins a step from random velocities, and gives velocities at which it is then linearised.
pub fn begin(host: &mut Host, seed: u64) -> Vec<f64> {
    let nodes = host.x.len();
    host.v = random(nodes, 0.5, seed);
    for (k, rigid) in host.rigids.iter_mut().enumerate() {
        rigid.velocity = random(6, 0.5, seed + 100 + k as u64).try_into().expect("six");
    }
    host.set_motions(DT);
    let free = host.v.clone();
    host.system.begin(&mut host.scene, DT, &host.x, &host.v, &free).expect("a step");
    let mut velocities = random(host.system.unknown_count(), 0.4, seed + 7);
    velocities.iter_mut().zip(&host.v).for_each(|(end, start)| *end += start);
    velocities
}

/// Force and torque on nodes and rigid bodies, where detection had them, and the sizes of what was summed.
fn net(host: &Host, forces: &[f64]) -> (V3, V3, f64, f64) {
    let (mut force, mut torque, mut size, mut lever) = (V3::zeros(), V3::zeros(), 0.0, 0.0);
    let mut add = |at: V3, f: V3, t: V3| {
        force += f;
        torque += at.cross(&f) + t;
        size += f.norm();
        lever += at.cross(&f).norm() + t.norm();
    };
    let nodes = host.masses.len();
    for node in 0..nodes {
        add(at(&host.x, node) + at(&host.v, node) * DT, at(forces, node), V3::zeros());
    }
    for (place, rigid) in host.rigids.iter().enumerate() {
        let [x, y, z, ..] = rigid.velocity;
        let (linear, angular) = (nodes + 2 * place, nodes + 2 * place + 1);
        add(rigid.position + V3::new(x, y, z) * DT, at(forces, linear), at(forces, angular));
    }
    (force, torque, size, lever)
}

/// With few contacts too, which are spread where vertices are nodes.
#[test]
fn momentum_and_angular_momentum_are_kept() {
    let fine = [["fine", "fine"], ["soft", "fine"], ["fine", "cage"], ["fine", "rigid"]];
    let of_patches = PAIRS.into_iter().chain(fine).map(|pair| (pair, Sampling::Accuracy(0.1)));
    let all = PAIRS.into_iter().map(|pair| (pair, Sampling::default())).chain(of_patches);
    for (pair, sampling) in all {
        for friction in [0.0, 0.6] {
            let mut host = overlap(pair, RigidUnknowns::Kept, material(friction, 0.02));
            // Whole-body pushes keep linear momentum alone.
            host.scene.set_options(DetectionOptions { sampling, escape: false, ..DetectionOptions::default() });
            let velocities = begin(&mut host, 3);
            for linearised in [false, true] {
                if linearised {
                    host.system.linearise(&velocities).expect("a step is under way");
                }
                let mut forces = vec![0.0; velocities.len()];
                host.system.add_forces(&velocities, &mut forces).expect("a step is under way");
                let (force, torque, size, lever) = net(&host, &forces);
                assert!(size > 1.0, "{pair:?} push");
                assert!(force.norm() <= 1e-11 * size, "{pair:?}, friction {friction}: {force:?} of {size}");
                assert!(torque.norm() <= 1e-11 * lever, "{pair:?}, friction {friction}: {torque:?} of {lever}");
            }
        }
    }
}

/// With less than a fifth of the contacts; what is left out has next to no load.
#[test]
fn contacts_for_patches_push_more_nodes_than_their_triangles_have() {
    let [of_patches, of_vertices] = [Sampling::Accuracy(0.1), Sampling::Vertices].map(|sampling| {
        let mut host = overlap(["finest", "finest"], RigidUnknowns::Kept, material(0.0, 0.02));
        host.scene.set_options(DetectionOptions { sampling, ..DetectionOptions::default() });
        let velocities = begin(&mut host, 3);
        let mut forces = vec![0.0; velocities.len()];
        host.system.add_forces(&velocities, &mut forces).expect("a step is under way");
        let pushed = forces.chunks(3).filter(|force| force.iter().any(|x| *x != 0.0)).count();
        (host.system.contacts().len(), pushed)
    });
    println!("contacts and nodes: {of_patches:?}, {of_vertices:?}");
    // The corners of their triangles are six at most.
    assert!(5 * of_patches.0 < of_vertices.0 && of_patches.1 > 7 * of_patches.0);
}

#[test]
fn force_product_and_matrix_are_derivatives_of_the_energy() {
    for (pair, rigid) in
        PAIRS.into_iter().flat_map(|p| [RigidUnknowns::Kept, RigidUnknowns::Eliminated].map(|r| (p, r)))
    {
        let mut host = overlap(pair, rigid, material(0.6, 0.02));
        let velocities = begin(&mut host, 5);
        host.system.linearise(&velocities).expect("a step is under way");
        let count = velocities.len();
        if count == 0 {
            continue;
        }
        let change = random(count, 0.3, 11);
        let moved = |h: f64| -> Vec<f64> { velocities.iter().zip(&change).map(|(v, c)| v + h * c).collect() };
        let mut force = |v: &[f64]| {
            let mut forces = vec![0.0; count];
            host.system.add_forces(v, &mut forces).expect("a step is under way");
            (forces, host.system.energy(v).expect("a step is under way"))
        };
        let h = 1e-3;
        let ((before, low), (at, _), (after, high)) = (force(&moved(-h)), force(&velocities), force(&moved(h)));
        let slope = (high - low) / (2.0 * h);
        let expected = -DT * dot(&at, &change);
        assert!((slope - expected).abs() <= 1e-6 * expected.abs(), "{pair:?}, {rigid:?}: {slope} against {expected}");

        let mut product = vec![0.0; count];
        host.system.add_product(1.0, &change, &mut product).expect("a step is under way");
        let size = dot(&product, &product).sqrt();
        let error: f64 =
            (0..count).map(|k| ((before[k] - after[k]) / (2.0 * h) - product[k]).powi(2)).sum::<f64>().sqrt();
        assert!(size > 0.0 && error <= 1e-6 * size, "{pair:?}, {rigid:?}: {error} of {size}");

        // Symmetric, and positive semi-definite.
        let other = random(count, 0.3, 12);
        let mut turned = vec![0.0; count];
        host.system.add_product(1.0, &other, &mut turned).expect("a step is under way");
        let (one, two) = (dot(&other, &product), dot(&change, &turned));
        assert!((one - two).abs() <= 1e-11 * size * dot(&other, &other).sqrt(), "{pair:?}, {rigid:?}: {one}, {two}");
        if rigid == RigidUnknowns::Kept {
            let mut matrix = DMatrix::<f64>::zeros(count, count);
            let blocks = host.system.for_each_block(1.0, |row, column, block| {
                (0..9).for_each(|k| matrix[(3 * row + k / 3, 3 * column + k % 3)] += block[k]);
            });
            blocks.expect("rigid bodies are kept");
            let rows = host.system.compressed_rows(1.0).expect("rigid bodies are kept");
            assert_compressed(rows, &matrix);
            let assembled = &matrix * nalgebra::DVector::from_column_slice(&change);
            let error = (0..count).map(|k| (assembled[k] - product[k]).powi(2)).sum::<f64>().sqrt();
            assert!(error <= 1e-11 * size, "{pair:?}: {error} of {size}");
            let eigenvalues = ((&matrix + matrix.transpose()) * 0.5).symmetric_eigenvalues();
            assert!(eigenvalues.min() >= -1e-10 * eigenvalues.max(), "{pair:?}: {}", eigenvalues.min());
        } else {
            assert!(dot(&change, &product) >= 0.0);
        }
    }
}

/// The rows are `expected`, in ascending order and without a place twice, and as symmetric as sums in another order are.
fn assert_compressed(CompressedRows { offsets, columns, values }: CompressedRows<'_>, expected: &DMatrix<f64>) {
    let count = expected.nrows();
    assert!(offsets.len() == count + 1 && offsets[0] == 0 && offsets[count] as usize == columns.len());
    let mut matrix = DMatrix::<f64>::zeros(count, count);
    for (row, ends) in offsets.windows(2).enumerate() {
        let own = ends[0] as usize..ends[1] as usize;
        assert!(columns[own.clone()].is_sorted_by(|one, next| one < next), "row {row}");
        for at in own {
            matrix[(row, columns[at] as usize)] = values[at];
        }
    }
    let near = |one: &DMatrix<f64>, other: &DMatrix<f64>| (one - other).norm() <= 1e-14 * expected.norm();
    assert!(columns.len() == values.len() && near(&matrix, expected) && near(&matrix, &matrix.transpose()));
}

/// A host that eliminates rigid bodies gets what one that solves for them gets.
#[test]
fn eliminated_bodies_end_as_if_they_were_solved_for() {
    for pair in [["rigid", "soft"], ["cage", "rigid"], ["rigid", "rigid"]] {
        let mut kept = overlap(pair, RigidUnknowns::Kept, material(0.6, 0.02));
        let mut eliminated = overlap(pair, RigidUnknowns::Eliminated, material(0.6, 0.02));
        begin(&mut kept, 9);
        begin(&mut eliminated, 9);
        let nodes = 3 * kept.masses.len();
        // The whole system, dense: (M + dt K) v = M v0 + dt (f(0)).
        let count = kept.system.unknown_count();
        let mut forces = vec![0.0; count];
        kept.system.add_forces(&vec![0.0; count], &mut forces).expect("a step is under way");
        let mut matrix = DMatrix::<f64>::zeros(count, count);
        let add = |row: usize, column: usize, block: [f64; 9]| {
            (0..9).for_each(|k| matrix[(3 * row + k / 3, 3 * column + k % 3)] += block[k]);
        };
        kept.system.for_each_block(DT, add).expect("rigid bodies are kept");
        let mut right = nalgebra::DVector::from_iterator(count, forces.iter().map(|f| DT * f));
        for k in 0..nodes {
            matrix[(k, k)] += kept.masses[k / 3];
            right[k] += kept.masses[k / 3] * kept.v[k];
        }
        for (place, rigid) in kept.rigids.iter().enumerate() {
            let inertia = rigid.rotation * rigid.inertia * rigid.rotation.transpose();
            let start = nodes + 6 * place;
            let [.., x, y, z] = rigid.velocity;
            let spin = inertia * V3::new(x, y, z);
            for row in 0..3 {
                matrix[(start + row, start + row)] += rigid.mass;
                right[start + row] += rigid.mass * rigid.velocity[row];
                right[start + 3 + row] += spin[row];
                (0..3).for_each(|column| matrix[(start + 3 + row, start + 3 + column)] += inertia[(row, column)]);
            }
        }
        let solution = matrix.cholesky().expect("positive definite").solve(&right);
        let velocities = &solution.as_slice()[..nodes];
        eliminated.system.finish(velocities).expect("a step is under way");
        for (place, rigid) in kept.rigids.iter().enumerate() {
            let found = eliminated.system.rigid_velocity(rigid.body).expect("it is rigid");
            let expected = &solution.as_slice()[nodes + 6 * place..nodes + 6 * place + 6];
            for k in 0..6 {
                assert!((found[k] - expected[k]).abs() < 1e-9, "{pair:?}: {found:?} against {expected:?}");
            }
        }
    }
}
