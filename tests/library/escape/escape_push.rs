//! Escaping pairs: what is told of them is the sum of their contacts, and bodies without any stiffness of their own that are
//! pushed evenly by it keep their shape and leave.

use crate::common::shapes;
use raycontact::contact::{ContactKind, ContactList};
use raycontact::force::{PenaltyLaw, Weighting, add_forces};
use raycontact::math::Vector3;
use raycontact::scene::Scene;

type Field = [Vec<Vector3<f64>>; 2];

/// A ball swallowed by a block, both finely cut.
fn swallowed() -> (Scene<f64>, Field) {
    let mut scene = Scene::new(1).expect("no threads are needed");
    let bodies = [shapes::cube(4), shapes::sphere(1).scaled(0.4).moved([0.1, 0.2, 0.3])];
    let meshes = bodies.map(|body| body.moved([0.5, -1.5, 2.0]).mesh());
    let positions = meshes.each_ref().map(|mesh| mesh.positions().to_vec());
    for mesh in meshes {
        scene.add(mesh);
    }
    (scene, positions)
}

fn query(scene: &mut Scene<f64>, positions: &Field, contacts: &mut ContactList<f64>) {
    for (body, positions) in positions.iter().enumerate() {
        let mesh = scene.mesh_mut(body as u32).expect("it was added");
        mesh.set_positions_with(positions.len(), |vertex| positions[vertex]).expect("finite");
    }
    scene.query(contacts);
}

fn zeros(field: &Field) -> Field {
    field.each_ref().map(|body| vec![Vector3::zeros(); body.len()])
}

fn total(field: &Field, body: usize) -> Vector3<f64> {
    field[body].iter().sum()
}

#[test]
fn a_push_is_the_sum_of_its_contacts() {
    let (mut scene, positions) = swallowed();
    let mut contacts = ContactList::default();
    query(&mut scene, &positions, &mut contacts);
    assert!(contacts.len() > 20);
    assert!(contacts.contacts.iter().all(|contact| contact.kind == ContactKind::Escape));
    let [push] = contacts.pushes() else { panic!("{:?}", contacts.pushes()) };
    assert_eq!((push.bodies, push.contact_count as usize), ([0, 1], contacts.len()));
    assert!((push.direction.norm() - 1.0).abs() < 1e-14);
    let law = PenaltyLaw::new(7.0, 0.0, Weighting::Area).expect("a valid law");
    let mut forces = zeros(&positions);
    add_forces(&contacts, &law, None::<&[Vec<_>]>, None, &mut forces);
    let expected = push.direction * (7.0 * push.area * push.depth);
    for (body, sign) in [(0, 1.0), (1, -1.0)] {
        let sum = total(&forces, body);
        assert!((sum - expected * sign).norm() < 1e-12 * expected.norm(), "{sum:?} {expected:?}");
    }
}

/// How far edges have been drawn out or pressed together, at most: 0 for a body in its own shape.
fn distortion(scene: &Scene<f64>, rest: &Field, positions: &Field) -> f64 {
    let of_body = |body: usize| {
        let mesh = scene.mesh(body as u32).expect("it was added");
        let length = |field: &Field, [a, b]: [u32; 2]| (field[body][a as usize] - field[body][b as usize]).norm();
        let edges = mesh.topology().edges();
        edges
            .map(|edge| (length(positions, edge.vertices) / length(rest, edge.vertices) - 1.0).abs())
            .fold(0.0, f64::max)
    };
    of_body(0).max(of_body(1))
}

/// Bodies with no stiffness at all: every vertex goes where its own force takes it.
#[test]
fn bodies_without_stiffness_leave_in_their_own_shape() {
    for evenly in [true, false] {
        let (mut scene, rest) = swallowed();
        let (mut positions, mut contacts) = (rest.clone(), ContactList::default());
        let law = PenaltyLaw::new(1.0, 0.0, Weighting::Area).expect("a valid law");
        let (mut steps, mut worst) = (0, 0.0);
        loop {
            query(&mut scene, &positions, &mut contacts);
            if contacts.is_empty() || steps == 40 {
                break;
            }
            let mut forces = zeros(&rest);
            if !evenly {
                add_forces(&contacts, &law, None::<&[Vec<_>]>, None, &mut forces);
            }
            for push in contacts.pushes() {
                for (body, sign) in [(0, 1.0), (1, -1.0)] {
                    let count = rest[body].len() as f64;
                    if evenly {
                        let share = push.direction * (sign * push.area * push.depth / count);
                        forces[body].iter_mut().for_each(|force| *force += share);
                    }
                    // As mobile as moves a whole body by a fifth of the depth, and a little.
                    let mobility = 0.2 * count / push.area * (1.0 + 0.05 / push.depth);
                    positions[body].iter_mut().zip(&forces[body]).for_each(|(place, force)| *place += force * mobility);
                }
            }
            worst = distortion(&scene, &rest, &positions).max(worst);
            steps += 1;
        }
        if evenly {
            assert!(steps < 40 && worst < 1e-12, "{steps} steps, distorted by {worst}");
        } else {
            assert!(worst > 0.5, "contacts alone distort: {worst}");
        }
    }
}
