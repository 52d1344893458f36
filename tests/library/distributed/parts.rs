//! Rows summed part by part, and what pairs remember, taken to another system.

use crate::common::host::{Host, dot};
use crate::system::laws::{DT, PAIRS, begin, material, overlap, random};
use raycontact::distributed::{Parts, pack_memory, packed_memory_length, put_memory};
use raycontact::system::{Material, RigidUnknowns, Surface, SystemError};

fn with_floor(pair: [&str; 2], rigid: RigidUnknowns) -> Host {
    let mut host = overlap(pair, rigid, material(0.6, 0.02));
    host.system.add_half_space([0.0, 0.0, 1.0], 0.12, material(0.4, 0.01)).expect("a floor");
    host
}

#[test]
fn parts_add_up_to_forces_and_products() {
    for pair in PAIRS {
        let mut host = with_floor(pair, RigidUnknowns::Kept);
        let velocities = begin(&mut host, 3);
        host.system.linearise(&velocities).expect("a step is under way");
        let count = velocities.len();
        let change = random(count, 0.3, 11);
        let mut found = Parts::default();
        let (parts, blocks) = found.of(&mut host.system).expect("a step is under way").lists();
        let (parts, blocks) = (parts.to_vec(), blocks.to_vec());
        assert!(parts.iter().any(|part| part.body == 0 && part.other == Surface::Body(1)), "{pair:?}");
        assert!(parts.iter().any(|part| matches!(part.other, Surface::HalfSpace(0))), "{pair:?}: the floor");
        assert_eq!(parts.last().map(|part| part.start + part.count), Some(blocks.len()));
        for part in &parts {
            let own = &blocks[part.start..part.start + part.count];
            assert!(own.windows(2).all(|two| two[0] < two[1]), "{pair:?}: ascending, each once");
        }
        for is_product in [false, true] {
            let (mut expected, mut of_parts) = (vec![0.0; count], vec![f64::NAN; 3 * blocks.len()]);
            if is_product {
                host.system.add_product(2.0, &change, &mut expected).expect("a step is under way");
                let mut of_step = found.of(&mut host.system).expect("a step is under way");
                of_step.products(2.0, &change, &mut of_parts).expect("a step is under way");
            } else {
                host.system.add_forces(&velocities, &mut expected).expect("a step is under way");
                let mut of_step = found.of(&mut host.system).expect("a step is under way");
                of_step.forces(&velocities, &mut of_parts).expect("a step is under way");
            }
            let mut sum = vec![0.0; count];
            for (&block, numbers) in blocks.iter().zip(of_parts.chunks_exact(3)) {
                (0..3).for_each(|axis| sum[3 * block as usize + axis] += numbers[axis]);
            }
            let size = dot(&expected, &expected).sqrt();
            let error = sum.iter().zip(&expected).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
            assert!(size > 0.0 && error <= 1e-13 * size, "{pair:?}: {error} of {size}");
        }
        // A pair's part on its first body is the opposite of that on the second, where both are free.
        let mut forces = vec![0.0; 3 * blocks.len()];
        let mut of_step = found.of(&mut host.system).expect("a step is under way");
        of_step.forces(&velocities, &mut forces).expect("a step is under way");
        let net = |body: u32, other: u32| {
            let part = parts.iter().find(|part| part.body == body && part.other == Surface::Body(other)).expect("both");
            // Of a rigid body the first block is force, the second torque.
            let count = if pair[body as usize] == "rigid" { 1 } else { part.count };
            let own = &forces[3 * part.start..3 * (part.start + count)];
            own.chunks_exact(3).fold([0.0; 3], |sum, f| [sum[0] + f[0], sum[1] + f[1], sum[2] + f[2]])
        };
        let (one, two) = (net(0, 1), net(1, 0));
        let size: f64 = one.iter().map(|x| x.abs()).sum();
        assert!((0..3).all(|k| (one[k] + two[k]).abs() <= 1e-11 * size), "{pair:?}: {one:?} {two:?}");
    }
}

#[test]
fn a_system_of_eliminated_bodies_has_no_parts() {
    let mut host = with_floor(["rigid", "soft"], RigidUnknowns::Eliminated);
    let mut found = Parts::default();
    assert!(matches!(found.of(&mut host.system), Err(SystemError::NoStep)));
    begin(&mut host, 3);
    assert!(matches!(found.of(&mut host.system), Err(SystemError::Eliminated)));
}

/// Forces at the beginning of a step, of a host that has made some before.
fn forces_of_next_step(host: &mut Host) -> Vec<u64> {
    let velocities = begin(host, 40);
    let mut forces = vec![0.0; velocities.len()];
    host.system.add_forces(&velocities, &mut forces).expect("a step is under way");
    forces.into_iter().map(f64::to_bits).collect()
}

fn after_two_steps(pair: [&str; 2]) -> Host {
    let mut host = with_floor(pair, RigidUnknowns::Kept);
    for seed in [20, 21] {
        let velocities = begin(&mut host, seed);
        host.system.linearise(&velocities).expect("a step is under way");
        host.system.finish(&velocities).expect("a step is under way");
    }
    host
}

#[test]
fn what_pairs_remember_can_be_carried_to_another_system() {
    for pair in PAIRS {
        let mut host = after_two_steps(pair);
        let pairs: Vec<_> = host.system.remembered_pairs().collect();
        assert!(pairs.len() >= 2, "{pair:?}: {pairs:?}");
        let mut other = with_floor(pair, RigidUnknowns::Kept);
        other.scene.advance(DT).expect("a step");
        for &key in &pairs {
            let mut bytes = vec![];
            pack_memory(&host.system, key, &mut bytes).expect("it remembers");
            assert_eq!(bytes.len(), packed_memory_length(&host.system, key));
            put_memory(&mut other.system, key, &bytes).expect("what was packed");
            let mut again = vec![];
            pack_memory(&other.system, key, &mut again).expect("it remembers");
            assert_eq!(again, bytes, "{pair:?}");
        }
        let mut forgetful = with_floor(pair, RigidUnknowns::Kept);
        let expected = forces_of_next_step(&mut host);
        assert_eq!(forces_of_next_step(&mut other), expected, "{pair:?}");
        assert_ne!(forces_of_next_step(&mut forgetful), expected, "{pair:?}: without what was carried");
    }
}

#[test]
fn other_bytes_are_refused_and_change_nothing() {
    let mut host = after_two_steps(["soft", "rigid"]);
    let key = (0, Surface::Body(1));
    let mut bytes = vec![];
    pack_memory(&host.system, key, &mut bytes).expect("it remembers");
    for place in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[place] ^= 4;
        let refused = put_memory(&mut host.system, key, &changed);
        assert!(matches!(refused, Err(SystemError::Memory { .. })), "byte {place}");
        let refused = put_memory(&mut host.system, key, &bytes[..place]);
        assert!(matches!(refused, Err(SystemError::Memory { .. })), "the first {place}");
    }
    // A cube has fewer vertices than the bodies that these bytes are of.
    let mut small = overlap(["rigid", "rigid"], RigidUnknowns::Kept, Material::bearing(1e4, 0.1).expect("a material"));
    assert!(matches!(put_memory(&mut small.system, key, &bytes), Err(SystemError::Memory { .. })));
    for unknown in [(0, Surface::Body(7)), (0, Surface::HalfSpace(1))] {
        let refused = put_memory(&mut host.system, unknown, &bytes);
        assert!(matches!(refused, Err(SystemError::UnknownBody { .. })));
        let nothing = pack_memory(&host.system, unknown, &mut vec![]);
        assert!(matches!(nothing, Err(SystemError::NotRemembered { .. })));
    }
    let mut again = vec![];
    pack_memory(&host.system, key, &mut again).expect("it remembers");
    assert_eq!(again, bytes);
}
