//! Crowds: bodies that all overlap many others take no more rays than so many for each body.

use crate::common::random::Random;
use crate::common::shapes;
use raycontact::contact::{ContactList, DetectionOptions, Sampling};
use raycontact::scene::Scene;

/// So many tetrahedra anywhere in a cube of this width; the contacts, and the rays of each body.
fn crowd(count: usize, width: f64, sampling: Sampling<f64>) -> (ContactList<f64>, f64) {
    let (mut scene, mut random) = (Scene::new(1).expect("no threads are needed"), Random::new(3));
    scene.set_options(DetectionOptions { sampling, ..DetectionOptions::default() });
    for _ in 0..count {
        let place = [(); 3].map(|()| 0.5 * width * random.signed());
        scene.add(
            shapes::tetrahedron().scaled(0.5).turned(3.0 * random.signed(), 3.0 * random.signed()).moved(place).mesh(),
        );
    }
    let mut contacts = ContactList::default();
    scene.query(&mut contacts);
    let rays = contacts.statistics.rays as f64 / count as f64;
    (contacts, rays)
}

/// Eight times as many bodies in the same place, eight times as many pairs of each: no more rays of each.
#[test]
fn rays_of_a_body_do_not_grow_with_the_pairs_it_is_in() {
    let found = [25, 50, 200].map(|count| crowd(count, 2.0, Sampling::default()));
    let rays = found.each_ref().map(|(_, rays)| *rays);
    let pairs = found.each_ref().map(|(list, _)| list.statistics.pairs);
    assert!(pairs[2] > 50 * pairs[0], "{pairs:?}");
    assert!(rays[2] < 2.0 * rays[0], "rays of each body: {rays:?}");
    let crowded = found.each_ref().map(|(list, _)| list.statistics.crowded_pairs);
    assert!(crowded[2] > pairs[2] * 9 / 10, "{crowded:?} of {pairs:?} pairs");
}

/// Bodies that meet few others, and rays as dense as the caller asks, are left alone.
#[test]
fn few_neighbours_and_given_spacings_are_no_crowd() {
    for (count, sampling) in [(13, Sampling::default()), (60, Sampling::Spacing(0.2)), (60, Sampling::Vertices)] {
        let (contacts, _) = crowd(count, 1.0, sampling);
        assert!(contacts.statistics.pairs > 0);
        assert_eq!(contacts.statistics.crowded_pairs, 0, "{count} with {sampling:?}");
    }
}

/// A body that meets many which meet few: a floor under a hundred boxes.
#[test]
fn a_floor_is_no_crowd() {
    let mut scene = Scene::<f64>::new(1).expect("no threads are needed");
    let floor = shapes::cube(1).scaled(40.0).moved([0.0, 0.0, -40.0]);
    scene.add(floor.mesh());
    for number in 0..100 {
        let place = [f64::from(number % 10) * 3.0 - 15.0, f64::from(number / 10) * 3.0 - 15.0, 0.9];
        scene.add(shapes::cube(1).moved(place).mesh());
    }
    let mut contacts = ContactList::default();
    scene.query(&mut contacts);
    assert_eq!((contacts.statistics.pairs, contacts.statistics.crowded_pairs), (100, 0));
}
