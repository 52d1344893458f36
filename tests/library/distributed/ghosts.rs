//! What systems that share bodies are made of, against what one system does by itself.

use crate::common::host::Host;
use crate::system::laws::{DT, PAIRS, begin, material, overlap};
use raycontact::distributed::{Parts, Sharing, detect_among, largest_coupling, look_again};
use raycontact::system::{RigidUnknowns, Surface, SystemError};
use std::collections::BTreeMap;

fn with_floor(pair: [&str; 2]) -> Host {
    let mut host = overlap(pair, RigidUnknowns::Kept, material(0.6, 0.02));
    host.system.add_half_space([0.0, 0.0, 1.0], 0.12, material(0.4, 0.01)).expect("a floor");
    host
}

#[test]
fn blocks_and_energies_of_parts_add_up() {
    for pair in PAIRS {
        let mut host = with_floor(pair);
        let velocities = begin(&mut host, 3);
        host.system.linearise(&velocities).expect("a step is under way");
        let mut found = Parts::default();
        let (parts, part_blocks) = found.of(&mut host.system).expect("a step is under way").lists();
        let (parts, part_blocks) = (parts.to_vec(), part_blocks.to_vec());

        let mut expected: BTreeMap<(usize, usize), [f64; 9]> = BTreeMap::new();
        let add = |sums: &mut BTreeMap<_, [f64; 9]>, place, numbers: &[f64; 9]| {
            let sum = sums.entry(place).or_insert([0.0; 9]);
            (0..9).for_each(|k| sum[k] += numbers[k]);
        };
        let all = |row: usize, column: usize, block: [f64; 9]| add(&mut expected, (row, column), &block);
        host.system.for_each_block(0.5, all).expect("a step is under way");
        let blocks = found.of(&mut host.system).and_then(|parts| parts.matrix(0.5)).expect("a step is under way");
        assert!(blocks.windows(2).all(|two| {
            let place = |k: usize| (two[k].part, two[k].row, two[k].column);
            place(0) < place(1)
        }));
        let mut sums = BTreeMap::new();
        for block in blocks {
            let part = &parts[block.part];
            assert!(part_blocks[part.start..part.start + part.count].contains(&block.row), "{pair:?}");
            add(&mut sums, (block.row as usize, block.column as usize), &block.numbers);
        }
        assert_eq!(sums.len(), expected.len(), "{pair:?}");
        let size = expected.values().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
        for (place, numbers) in &expected {
            assert!((0..9).all(|k| (sums[place][k] - numbers[k]).abs() <= 1e-13 * size), "{pair:?}: {place:?}");
        }

        let mut joules = vec![f64::NAN; parts.len()];
        let mut of_step = found.of(&mut host.system).expect("a step is under way");
        of_step.energies(&velocities, &mut joules).expect("a step is under way");
        let whole = host.system.energy(&velocities).expect("a step is under way");
        assert!(whole > 0.0 && (joules.iter().sum::<f64>() - whole).abs() <= 1e-13 * whole, "{pair:?}");
        for (part, joules) in parts.iter().zip(&joules) {
            let is_second = matches!(part.other, Surface::Body(other) if other < part.body);
            assert!(!is_second || *joules == 0.0, "{pair:?}: a pair's energy counts once");
        }
    }
}

/// As [`raycontact::system::ContactSystem::explicit_step`], in its parts.
#[test]
fn an_explicit_step_is_made_of_its_parts() {
    for pair in PAIRS {
        let mut host = with_floor(pair);
        host.set_motions(DT);
        let mut start = host.v.clone();
        host.rigids.iter().for_each(|rigid| start.extend(rigid.velocity));
        let count = host.system.unknown_count();
        host.system.begin_explicit(&mut host.scene, DT, &host.x, &host.v).expect("a step");
        let mut found = Parts::default();
        let blocks = found.of(&mut host.system).expect("a step is under way").lists().1.to_vec();
        let (mut of_parts, mut couplings) = (vec![0.0; 3 * blocks.len()], vec![f64::NAN; blocks.len()]);
        let mut of_step = found.of(&mut host.system).expect("a step is under way");
        of_step.forces(&start, &mut of_parts).expect("a step is under way");
        of_step.couplings(&mut couplings).expect("a step is under way");
        let (mut forces, mut sums) = (vec![0.0; count], vec![0.0; count / 3]);
        for (k, &block) in blocks.iter().enumerate() {
            sums[block as usize] += couplings[k];
            (0..3).for_each(|axis| forces[3 * block as usize + axis] += of_parts[3 * k + axis]);
        }
        let [largest, damping_time] = largest_coupling(&host.system, &sums).expect("a step is under way");
        host.system.finish(&start).expect("a step is under way");
        let longest = (damping_time * damping_time + 4.0 / largest).sqrt() - damping_time;

        let mut other = with_floor(pair);
        other.set_motions(DT);
        let mut expected = vec![0.0; count];
        let whole = other.system.explicit_step(&mut other.scene, DT, &other.x, &other.v, &mut expected);
        let whole = whole.expect("a step");
        assert!((longest - whole).abs() <= 1e-12 * whole, "{pair:?}: {longest} and {whole}");
        let size = expected.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        assert!(size > 0.0 && forces.iter().zip(&expected).all(|(a, b)| (a - b).abs() <= 1e-12 * size), "{pair:?}");
    }
}

#[test]
fn a_second_look_is_made_of_its_parts() {
    for pair in PAIRS {
        let forces = |mut host: Host, in_parts: bool| {
            host.v.fill(0.0);
            host.set_motions(DT);
            // Without contact the second body flies away, but it does not.
            let mut free = host.v.clone();
            free[2 * host.x.len() / 3..].iter_mut().for_each(|v| *v += 40.0);
            let Host { system, scene, x, v, .. } = &mut host;
            system.begin(scene, DT, x, v, &free).expect("a step");
            let end = vec![0.0; system.unknown_count()];
            let is_more = if in_parts {
                let [nodes, rigid] = system.off_course(scene, &end).expect("a step is under way");
                let farthest = free.chunks_exact(3).map(|v| v.iter().map(|x| x * x).sum::<f64>()).fold(0.0, f64::max);
                assert!(nodes == farthest && rigid == 0.0, "{pair:?}: {nodes} {rigid}");
                look_again(system, scene, &end).expect("a step is under way");
                let is_more = detect_among(system, scene, x, v, &end).expect("a step is under way");
                if is_more {
                    system.linearise(&end).expect("a step is under way");
                }
                is_more
            } else {
                system.detect_again(scene, &end).expect("a step is under way")
            };
            let mut forces = vec![0.0; end.len()];
            system.add_forces(&end, &mut forces).expect("a step is under way");
            (is_more, forces.into_iter().map(f64::to_bits).collect::<Vec<_>>())
        };
        assert_eq!(forces(with_floor(pair), true), forces(with_floor(pair), false), "{pair:?}");
    }
}

#[test]
fn only_ghosts_join_a_step() {
    let mut host = with_floor(["soft", "rigid"]);
    let velocities = begin(&mut host, 3);
    let masses = host.masses.clone();
    let late = host.scene.add(raycontact::mesh::Mesh::clone(host.scene.mesh(1).expect("it is there")));
    let add = |host: &mut Host| host.system.add_moved(&host.scene, late, material(0.5, 0.01));
    assert!(matches!(add(&mut host), Err(SystemError::StepUnderWay)));
    let sharing = Sharing { is_foreign: true, ..Default::default() };
    host.scene.share(late, sharing).expect("it is there");
    add(&mut host).expect("a ghost");
    let others = vec![2.0; masses.len()];
    assert!(matches!(host.system.set_node_masses(&others), Err(SystemError::StepUnderWay)), "others keep their masses");
    let more: Vec<f64> = masses.iter().copied().chain([1.0; 4]).collect();
    host.system.set_node_masses(&more).expect("nodes for ghosts");
    let longer = host.system.unknown_count();
    assert_eq!(longer, velocities.len() + 12);
    let refused = host.system.linearise(&velocities);
    assert!(matches!(refused, Err(SystemError::WrongCount { expected, .. }) if expected == longer));
    let mut velocities = vec![0.0; longer];
    velocities[..3].fill(0.1);
    host.system.linearise(&velocities).expect("the step goes on");
    host.system.finish(&velocities).expect("and ends");
}
