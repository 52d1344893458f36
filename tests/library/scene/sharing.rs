//! Bodies that share a mesh have contacts as if each had its own, in whatever pose and order they are added.

use crate::common::assert_every_ray_is_counted;
use crate::common::shapes::{self, Point, Shape};
use raycontact::contact::{Contact, ContactList, DetectionOptions, Sampling, SpreadNumber};
use raycontact::mesh::Mesh;
use raycontact::scene::Scene;

const SAMPLINGS: [Sampling<f64>; 4] =
    [Sampling::Accuracy(0.01), Sampling::Spacing(0.3), Sampling::Accuracy(0.03), Sampling::Vertices];

fn rest() -> Shape {
    shapes::torus(64, 32, 0.4)
}

/// The body in a pose of its own, bent and stretched.
fn pose(number: usize) -> Vec<Point> {
    let k = number as f64;
    let stretch = [1.0 + 0.3 * (1.7 * k).sin(), 1.0 + 0.3 * (2.3 * k).cos(), 1.0];
    let shape = rest().map(|point| {
        let [x, y, z] = std::array::from_fn(|axis| stretch[axis] * point[axis]);
        [x, y, z + 0.2 * (2.0 * x + k).sin()]
    });
    // Two by two they meet.
    let at = [4.0 * (number / 2) as f64, 0.1 * k, 0.5 * (number % 2) as f64];
    shape.turned(0.4 * k, 0.2 * k).moved(at).positions
}

fn query(scene: &mut Scene<f64>) -> Vec<Contact<f64>> {
    let mut list = ContactList::default();
    scene.query(&mut list);
    assert_every_ray_is_counted(&list);
    assert!(list.len() > 20, "{}", list.len());
    list.contacts
}

/// A scene of bodies with these numbers' poses; whether they are added at rest and moved then.
fn scene(sampling: Sampling<f64>, numbers: &[usize], at_rest: bool) -> Scene<f64> {
    let mut scene = Scene::new(1).expect("no thread is started");
    scene.set_options(DetectionOptions { sampling, ..DetectionOptions::default() });
    let mesh: Mesh<f64> = rest().mesh();
    for &number in numbers {
        let mut own = mesh.clone();
        if !at_rest {
            own.set_positions(&pose(number)).expect("finite");
        }
        let body = scene.add(own);
        scene.mesh_mut(body).expect("it was added").set_positions(&pose(number)).expect("finite");
    }
    scene
}

#[test]
fn bodies_left_out_change_nothing_for_others() {
    for sampling in SAMPLINGS {
        let numbered = |first: u32, numbers: &[usize]| -> Vec<Contact<f64>> {
            let contacts = query(&mut scene(sampling, numbers, false)).into_iter();
            let of_last = contacts.filter(|contact| contact.colliding >= first);
            let count = |body: u32| body - first;
            of_last
                .map(|contact| Contact {
                    colliding: count(contact.colliding),
                    collided: count(contact.collided),
                    // In lists of their own.
                    spread: SpreadNumber::default(),
                    ..contact
                })
                .collect()
        };
        assert_eq!(numbered(6, &[0, 1, 2, 3, 4, 5, 6, 7]), numbered(0, &[6, 7]), "{sampling:?}");
    }
}

#[test]
fn the_pose_in_which_a_body_is_added_does_not_matter() {
    for sampling in SAMPLINGS {
        let [moved, placed] = [true, false].map(|at_rest| query(&mut scene(sampling, &[0, 1, 2, 3], at_rest)));
        assert_eq!(moved, placed, "{sampling:?}");
    }
}
