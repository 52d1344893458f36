//! What a scene remembers goes on from step to step, not from query to query.

use crate::common::assert_every_ray_is_counted;
use crate::common::shapes::{self, Point, Shape};
use raycontact::contact::{ContactList, DetectionOptions, Sampling};
use raycontact::scene::{Scene, SceneError};

const WHOLE: f64 = 1.0 / 60.0;

/// A plate between two slabs of one body, pressed into both, which push against each other: after eight steps without a
/// smaller overlap it escapes.
fn jam() -> [Shape; 2] {
    let cuboid = |half: Point, z: f64| {
        shapes::cube(1).map(|point| std::array::from_fn(|axis| half[axis] * point[axis])).moved([0.0, 0.0, z])
    };
    let slab = |side: f64| cuboid([1.0, 1.0, 0.1], side * 0.475);
    [cuboid([2.0, 2.0, 0.5], 0.0), slab(1.0).joined(&slab(-1.0))]
}

fn scene() -> Scene<f64> {
    let mut scene = Scene::new(1).expect("no thread is started");
    scene.set_options(DetectionOptions { sampling: Sampling::Vertices, ..DetectionOptions::default() });
    jam().iter().for_each(|shape| {
        scene.add(shape.mesh());
    });
    scene
}

fn query(scene: &mut Scene<f64>) -> ContactList<f64> {
    let mut list = ContactList::default();
    scene.query(&mut list);
    assert_every_ray_is_counted(&list);
    list
}

/// Moves the first body a little up or down.
fn shake(scene: &mut Scene<f64>, step: usize) {
    let up = if step.is_multiple_of(2) { 1e-6 } else { 0.0 };
    scene.mesh_mut(0).expect("it is there").set_positions(&jam()[0].moved([0.0, 0.0, up]).positions).expect("finite");
}

#[test]
fn the_same_positions_have_the_same_contacts_however_often_they_are_asked_for() {
    for advances in [false, true] {
        let mut scene = scene();
        if advances {
            scene.advance(WHOLE).expect("a length");
        }
        for step in 0..3 {
            shake(&mut scene, step);
            let first = query(&mut scene);
            assert!(!first.is_empty() && first.statistics.escaping_pairs == 0);
            for number in 0..40 {
                assert_eq!(query(&mut scene), first, "query {number}");
                if advances {
                    // Nor do positions that are set anew and are the same.
                    shake(&mut scene, step);
                }
            }
        }
    }
}

/// Also while a pair escapes, and in the step in which it begins to.
#[test]
fn the_same_positions_have_the_same_contacts_on_the_way_out() {
    let mut scene = scene();
    let mut started = 0;
    for step in 0..16 {
        shake(&mut scene, step);
        let first = query(&mut scene);
        started += first.statistics.escapes_started;
        (0..4).for_each(|_| assert_eq!(query(&mut scene), first, "step {step}"));
        scene.advance(WHOLE).expect("a length");
    }
    assert_eq!(started, 1);
}

/// In which step the pair begins to escape, with so many queries a step.
fn step_of_escape(queries: usize, seconds: Option<f64>) -> Option<usize> {
    let mut scene = scene();
    // From here on the host says where steps end.
    seconds.iter().for_each(|_| scene.advance(0.0).expect("a length"));
    (0..200).find(|&step| {
        let started = (0..queries).map(|number| {
            // Each query of a step looks at other positions.
            shake(&mut scene, step + number);
            query(&mut scene).statistics.escapes_started
        });
        let started = started.max().unwrap_or_default();
        seconds.iter().for_each(|&seconds| scene.advance(seconds).expect("a length"));
        started > 0
    })
}

#[test]
fn escapes_begin_after_steps_not_queries() {
    for queries in [1, 2, 5] {
        assert_eq!(step_of_escape(queries, Some(WHOLE)), Some(8), "{queries} queries a step");
        assert_eq!(step_of_escape(queries, Some(0.5)), Some(8), "{queries} queries a step");
    }
    // A host that never says where a step ends.
    assert_eq!(step_of_escape(1, None), Some(8));
}

#[test]
fn short_steps_count_as_parts_of_whole_ones() {
    for parts in [2, 4, 10] {
        let found = step_of_escape(1, Some(WHOLE / parts as f64)).expect("it begins");
        assert!((7 * parts..=8 * parts).contains(&found), "{parts} parts: step {found}");
    }
    assert_eq!(step_of_escape(1, Some(0.0)), None, "time stands still");
}

/// An escape that begins in a short step goes on in the next.
#[test]
fn an_escape_begins_at_once() {
    let mut scene = Scene::<f64>::new(1).expect("no thread is started");
    [shapes::cube(1), shapes::cube(1).scaled(0.2).moved([0.1, 0.3, -0.2])].iter().for_each(|shape| {
        scene.add(shape.mesh());
    });
    let mut started = 0;
    for _ in 0..5 {
        let found = query(&mut scene);
        started += found.statistics.escapes_started;
        assert_eq!(found.statistics.escaping_pairs, 1);
        scene.advance(WHOLE / 100.0).expect("a length");
    }
    assert_eq!(started, 1);
}

#[test]
fn a_step_that_is_no_length_is_refused() {
    let mut scene = scene();
    for seconds in [f64::NAN, f64::INFINITY, -1.0] {
        let error = scene.advance(seconds);
        assert!(matches!(error, Err(SceneError::StepLength { .. })), "{error:?}");
    }
    // Nothing was changed: positions that change still end a step.
    let started = (0..9).map(|step| {
        shake(&mut scene, step);
        query(&mut scene).statistics.escapes_started
    });
    assert_eq!(started.sum::<u64>(), 1);
}

/// Saved between two queries of a step, a scene goes on as if it had not been.
#[test]
fn a_step_may_be_saved_in_its_middle() {
    for advances in [false, true] {
        let (mut saved, mut restored) = (scene(), scene());
        for step in 0..20 {
            shake(&mut saved, step);
            query(&mut saved);
            let mut bytes = Vec::new();
            saved.save_pair_memories(&mut bytes);
            shake(&mut restored, step);
            restored.restore_pair_memories(&bytes).expect("they were saved");
            let mut again = Vec::new();
            restored.save_pair_memories(&mut again);
            assert_eq!(again, bytes);
            assert_eq!(query(&mut restored), query(&mut saved), "step {step}");
            if advances {
                saved.advance(WHOLE).expect("a length");
            }
        }
    }
}
