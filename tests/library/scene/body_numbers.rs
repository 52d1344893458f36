//! Bodies that come and go: whatever was removed before, a scene finds what a new one with the same bodies does.

use crate::common::random::Random;
use crate::common::shapes::{self, Shape};
use raycontact::contact::{Contact, ContactList, DetectionOptions};
use raycontact::scene::{Scene, SceneError};
use std::collections::BTreeMap;

/// An octahedron that overlaps itself with a smaller one, thrown where others are.
fn shape(random: &mut Random) -> Shape {
    let middle = random.point(1.5);
    shapes::octahedron().scaled(0.7).joined(&shapes::octahedron().scaled(0.4).moved([0.5, 0.1, 0.05])).moved(middle)
}

/// Without escapes, which depend on earlier steps.
fn empty(threads: usize) -> Scene<f64> {
    let mut scene = Scene::new(threads).expect("the threads start");
    scene.set_options(DetectionOptions { escape: false, ..DetectionOptions::default() });
    scene
}

fn query(scene: &mut Scene<f64>) -> ContactList<f64> {
    let mut list = ContactList::default();
    scene.query(&mut list);
    list
}

/// What a new scene finds, with numbers as in the other: bodies are added in ascending order of theirs.
fn judge(bodies: &BTreeMap<u32, Shape>, ignored: [u32; 2]) -> (ContactList<f64>, Vec<Contact<f64>>) {
    let mut scene = empty(1);
    let numbers: Vec<u32> = bodies.keys().copied().collect();
    for (&number, shape) in bodies {
        let body = scene.add(shape.mesh());
        scene.set_self_collision(body, number.is_multiple_of(2)).expect("it was added");
    }
    if let [Ok(a), Ok(b)] = ignored.map(|number| numbers.binary_search(&number)) {
        scene.set_pair_collision(a as u32, b as u32, false).expect("both are there");
    }
    let list = query(&mut scene);
    let named = |contact: &Contact<f64>| Contact {
        colliding: numbers[contact.colliding as usize],
        collided: numbers[contact.collided as usize],
        ..*contact
    };
    let contacts = list.contacts.iter().map(named).collect();
    (list, contacts)
}

#[test]
fn contacts_do_not_depend_on_bodies_that_were_removed() {
    for threads in [1, 2] {
        let mut random = Random::new(5);
        let mut bodies = BTreeMap::new();
        let mut scene = empty(threads);
        let add = |scene: &mut Scene<f64>, bodies: &mut BTreeMap<u32, Shape>, random: &mut Random| {
            let shape = shape(random);
            let body = scene.add(shape.mesh());
            scene.set_self_collision(body, body.is_multiple_of(2)).expect("it was added");
            assert!(bodies.insert(body, shape).is_none(), "body {body} is there");
            body
        };
        for _ in 0..8 {
            add(&mut scene, &mut bodies, &mut random);
        }
        let (mut found, mut mixed) = (0, 0);
        for step in 0..1100 {
            // The numbers of those removed so far come back, between others.
            if step % 300 == 299 {
                scene.release_body_numbers();
            }
            let gone = *bodies.keys().nth((random.signed().abs() * 7.99) as usize).expect("eight are there");
            bodies.remove(&gone);
            scene.remove(gone).expect("it was there");
            let refused = scene.mesh(gone).map(drop);
            assert!(matches!(refused, Err(SceneError::UnknownBody { body }) if body == gone), "step {step}");
            let body = add(&mut scene, &mut bodies, &mut random);
            if step % 200 > 0 && !(300..320).contains(&step) {
                continue;
            }
            mixed +=
                usize::from(bodies.keys().any(|&number| number < 100) && bodies.keys().any(|&number| number > 200));
            let other = *bodies.keys().find(|&&number| number != body).expect("eight are there");
            let ignored = [body.min(other), body.max(other)];
            scene.set_pair_collision(body, other, false).expect("both are there");
            let list = query(&mut scene);
            let (expected, contacts) = judge(&bodies, ignored);
            assert_eq!(list.contacts, contacts, "step {step}, {threads} threads");
            assert_eq!(list.statistics.pairs, expected.statistics.pairs, "step {step}");
            scene.set_pair_collision(body, other, true).expect("both are there");
            found += list.len();
            assert!(scene.pair_memories().iter().all(|(pair, _)| pair.iter().all(|n| bodies.contains_key(n))));
        }
        assert!(found > 1000, "{found}");
        assert!(mixed > 5, "old numbers came back between others {mixed} times");
    }
}

/// Saved memories name bodies by number, also of a scene in which the numbers have gaps.
#[test]
fn memories_are_restored_where_the_same_numbers_are() {
    let [outer, inner] = [shapes::cube(4), shapes::sphere(1).scaled(0.4).moved([0.1, 0.2, 0.3])];
    let with_gap = || {
        let mut scene = Scene::<f64>::new(1).expect("no thread is started");
        scene.add(outer.mesh());
        scene.add(outer.mesh());
        scene.remove(0).expect("it was added");
        assert_eq!(scene.add(inner.mesh()), 2);
        scene
    };
    let mut first = with_gap();
    assert!(query(&mut first).statistics.escapes_started == 1);
    let mut saved = Vec::new();
    first.save_pair_memories(&mut saved);
    let mut second = with_gap();
    second.restore_pair_memories(&saved).expect("the same numbers");
    assert_eq!(second.pair_memories(), first.pair_memories());
    assert_eq!(second.pair_memories()[0].0, [1, 2]);
    assert_eq!(query(&mut second), query(&mut first));
    let mut without_gap = Scene::<f64>::new(1).expect("no thread is started");
    without_gap.add(outer.mesh());
    without_gap.add(inner.mesh());
    let refused = without_gap.restore_pair_memories(&saved);
    assert!(matches!(refused, Err(SceneError::UnknownBody { body: 2 })), "{refused:?}");
}
