//! Scenes that share bodies: keys in place of numbers, ghosts, packed meshes, and forces pair by pair.

use crate::common::random::Random;
use crate::common::shapes::{self, Shape};
use raycontact::contact::{Contact, ContactList};
use raycontact::distributed::{
    BytesError, ForcesByPair, Sharing, finds_pair, pack_mesh, packed_mesh_length, unpack_mesh,
};
use raycontact::force::{PenaltyLaw, Weighting, add_forces};
use raycontact::math::Vector3;
use raycontact::mesh::Mesh;
use raycontact::scene::{Scene, SceneError};
use std::collections::BTreeMap;

type Forces = BTreeMap<(u64, u32), Vector3<f64>>;

/// Two tori that cross in one body, thrown where others are.
fn shape(random: &mut Random) -> Shape {
    let middle = random.point(1.2);
    shapes::torus(14, 8, 0.35).joined(&shapes::torus(14, 8, 0.3).moved([0.2, 0.4, 0.15])).scaled(0.6).moved(middle)
}

/// The keys of fourteen bodies, in no order.
fn bodies() -> Vec<(u64, Shape)> {
    let mut random = Random::new(24);
    (0..14u64).map(|k| (1 << 40 | (k * 5 % 14), shape(&mut random))).collect()
}

fn no_velocities() -> Option<&'static [Vec<Vector3<f64>>]> {
    None
}

fn law() -> PenaltyLaw {
    PenaltyLaw::new(1000.0, 0.0, Weighting::Area).expect("a law")
}

/// A pair's forces, by the keys of its bodies, the first by key first.
type Parts = BTreeMap<[u64; 2], Forces>;

/// Each pair's forces, by key, of a scene whose bodies have these keys.
fn parts(list: &ContactList<f64>, keys: &BTreeMap<u32, u64>) -> Parts {
    let mut summed = ForcesByPair::default();
    summed.sum(list, &law(), no_velocities(), no_velocities());
    let named = summed.pairs().iter().map(|pair| {
        let of_pair = &summed.forces()[pair.start..pair.start + pair.counts[0] + pair.counts[1]];
        let body = |place: usize| keys[&pair.bodies[usize::from(place >= pair.counts[0])]];
        let forces =
            of_pair.iter().enumerate().map(|(place, &(vertex, force))| ((body(place), vertex), force)).collect();
        let [a, b] = pair.bodies.map(|number| keys[&number]);
        ([a.min(b), a.max(b)], forces)
    });
    named.collect()
}

/// All contacts by key.
fn named(list: &ContactList<f64>, keys: &BTreeMap<u32, u64>) -> Vec<(u64, u64, Contact<f64>)> {
    let named = |contact: &Contact<f64>| {
        (keys[&contact.colliding], keys[&contact.collided], Contact { colliding: 0, collided: 0, ..*contact })
    };
    list.contacts.iter().map(named).collect()
}

fn whole_scene(order: impl Fn(&mut Vec<(u64, Shape)>), threads: usize) -> (ContactList<f64>, BTreeMap<u32, u64>) {
    let mut scene = Scene::new(threads).expect("the threads start");
    let (mut given, mut keys) = (bodies(), BTreeMap::new());
    order(&mut given);
    for (key, shape) in given {
        let body = scene.add_with_key(shape.mesh(), key).expect("a new key");
        scene.set_self_collision(body, key % 2 == 0).expect("it was added");
        keys.insert(body, key);
    }
    let mut list = ContactList::default();
    scene.query(&mut list);
    (list, keys)
}

#[test]
fn the_order_is_that_of_the_keys() {
    let (list, keys) = whole_scene(|given| given.sort_by_key(|(key, _)| *key), 1);
    let expected = named(&list, &keys);
    assert!(expected.len() > 1000 && list.statistics.self_contacts > 0, "{}", expected.len());
    for threads in [1, 3] {
        let (list, keys) = whole_scene(|_| {}, threads);
        assert!(named(&list, &keys) == expected, "{threads} threads");
        let (list, keys) = whole_scene(|given| given.reverse(), threads);
        assert!(named(&list, &keys) == expected, "{threads} threads");
    }
    let mut scene = Scene::new(1).expect("no threads are needed");
    scene.add_with_key(shapes::cube(1).mesh::<f64>(), 7).expect("a new key");
    assert!(matches!(scene.add_with_key(shapes::cube(1).mesh(), 7), Err(SceneError::KeyTaken { key: 7 })));
}

/// What pairs and bodies took adds up, whoever worked on it.
#[test]
fn costs_of_pairs_add_up_to_those_of_bodies() {
    for threads in [1, 3] {
        let mut scene = Scene::<f64>::new(threads).expect("the threads start");
        assert!(scene.pair_costs().is_empty());
        let numbers: Vec<u32> = bodies()
            .into_iter()
            .map(|(key, shape)| scene.add_with_key(shape.mesh(), key).expect("a new key"))
            .collect();
        let mut list = ContactList::default();
        scene.query(&mut list);
        let costs = scene.pair_costs();
        assert_eq!(costs.len() as u64, list.statistics.pairs);
        let rays: f64 = costs.iter().map(|pair| pair.cost).sum();
        assert_eq!(rays, (list.statistics.rays + list.statistics.estimate_rays) as f64);
        for &body in &numbers {
            let of_pairs: f64 =
                costs.iter().filter(|pair| pair.bodies.contains(&body)).map(|pair| 0.5 * pair.cost).sum();
            let read = scene.mesh(body).expect("it was added").topology().triangles().len() as f64 / 50.0;
            assert_eq!(scene.body_cost(body).expect("it was added"), read + of_pairs);
        }
        let pairs: Vec<[u32; 2]> = scene.pair_memories().iter().map(|(pair, _)| *pair).collect();
        assert!(costs.iter().map(|pair| pair.bodies).eq(pairs), "{threads} threads");
    }
}

/// Two scenes, each with half of the bodies and ghosts of the others, find each pair once, and just what one scene finds.
#[test]
fn scenes_with_ghosts_find_what_one_scene_finds() {
    let (list, keys) = whole_scene(|_| {}, 1);
    let expected = parts(&list, &keys);
    let boxes: BTreeMap<u64, _> = bodies().iter().map(|(key, shape)| (*key, *shape.mesh::<f64>().aabb())).collect();
    let neighbours =
        |key: u64| boxes.iter().filter(|(other, aabb)| **other != key && aabb.overlaps(&boxes[&key])).count();
    let is_own = |key: u64, side: u64| key % 7 % 2 == side;
    let mut overlaps = BTreeMap::new();
    let mut scenes = [0, 1].map(|side| {
        let (mut scene, mut keys) = (Scene::new(1).expect("no threads are needed"), BTreeMap::new());
        for (key, shape) in bodies() {
            let body = scene.add_with_key(shape.mesh::<f64>(), key).expect("a new key");
            scene.set_self_collision(body, key % 2 == 0 && is_own(key, side)).expect("it was added");
            keys.insert(body, key);
        }
        scene.find_self_contacts();
        for (&body, &key) in keys.iter().filter(|(_, key)| is_own(**key, side)) {
            overlaps.insert(key, scene.overlaps_itself(body).expect("it was added"));
        }
        (scene, keys)
    });
    assert!(overlaps.values().any(|&overlaps| overlaps));
    let mut found = Parts::new();
    for (side, (scene, keys)) in scenes.iter_mut().enumerate() {
        for (&body, &key) in &*keys {
            let is_ghost = !is_own(key, side as u64);
            let sharing = Sharing {
                is_foreign: is_ghost,
                neighbours: Some(neighbours(key) as u32),
                overlaps_itself: is_ghost && overlaps[&key],
            };
            scene.share(body, sharing).expect("it was added");
        }
        let mut list = ContactList::default();
        scene.query(&mut list);
        for (pair, forces) in parts(&list, keys) {
            let is_here = pair.map(|key| is_own(key, side as u64));
            assert_ne!(is_here, [false; 2], "a pair of two ghosts");
            if is_here != [true; 2] {
                let [own, ghost] = if is_here[0] { pair } else { [pair[1], pair[0]] };
                assert!(finds_pair(own, ghost));
            }
            assert!(found.insert(pair, forces).is_none(), "{pair:?} twice");
        }
        let costs: f64 = keys.keys().map(|&body| scene.body_cost(body).expect("it was added")).sum();
        assert!(costs >= (list.statistics.rays + list.statistics.estimate_rays) as f64);
    }
    assert!(found == expected);
}

/// The judge adds contact by contact.
#[test]
fn the_forces_of_all_pairs_are_those_of_all_contacts() {
    let (list, keys) = whole_scene(|_| {}, 1);
    let mut expected: Vec<Vec<Vector3<f64>>> = Vec::new();
    for (_, shape) in bodies() {
        expected.push(vec![Vector3::zeros(); shape.mesh::<f64>().positions().len()]);
    }
    add_forces(&list, &law(), no_velocities(), no_velocities(), &mut expected);
    let mut sums = Forces::new();
    for ((key, vertex), force) in parts(&list, &keys).into_values().flatten() {
        *sums.entry((key, vertex)).or_default() += force;
    }
    let largest = expected.iter().flatten().fold(0.0, |largest: f64, force| largest.max(force.norm()));
    for (number, forces) in expected.iter().enumerate() {
        for (vertex, force) in forces.iter().enumerate() {
            let sum = sums.get(&(keys[&(number as u32)], vertex as u32)).copied().unwrap_or_default();
            assert!((sum - force).norm() < 1e-13 * largest, "{number} {vertex}: {sum} {force}");
        }
    }
}

/// What a pair remembers goes over to another scene, which goes on as the first.
#[test]
fn pair_memories_go_over_one_by_one() {
    let block = |scale: f64, at| shapes::cube(1).scaled(scale).moved(at).mesh::<f64>();
    let meshes = || [block(1.0, [0.0; 3]), block(0.2, [0.1, 0.3, -0.2])];
    let query = |scene: &mut Scene<f64>| {
        let mut list = ContactList::default();
        scene.query(&mut list);
        scene.advance(1.0 / 60.0).expect("a length");
        list
    };
    let [mut first, mut second, mut fresh] = [0; 3].map(|_| Scene::new(1).expect("no threads are needed"));
    for (key, mesh) in meshes().into_iter().enumerate() {
        first.add_with_key(mesh, key as u64).expect("a new key");
    }
    for (key, mesh) in meshes().into_iter().enumerate().rev() {
        second.add_with_key(mesh.clone(), key as u64).expect("a new key");
        fresh.add_with_key(mesh, key as u64).expect("a new key");
    }
    (0..30).for_each(|_| drop(query(&mut first)));
    let &[(pair, memory)] = first.pair_memories() else { panic!("one pair") };
    assert!(pair == [0, 1] && memory.escape.is_some());
    assert!(matches!(second.set_pair_memory([0, 1], memory), Err(SceneError::PairMemory { pair: [0, 1] })));
    assert!(matches!(second.set_pair_memory([1, 7], memory), Err(SceneError::UnknownBody { body: 7 })));
    assert!(second.pair_memories().is_empty());
    second.set_pair_memory([1, 0], memory).expect("as it was given");
    assert_eq!(second.pair_memories(), [([1, 0], memory)]);
    query(&mut fresh);
    for _ in 0..5 {
        let [one, two] = [&mut first, &mut second].map(query);
        assert!(one.statistics.escaping_pairs == 1 && one.statistics == two.statistics);
        assert_eq!(first.pair_memories()[0].1, second.pair_memories()[0].1);
        assert_ne!(fresh.pair_memories()[0].1, second.pair_memories()[0].1);
    }
}

#[test]
fn a_packed_mesh_comes_back_as_it_was() {
    let mut random = Random::new(3);
    let (reference, other) = (shape(&mut random), shapes::sphere(2).moved([0.3, 0.2, 0.1]));
    let bent = reference.map(|[x, y, z]| [x + 0.2 * y * y, y, z - 0.1 * x * y]);
    let mut mesh = reference.mesh::<f64>();
    mesh.set_positions(&bent.rounded()).expect("finite");
    let mut bytes = Vec::new();
    pack_mesh(&mesh, &mut bytes);
    assert_eq!(bytes.len(), packed_mesh_length(&mesh));
    let mut unpacked = unpack_mesh::<f64>(&bytes).expect("as it was packed");
    assert_eq!(unpacked.topology().triangles(), mesh.topology().triangles());
    assert_eq!(unpacked.positions(), reference.mesh::<f64>().positions());
    unpacked.set_positions(&bent.rounded()).expect("finite");
    let query = |mesh: &Mesh<f64>| {
        let (mut scene, mut list) = (Scene::new(1).expect("no threads are needed"), ContactList::default());
        scene.add(mesh.clone());
        scene.add(other.mesh());
        scene.query(&mut list);
        list
    };
    let expected = query(&mesh);
    assert!(expected.len() > 20 && query(&unpacked) == expected);
    assert!(query(&bent.mesh()) != expected, "the reference positions count");
    // Whatever is changed or left out is noticed.
    let refused = |bytes: &[u8]| unpack_mesh::<f64>(bytes).expect_err("broken");
    for place in (0..bytes.len()).step_by(97).chain(bytes.len() - 8..bytes.len()) {
        let mut broken = bytes.clone();
        broken[place] ^= 4;
        refused(&broken);
        assert_eq!(refused(&bytes[..place]), BytesError::Foreign { length: place }.into());
    }
    // Also what fits its checksum: the last cluster's size.
    let mut forged = bytes.clone();
    let end = bytes.len() - 8;
    forged[end - 1] += 1;
    let sum = forged[..end]
        .iter()
        .fold(0xcbf2_9ce4_8422_2325_u64, |sum, byte| (sum ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3));
    forged[end..].copy_from_slice(&sum.to_le_bytes());
    assert_eq!(refused(&forged), BytesError::Damaged.into());
    let mut newer = bytes.clone();
    newer[8] = 9;
    assert_eq!(refused(&newer), BytesError::OtherVersion { version: 9 }.into());
    assert_eq!(unpack_mesh::<f32>(&bytes).expect_err("another"), BytesError::OtherPrecision { bytes: 8 }.into());
}
