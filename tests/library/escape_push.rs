//! Escaping pairs pushed as whole bodies: the same net force as their contacts', the laws of motion, and bodies without
//! any stiffness of their own that keep their shape and leave.

use crate::common::shapes;
use raycontact::contact::{ContactKind, ContactList, EscapePush};
use raycontact::math::Vector3;
use raycontact::response::{
    PenaltyLaw, Weighting, add_differential, add_forces, add_push_differential, add_push_forces, energy, push_energy,
};
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

/// Numbers between −1 and 1 without a pattern, the same in every run.
fn noise(field: &Field, seed: f64) -> Field {
    let mut count = seed;
    field.each_ref().map(|body| {
        let one = |_: &Vector3<f64>| {
            count += 1.0;
            Vector3::from_fn(|axis, _| (count * 12.9898 + axis as f64 * 78.233).sin())
        };
        body.iter().map(one).collect()
    })
}

fn combined(a: &Field, factor: f64, b: &Field) -> Field {
    [0, 1].map(|body| a[body].iter().zip(&b[body]).map(|(a, b)| a + b * factor).collect())
}

fn dot(a: &Field, b: &Field) -> f64 {
    a.iter().zip(b).flat_map(|(a, b)| a.iter().zip(b)).map(|(a, b)| a.dot(b)).sum()
}

/// Both ways to push have the same resultant; this one gives every vertex of a body the same.
#[test]
fn a_push_is_the_sum_of_its_contacts() {
    let (mut scene, positions) = swallowed();
    let mut contacts = ContactList::default();
    query(&mut scene, &positions, &mut contacts);
    assert!(contacts.len() > 20);
    assert!(contacts.contacts.iter().all(|contact| contact.kind == ContactKind::Escape));
    let [push] = contacts.pushes() else { panic!("{:?}", contacts.pushes()) };
    assert_eq!((push.bodies, push.contact_count as usize), ([0, 1], contacts.len()));
    assert_eq!(push.vertex_counts.map(|count| count as usize), positions.each_ref().map(Vec::len));
    for weighting in [Weighting::Area, Weighting::Vertex] {
        let law = PenaltyLaw::new(7.0, 0.0, weighting).expect("a valid law");
        let whole = law.pushing_whole_bodies();
        assert_eq!([&law, &whole].map(PenaltyLaw::pushes_whole_bodies), [false, true]);
        let (mut by_contacts, mut by_push) = (zeros(&positions), zeros(&positions));
        let at_detection = None::<&Field>.map(|field| &field[..]);
        add_forces(&contacts.contacts, &law, at_detection, None, &mut by_contacts);
        add_push_forces(contacts.pushes(), &law, at_detection, None, &mut by_push);
        assert_eq!(by_push, zeros(&positions), "the law does not ask for it");
        add_push_forces(contacts.pushes(), &whole, at_detection, None, &mut by_push);
        let sums = [total(&by_contacts, 0), total(&by_push, 0)];
        assert!((sums[0] - sums[1]).norm() < 1e-12 * sums[0].norm(), "{sums:?}");
        assert!((total(&by_push, 0) + total(&by_push, 1)).norm() < 1e-12 * sums[0].norm());
        assert!(sums[0].dot(&push.direction) > 0.0);
        assert!(by_push.iter().all(|body| body.iter().all(|force| *force == body[0])));
        // Positions that are those of detection change nothing.
        let mut at_same_positions = zeros(&positions);
        add_push_forces(contacts.pushes(), &whole, Some(&positions[..]), None, &mut at_same_positions);
        let difference = total(&at_same_positions, 0) - total(&by_push, 0);
        assert!(difference.norm() < 1e-12 * sums[0].norm(), "{difference}");
        // The contacts do not push a second time.
        let mut nothing = zeros(&positions);
        add_forces(&contacts.contacts, &whole, at_detection, None, &mut nothing);
        assert_eq!(nothing, zeros(&positions));
        assert_eq!(energy(&contacts.contacts, &whole, at_detection), 0.0);
        let energies =
            [energy(&contacts.contacts, &law, at_detection), push_energy(contacts.pushes(), &whole, None::<&[Vec<_>]>)];
        assert!((energies[0] - energies[1]).abs() < 1e-12 * energies[0], "{energies:?}");
    }
}

/// force = −∂energy/∂position; differential = ∂force/∂position, exactly, since all is linear; damping likewise.
#[test]
fn forces_and_differential_are_derivatives() {
    let (mut scene, rest) = swallowed();
    let mut contacts = ContactList::default();
    query(&mut scene, &rest, &mut contacts);
    let pushes: &[EscapePush<f64>] = contacts.pushes();
    let law = PenaltyLaw::new(3.0, 0.25, Weighting::Area).expect("a valid law").pushing_whole_bodies();
    let force = |positions: &Field, velocities: &Field| {
        let mut forces = zeros(&rest);
        add_push_forces(pushes, &law, Some(positions), Some(velocities), &mut forces);
        forces
    };
    let at_rest = zeros(&rest);
    let (way, other) = (noise(&rest, 0.0), noise(&rest, 1000.0));
    let (near, far) = (combined(&rest, -0.01, &way), combined(&rest, 0.01, &way));
    let difference = push_energy(pushes, &law, Some(&far)) - push_energy(pushes, &law, Some(&near));
    let work = -0.02 * dot(&force(&rest, &at_rest), &way);
    assert!((difference - work).abs() < 1e-12, "{difference} {work}");
    for (factors, moved) in
        [([1.0, 0.0], force(&combined(&rest, 1.0, &way), &at_rest)), ([0.0, 1.0], force(&rest, &way))]
    {
        let mut differential = zeros(&rest);
        add_push_differential(pushes, &law, factors[0], factors[1], &way, &mut differential);
        let expected = combined(&moved, -1.0, &force(&rest, &at_rest));
        let error = combined(&differential, -1.0, &expected);
        assert!(dot(&error, &error) < 1e-24 * dot(&differential, &differential));
        // Symmetric and negative.
        let mut of_other = zeros(&rest);
        add_push_differential(pushes, &law, factors[0], factors[1], &other, &mut of_other);
        assert!((dot(&differential, &other) - dot(&of_other, &way)).abs() < 1e-12);
        assert!(dot(&differential, &way) < 0.0);
    }
    // Contacts of an escaping pair have no differential beside it.
    let mut nothing = zeros(&rest);
    add_differential(&contacts.contacts, &law, 1.0, 1.0, &way, &mut nothing);
    assert_eq!(nothing, zeros(&rest));
}

/// How far edges have been drawn out or pressed together, at most: 0 for a body in its own shape.
fn distortion(scene: &Scene<f64>, rest: &Field, positions: &Field) -> f64 {
    let of_body = |body: usize| {
        let mesh = scene.mesh(body as u32).expect("it was added");
        let length = |field: &Field, [a, b]: [u32; 2]| (field[body][a as usize] - field[body][b as usize]).norm();
        let edges = mesh.topology().edges().iter();
        edges
            .map(|edge| (length(positions, edge.vertices) / length(rest, edge.vertices) - 1.0).abs())
            .fold(0.0, f64::max)
    };
    of_body(0).max(of_body(1))
}

/// Bodies with no stiffness at all: every vertex goes where its own force takes it.
#[test]
fn bodies_without_stiffness_leave_in_their_own_shape() {
    for whole_bodies in [true, false] {
        let (mut scene, rest) = swallowed();
        let (mut positions, mut contacts) = (rest.clone(), ContactList::default());
        let law = PenaltyLaw::new(1.0, 0.0, Weighting::Area).expect("a valid law");
        let law = if whole_bodies { law.pushing_whole_bodies() } else { law };
        let (mut steps, mut worst) = (0, 0.0);
        loop {
            query(&mut scene, &positions, &mut contacts);
            if contacts.is_empty() || steps == 40 {
                break;
            }
            let mut forces = zeros(&rest);
            let at_detection = None::<&Field>.map(|field| &field[..]);
            add_forces(&contacts.contacts, &law, at_detection, None, &mut forces);
            add_push_forces(contacts.pushes(), &law, at_detection, None, &mut forces);
            // As mobile as moves a whole body by a fifth of the depth, and a little.
            for push in contacts.pushes() {
                let strength = law.push_coefficient(push);
                for body in 0..2 {
                    let mobility = 0.2 * f64::from(push.vertex_counts[body]) / strength * (1.0 + 0.05 / push.depth);
                    positions[body].iter_mut().zip(&forces[body]).for_each(|(place, force)| *place += force * mobility);
                }
            }
            worst = distortion(&scene, &rest, &positions).max(worst);
            steps += 1;
        }
        if whole_bodies {
            assert!(steps < 40 && worst < 1e-12, "{steps} steps, distorted by {worst}");
        } else {
            assert!(worst > 0.5, "contacts alone distort: {worst}");
        }
    }
}
