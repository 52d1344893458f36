//! A body folded onto itself that also touches another loses no contact of either kind. The paper names this as its
//! failure: a ray that meets another fold of its own body is refused there.

use crate::common::STRIDE;
use crate::common::assert_every_ray_is_counted;
use crate::common::ends::{Ends, Offset, ends};
use crate::common::random::Random;
use crate::common::shapes::{self, Point, Shape, cross, dot};
use raycontact::contact::{Contact, ContactLaw, ContactList, DetectionOptions, Sampling, query_self};
use raycontact::escape::query_pair;
use raycontact::query::Octree;
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
        for law in [ContactLaw::RayLength, ContactLaw::Pressure] {
            for sampling in [Sampling::Vertices, Sampling::default()] {
                let with = pair(&first, &second, &DetectionOptions { law, sampling, ..options(true) });
                let without = pair(&first, &second, &DetectionOptions { law, sampling, ..options(false) });
                assert_eq!(with, without);
            }
        }
    }
}

/// Whether a point lies inside a convex shape.
fn is_inside(shape: &Shape, point: Point) -> bool {
    let from = |a: Point, b: Point| -> Point { std::array::from_fn(|axis| b[axis] - a[axis]) };
    shape.triangles.iter().all(|corners| {
        let [a, b, c] = corners.map(|vertex| shape.positions[vertex as usize]);
        dot(cross(from(a, b), from(a, c)), from(a, point)) < 0.0
    })
}

/// The judge: how much of the surfaces of the first shapes lies inside any of the others, all convex, by many points.
fn area_inside(shapes: &[&Shape], others: &[&Shape]) -> f64 {
    const CUTS: u32 = 30;
    let triangles = shapes.iter().flat_map(|shape| shape.triangles.iter().map(move |corners| (shape, corners)));
    let area = |(shape, corners): (&&Shape, &[u32; 3])| {
        let [a, b, c] = corners.map(|vertex| shape.positions[vertex as usize]);
        let point = |i: f64, j: f64| -> Point {
            std::array::from_fn(|axis| a[axis] + ((b[axis] - a[axis]) * i + (c[axis] - a[axis]) * j) / f64::from(CUTS))
        };
        let cells = (0..CUTS).flat_map(|i| (0..CUTS - i).map(move |j| (f64::from(i), f64::from(j))));
        let up = cells.clone().map(|(i, j)| point(i + 1.0 / 3.0, j + 1.0 / 3.0));
        let down = cells.filter(|(i, j)| i + j < f64::from(CUTS - 1)).map(|(i, j)| point(i + 2.0 / 3.0, j + 2.0 / 3.0));
        let inside = up.chain(down).filter(|&at| others.iter().any(|other| is_inside(other, at))).count();
        let [u, v]: [Point; 2] = [b, c].map(|corner| std::array::from_fn(|axis| corner[axis] - a[axis]));
        let across = cross(u, v);
        dot(across, across).sqrt() / 2.0 * inside as f64 / f64::from(CUTS * CUTS)
    };
    triangles.map(area).sum()
}

/// Two shapes that overlap, as one body, and another body: what lies inside counts once, piece by piece. The two directions'
/// areas are all that lies inside, each times its share.
#[test]
fn a_piece_counts_as_a_whole_or_with_its_part_inside() {
    let ball = |levels: usize, by: Point| shapes::sphere(levels).moved(by);
    let bar =
        |half: Point, by: Point| shapes::cube(1).map(|p| std::array::from_fn(|axis| half[axis] * p[axis])).moved(by);
    let bars = [bar([0.4, 0.8, 0.3], [-0.1, 0.0, 0.0]).turned(0.3, 0.2), bar([0.9, 0.35, 0.5], [0.2, 0.1, 0.1])];
    let mut cases = vec![(bars, ball(2, [0.2, 0.9, 0.3]), 0.01)];
    // The finest balls have triangles too short to be cut, so each counts as a whole or not at all, by where its middle lies.
    for (levels, tolerance) in [(1, 0.01), (2, 0.01), (3, 0.02)] {
        let lobes = [ball(levels, [-0.45, 0.0, 0.0]), ball(levels, [0.45, 0.0, 0.0])];
        cases.push((lobes, ball(levels, [0.13, 1.1, 0.21]), tolerance));
    }
    for (number, ([first, second], body, tolerance)) in cases.iter().enumerate() {
        let folded = first.joined(second);
        let inside = [area_inside(&[first, second], &[body]), area_inside(&[body], &[first, second])];
        for has_self_collision in [false, true] {
            let mut scene = Scene::<f64>::new(1).expect("no thread is started");
            // Samples follow the load, so of the area alone they know less.
            let sampling = Sampling::Accuracy(0.001);
            let past_folds = !has_self_collision;
            scene.set_options(DetectionOptions { sampling, past_folds, ..DetectionOptions::default() });
            let bodies = [scene.add(folded.mesh()), scene.add(body.mesh())];
            scene.set_self_collision(bodies[0], has_self_collision).expect("it was added");
            let mut found = ContactList::default();
            scene.query(&mut found);
            assert_every_ray_is_counted(&found);
            assert_eq!(found.statistics.escaping_pairs, 0);
            let mut ids: Vec<u64> = found.contacts.iter().map(Contact::id).collect();
            ids.sort_unstable();
            ids.dedup();
            assert_eq!(ids.len(), found.len(), "{number}, self-collision {has_self_collision}");
            let part = |side: usize| {
                let of_pair = found.contacts.iter().filter(|contact| contact.colliding != contact.collided);
                let cast = of_pair.filter(|contact| contact.colliding == bodies[side]);
                cast.map(|contact| contact.area).sum::<f64>() / inside[side]
            };
            let parts = [part(0), part(1)];
            assert!(
                (parts[0] + parts[1] - 1.0).abs() < *tolerance,
                "{number}, self-collision {has_self_collision}: {parts:?}"
            );
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
