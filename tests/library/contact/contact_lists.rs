//! Lists of contacts: when they are equal, one after another, counts added up.

use crate::common::shapes;
use raycontact::contact::{ContactList, Statistics};
use raycontact::scene::Scene;

/// Every count has a number of its own, and `step` more than the one before.
fn counts(first: u64, step: u64) -> Statistics {
    let mut next = first;
    let mut count = || {
        next += step;
        next
    };
    // In full, so that a count added later is not forgotten here.
    Statistics {
        pairs: count(),
        open_pairs: count(),
        rays: count(),
        patches: count(),
        estimate_rays: count(),
        replaced: count(),
        misses: count(),
        entry_hits: count(),
        own_surface_hits: count(),
        without_normal: count(),
        uncut_pieces: count(),
        edge_contacts: count(),
        self_contacts: count(),
        open_bodies: count(),
        past_folds: count(),
        escapes_started: count(),
        escaping_pairs: count(),
        escape_contacts: count(),
        escapes_turned: count(),
        escapes_forbidden: count(),
        tangled_bodies: count(),
        crowded_pairs: count(),
        tangled_pairs: count(),
        deep_pairs: count(),
        error_asked: first as f64,
        error_estimated: step as f64,
    }
}

#[test]
fn each_count_is_added_to_its_own_and_of_errors_the_largest_stays() {
    let mut sum = counts(100, 7);
    sum += counts(3, 2);
    assert_eq!(sum, Statistics { error_asked: 100.0, error_estimated: 7.0, ..counts(103, 9) });
}

/// A swallowed body: contacts, one push, counts.
fn escaping() -> ContactList<f64> {
    let mut scene = Scene::new(1).expect("no threads are needed");
    scene.add(shapes::cube(4).mesh());
    scene.add(shapes::sphere(1).scaled(0.4).moved([0.1, 0.2, 0.3]).mesh());
    let mut list = ContactList::default();
    scene.query(&mut list);
    assert!(!list.contacts.is_empty() && list.pushes().len() == 1);
    list
}

#[test]
fn lists_are_equal_where_contacts_and_counts_and_pushes_are() {
    let list = escaping();
    assert_eq!(list, list.clone());
    let mut other = list.clone();
    other.contacts[0].depth += 1.0;
    assert_ne!(list, other);
    let mut other = list.clone();
    other.statistics.rays += 1;
    assert_ne!(list, other);
    // Nothing but the push is left of the first.
    let mut pushes = list.clone();
    pushes.contacts.clear();
    pushes.statistics = Statistics::default();
    assert_ne!(pushes, ContactList::default());
}

#[test]
fn what_is_appended_comes_after_and_is_counted() {
    let list = escaping();
    let mut twice = list.clone();
    twice.append(&list);
    assert_eq!(twice.contacts, [&list.contacts[..], &list.contacts[..]].concat());
    assert_eq!(twice.pushes(), [list.pushes(), list.pushes()].concat());
    assert_eq!(twice.statistics.rays, 2 * list.statistics.rays);
    twice.clear();
    assert_eq!((twice.len(), twice.is_empty()), (0, true));
    assert_eq!(twice, ContactList::default());
}
