//! A body folded onto itself that also touches another loses no contact of either kind. The paper names this as its
//! failure: a ray that meets another fold of its own body is refused there.

use crate::common::STRIDE;
use crate::common::assert_every_ray_is_counted;
use crate::common::ends::{Ends, Offset, ends};
use crate::common::random::Random;
use crate::common::shapes::{self, Shape};
use raycontact::contact::{Contact, ContactList, DetectionOptions, Sampling, query_pair, query_self};
use raycontact::octree::Octree;
use raycontact::scene::{Scene, SceneError};

/// Rays from vertices, and nothing that replaces contacts.
fn options(past_folds: bool) -> DetectionOptions<f64> {
    DetectionOptions { past_folds, ..DetectionOptions::paper() }
}

fn pair(a: &Shape, b: &Shape, options: &DetectionOptions<f64>) -> ContactList<f64> {
    let meshes = [a.mesh(), b.mesh()];
    let octrees = [Octree::new(&meshes[0]), Octree::new(&meshes[1])];
    let mut contacts = ContactList::default();
    query_pair(&meshes[0], &octrees[0], &meshes[1], &octrees[1], options, &mut contacts).expect("the octrees are new");
    contacts
}

/// Two overlapping lobes, and a body that overlaps both.
fn lobes_and_body(seed: u64) -> ([Shape; 2], Shape) {
    let mut random = Random::new(seed);
    let first = shapes::sphere(2);
    let second = shapes::torus(16, 10, 0.45).turned(3.0 * random.signed(), 3.0 * random.signed());
    let body = shapes::sphere(2).turned(1.0, 2.0);
    ([first, second.moved(random.point(0.7))], body.moved(random.point(1.3)))
}

/// The judge: each lobe as a body of its own. Gives how many contacts with lobes there are, and how many of these are
/// missing.
fn compare(seed: u64, past_folds: bool) -> (usize, usize) {
    let ([first, second], body) = lobes_and_body(seed);
    let second_offset = Offset { triangle: first.triangles.len() as u32, vertex: first.positions.len() as u32 };
    let whole = pair(&first.joined(&second), &body, &options(past_folds));
    assert_every_ray_is_counted(&whole);
    let none = Offset::default();
    let found: Vec<(u32, Ends<f64>)> = whole.contacts.iter().map(|c| (c.colliding, ends(c, [none; 2]))).collect();
    let (mut all, mut missing) = (0, 0);
    for (lobe, offset) in [(&first, none), (&second, second_offset)] {
        let expected = pair(lobe, &body, &options(false));
        all += expected.len();
        missing += expected.contacts.iter().filter(|contact| !is_among(contact, offset, &found)).count();
    }
    (all, missing)
}

/// From a lobe just the same contact; from the body one that starts there, and leads out of a lobe no later.
fn is_among(contact: &Contact<f64>, lobe: Offset, found: &[(u32, Ends<f64>)]) -> bool {
    if contact.colliding == 0 {
        return found.contains(&(0, ends(contact, [lobe, Offset::default()])));
    }
    let expected = ends(contact, [Offset::default(), lobe]);
    found.iter().any(|(colliding, ends)| {
        *colliding == 1 && ends.vertices[0] == expected.vertices[0] && ends.depth <= expected.depth
    })
}

#[test]
fn no_contact_is_lost_to_another_fold() {
    let (mut all, mut missing, mut missing_without) = (0, 0, 0);
    for seed in (0..80).step_by(STRIDE) {
        let (expected, lost) = compare(seed, true);
        all += expected;
        missing += lost;
        missing_without += compare(seed, false).1;
    }
    assert!(all > 4000 / STRIDE, "{all}");
    assert_eq!(missing, 0);
    assert!(missing_without > 200 / STRIDE, "the folds do hide the other body: {missing_without}");
}

/// With self-collision on, a scene finds the body's contacts with itself, as alone, and then those with the other body.
#[test]
fn a_scene_finds_both_kinds() {
    for seed in 0..4 {
        let ([first, second], body) = lobes_and_body(seed);
        let folded = first.joined(&second);
        for threads in [1, 2] {
            let mut scene = Scene::new(threads).expect("two threads are to be had");
            scene.set_options(options(false));
            let (other, number) = (scene.add(body.mesh()), scene.add(folded.mesh()));
            let mut found = ContactList::default();
            scene.query(&mut found);
            assert_every_ray_is_counted(&found);
            assert_eq!(found.statistics.self_contacts, 0, "off for a new body");

            scene.set_self_collision(number, true).expect("it was added");
            scene.set_self_collision(other, true).expect("it was added");
            scene.query(&mut found);
            assert_every_ray_is_counted(&found);
            let mesh = folded.mesh();
            let mut own = ContactList::default();
            query_self(&mesh, &Octree::new(&mesh), &options(false), &mut own).expect("the octree is new");
            own.contacts.iter_mut().for_each(|c| (c.colliding, c.collided) = (number, number));
            let with_other = pair(&body, &folded, &options(true));
            assert!(!own.is_empty());
            let expected: Vec<Contact<f64>> = with_other.contacts.iter().chain(&own.contacts).copied().collect();
            assert_eq!(found.contacts, expected);
            assert_eq!(found.statistics.self_contacts, own.len() as u64);

            scene.set_self_collision(number, false).expect("it was added");
            scene.query(&mut found);
            assert_every_ray_is_counted(&found);
            assert_eq!(found.contacts, pair(&body, &folded, &options(false)).contacts);
        }
    }
}

#[test]
fn unknown_bodies_are_refused() {
    let mut scene = Scene::<f64>::new(1).expect("no threads are needed");
    assert!(matches!(scene.set_self_collision(3, true), Err(SceneError::UnknownBody { body: 3 })));
}

/// Ordinary bodies: going past folds changes nothing where there are none.
#[test]
fn bodies_without_folds_are_as_before() {
    for seed in 0..8 {
        let ([first, second], _) = lobes_and_body(seed);
        for sampling in [Sampling::Vertices, Sampling::Automatic] {
            let with = pair(&first, &second, &DetectionOptions { sampling, ..options(true) });
            let without = pair(&first, &second, &DetectionOptions { sampling, ..options(false) });
            assert_eq!(with, without);
        }
    }
}

/// The same for rays from edges, where no vertex lies inside: a bar with a fold within it, across another bar.
#[test]
fn edges_find_their_way_past_folds() {
    let bar = |half: [f64; 3], middle: [f64; 3]| {
        shapes::cube(1).map(|p| std::array::from_fn(|axis| half[axis] * p[axis])).moved(middle)
    };
    let (first, fold) = (bar([1.0, 0.1, 0.1], [0.0; 3]), bar([1.2, 0.06, 0.02], [0.0, 0.0, 0.06]));
    let body = bar([0.11, 1.0, 0.12], [0.02, 0.0, 0.15]);
    let expected = pair(&first, &body, &DetectionOptions { edges: true, ..options(false) });
    let missing = |past_folds: bool| {
        let whole = pair(&first.joined(&fold), &body, &DetectionOptions { edges: true, ..options(past_folds) });
        assert_every_ray_is_counted(&whole);
        assert_eq!(whole.statistics.past_folds > 0, past_folds);
        let none = [Offset::default(); 2];
        let found: Vec<_> = whole.contacts.iter().map(|contact| (contact.colliding, ends(contact, none))).collect();
        expected.contacts.iter().filter(|contact| !is_among(contact, Offset::default(), &found)).count()
    };
    assert!(expected.len() >= 4 && expected.statistics.edge_contacts == expected.len() as u64);
    assert_eq!(missing(true), 0);
    assert!(missing(false) > 0, "the fold does hide the other body");
}
