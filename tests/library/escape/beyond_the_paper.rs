//! Overlaps that the paper's two filters leave open: edge across edge, one body inside another, bodies in the same
//! place; and that ordinary contacts do not set off what resolves them.

use crate::common::STRIDE;
use crate::common::assert_every_ray_is_counted;
use crate::common::cuboid::CUBOID_FACES;
use crate::common::shapes;
use raycontact::contact::{ContactKind, ContactLaw, ContactList, DetectionOptions, Sampling};
use raycontact::escape::query_pair;
use raycontact::math::Vector3;
use raycontact::mesh::Mesh;
use raycontact::query::Octree;
use raycontact::scene::Scene;

/// The box of these half sides around `centre`.
fn cuboid(half: [f64; 3], centre: [f64; 3]) -> Vec<[f64; 3]> {
    let corner = |i: usize, axis: usize| if i >> axis & 1 == 1 { half[axis] } else { -half[axis] };
    (0..8).map(|i| std::array::from_fn(|axis| centre[axis] + corner(i, axis))).collect()
}

fn moved(positions: &[[f64; 3]], by: &Vector3<f64>) -> Vec<[f64; 3]> {
    positions.iter().map(|p| std::array::from_fn(|axis| p[axis] + by[axis])).collect()
}

fn contacts_of(a: &[[f64; 3]], b: &[[f64; 3]], options: &DetectionOptions<f64>) -> ContactList<f64> {
    let meshes = [a, b].map(|positions| Mesh::new(positions, &CUBOID_FACES).expect("a box is closed"));
    let octrees = [Octree::new(&meshes[0]), Octree::new(&meshes[1])];
    let mut contacts = ContactList::default();
    query_pair(&meshes[0], &octrees[0], &meshes[1], &octrees[1], options, &mut contacts).expect("octrees are new");
    contacts
}

/// Two bars across one another: no vertex of either is inside the other, and with rays from vertices nothing is found.
#[test]
fn bars_crossing_with_no_vertex_inside_give_edge_contacts() {
    let (a, b) = (cuboid([1.0, 0.1, 0.1], [0.0; 3]), cuboid([0.11, 1.0, 0.12], [0.02, 0.0, 0.15]));
    assert!(contacts_of(&a, &b, &DetectionOptions::paper()).is_empty());
    let options = DetectionOptions { edges: true, ..DetectionOptions::paper() };
    let found = contacts_of(&a, &b, &options);
    assert!(!found.is_empty());
    let counts = &found.statistics;
    assert_eq!(counts.edge_contacts, found.len() as u64);
    assert_every_ray_is_counted(&found);
    // Each leaves through the other's surface: p2 lies on it, beyond p1 along the ray.
    for contact in &found.contacts {
        assert_eq!(contact.kind, ContactKind::Edge);
        assert!(contact.depth > 0.0 && contact.cos_alpha > 0.0);
        let end = contact.p1.position + contact.direction * contact.depth;
        assert!((end - contact.p2.position).norm() < 1e-12);
    }
}

/// A plate aslant, so thin that some rays from its edges leave it before the other body: the paper's second filter. No
/// contact leads out of the plate.
#[test]
fn rays_from_edges_stay_in_their_own_body() {
    let plate = cuboid([1.0, 0.1, 0.02], [0.0; 3]).into_iter().map(|[x, y, z]| [x, y - z, y + z]).collect::<Vec<_>>();
    let bar = cuboid([0.11, 1.0, 0.15], [0.02, 0.0, -0.1]);
    let options = DetectionOptions { edges: true, ..DetectionOptions::paper() };
    let found = contacts_of(&plate, &bar, &options);
    for contact in found.contacts.iter().filter(|contact| contact.colliding == 0) {
        let end = contact.p2.position;
        let [across, along] = [end.y + end.z, end.z - end.y].map(|twice| twice.abs() / 2.0);
        assert!(across < 0.1 + 1e-12 && along < 0.02 + 1e-12, "{contact:?}");
    }
    assert!(found.statistics.own_surface_hits > 0);
}

/// Bars moved past one another in small steps: whenever their surfaces cross (for boxes along the axes: whenever the
/// boxes overlap, as none can contain the other), at least one contact is reported, with any sampling.
#[test]
fn crossing_surfaces_never_go_unreported() {
    let a = cuboid([1.0, 0.11, 0.13], [0.0; 3]);
    for sampling in [Sampling::Vertices, Sampling::default(), Sampling::Spacing(0.2)] {
        let options = DetectionOptions { sampling, ..DetectionOptions::default() };
        for step in (0..400).step_by(STRIDE) {
            let along = f64::from(step) / 400.0;
            let centre = [2.4 * along - 1.2, 0.9 * (7.0 * along).sin(), 0.4 * (11.0 * along).cos()];
            let b = cuboid([0.17, 0.7, 0.19], centre);
            let overlap = (0..3).all(|axis| centre[axis].abs() < [1.17, 0.81, 0.32][axis]);
            let found = contacts_of(&a, &b, &options);
            assert_eq!(!found.is_empty(), overlap, "{sampling:?}, centre {centre:?}");
            assert_every_ray_is_counted(&found);
        }
    }
}

/// Moves the first body along its net force until no contact is left; gives the steps.
fn steps_until_apart(a: &[[f64; 3]], b: &[[f64; 3]], longest: usize) -> Option<usize> {
    let mut scene = Scene::new(1).expect("no threads are needed");
    let mesh = |positions: &[[f64; 3]]| Mesh::new(positions, &CUBOID_FACES).expect("a box is closed");
    let (first, _) = (scene.add(mesh(a)), scene.add(mesh(b)));
    let (mut contacts, mut offset) = (ContactList::default(), Vector3::zeros());
    for step in 0..longest {
        scene.mesh_mut(first).expect("it was added").set_positions(&moved(a, &offset)).expect("finite");
        scene.query(&mut contacts);
        assert_every_ray_is_counted(&contacts);
        if contacts.is_empty() {
            return Some(step);
        }
        let (mut push, mut weight) = (Vector3::zeros(), 0.0);
        for contact in &contacts.contacts {
            let sign = if contact.colliding == first { 1.0 } else { -1.0 };
            push += contact.direction * (sign * contact.depth * contact.area);
            weight += contact.area;
        }
        offset += push / weight * 1.05;
    }
    None
}

#[test]
fn a_swallowed_body_leaves_and_stays_out() {
    let outer = cuboid([1.0; 3], [0.0; 3]);
    for centre in [[0.0; 3], [0.3, -0.2, 0.5], [-0.7, 0.7, 0.0]] {
        let inner = cuboid([0.2; 3], centre);
        assert!(steps_until_apart(&inner, &outer, 100).is_some(), "inner body at {centre:?}");
        assert!(steps_until_apart(&outer, &inner, 100).is_some(), "outer body moved, inner at {centre:?}");
    }
}

#[test]
fn bodies_in_the_same_place_part() {
    let body = cuboid([0.5, 0.6, 0.7], [0.1, 0.2, 0.3]);
    assert!(steps_until_apart(&body, &body, 100).is_some());
}

/// A body pressed into a floor by a constant depth, for many steps: its contacts do not get fewer, but they push one
/// way, so it is a load and not a jam.
#[test]
fn a_loaded_contact_at_rest_does_not_escape() {
    let (floor, body) = (cuboid([5.0, 5.0, 1.0], [0.0; 3]), cuboid([0.5; 3], [0.3, 0.2, 1.48]));
    let mut scene = Scene::new(1).expect("no threads are needed");
    let mesh = |positions: &[[f64; 3]]| Mesh::new(positions, &CUBOID_FACES).expect("a box is closed");
    let (_, resting) = (scene.add(mesh(&floor)), scene.add(mesh(&body)));
    let mut contacts = ContactList::default();
    for step in 0..100 {
        let sway = Vector3::new(0.0, 0.0, 0.002 * f64::from(step).sin());
        scene.mesh_mut(resting).expect("it was added").set_positions(&moved(&body, &sway)).expect("finite");
        scene.query(&mut contacts);
        assert_every_ray_is_counted(&contacts);
        assert!(contacts.len() > 50);
        assert_eq!(contacts.statistics.escaping_pairs, 0, "step {step}");
    }
}

/// Beside a sharp edge, here of 41°, rays leave their own body before the floor: that belongs to ordinary contact.
#[test]
fn a_sharp_edge_pressed_into_a_floor_does_not_escape() {
    let mut scene = Scene::new(1).expect("no threads are needed");
    scene.add(Mesh::new(&cuboid([5.0, 5.0, 1.0], [0.0; 3]), &CUBOID_FACES).expect("a box is closed"));
    let wedge = shapes::tetrahedron().map(|[x, y, z]| [x, y, 1.9 * z]).moved([0.3, 0.2, 2.85]);
    let body = scene.add(wedge.mesh());
    let mut contacts = ContactList::default();
    for step in 0..100 {
        let sway = Vector3::new(0.0, 0.0, 0.002 * f64::from(step).sin());
        scene.mesh_mut(body).expect("it was added").set_positions(&moved(&wedge.positions, &sway)).expect("finite");
        scene.query(&mut contacts);
        assert_every_ray_is_counted(&contacts);
        assert!(contacts.len() > 10, "{:?}", contacts.statistics);
        let by_rays = DetectionOptions { law: ContactLaw::RayLength, ..DetectionOptions::default() };
        scene.set_options(by_rays);
        scene.query(&mut contacts);
        assert!(contacts.statistics.own_surface_hits > 0, "{:?}", contacts.statistics);
        scene.set_options(DetectionOptions::default());
        assert_eq!(contacts.statistics.escaping_pairs, 0, "step {step}");
    }
}

/// On narrow spikes: their flanks push them from all sides, and upward a little. Whichever body comes first, and however the
/// whole is turned.
#[test]
fn a_body_that_stands_on_its_spikes_does_not_escape() {
    for (half_width, turn) in [(0.12, 0.0), (0.12, 0.7), (0.2, 0.0), (0.2, 2.1), (0.28, 0.0)] {
        for order in [[0, 1], [1, 0]] {
            let floor = shapes::cube(1).map(|[x, y, z]| [5.0 * x, 5.0 * y, z - 1.0]).turned(turn, turn);
            let spikes = shapes::spikes(half_width);
            let mut scene = Scene::new(1).expect("no threads are needed");
            let bodies = order.map(|which| scene.add([&floor, &spikes][which].mesh()));
            let mut contacts = ContactList::default();
            for step in 0..100 {
                let standing = spikes.moved([0.0, 0.0, 0.002 * f64::from(step).sin() - 0.02]).turned(turn, turn);
                let body = bodies[order[1]];
                let mesh = scene.mesh_mut(body).expect("it was added");
                mesh.set_positions(&standing.positions).expect("finite");
                scene.query(&mut contacts);
                assert_every_ray_is_counted(&contacts);
                assert!(contacts.len() > 10, "{:?}", contacts.statistics);
                assert_eq!(contacts.statistics.escaping_pairs, 0, "{half_width}, {turn}, {order:?}, step {step}");
            }
        }
    }
}

/// Switched off, bodies in the same place do not escape, however long they stay.
#[test]
fn bodies_that_contacts_cannot_part_stay_where_escapes_are_off() {
    let body = cuboid([0.5, 0.6, 0.7], [0.1, 0.2, 0.3]);
    for escape in [true, false] {
        let mut scene = Scene::new(1).expect("no threads are needed");
        scene.set_options(DetectionOptions { escape, ..DetectionOptions::default() });
        for _ in 0..2 {
            scene.add(Mesh::new(&body, &CUBOID_FACES).expect("a box is closed"));
        }
        let (mut contacts, mut started) = (ContactList::default(), 0);
        for _ in 0..40 {
            scene.query(&mut contacts);
            assert_every_ray_is_counted(&contacts);
            scene.advance(1.0 / 60.0).expect("a length");
            started += contacts.statistics.escapes_started;
        }
        assert_eq!(started, u64::from(escape));
    }
}

/// Switched off, nothing escapes; and what a pair remembers goes when the bodies are apart.
#[test]
fn escapes_are_counted_and_can_be_forbidden() {
    let (inner, outer) = (cuboid([0.2; 3], [0.1, 0.0, 0.0]), cuboid([1.0; 3], [0.0; 3]));
    let mut scene = Scene::new(1).expect("no threads are needed");
    let mesh = |positions: &[[f64; 3]]| Mesh::new(positions, &CUBOID_FACES).expect("a box is closed");
    let (first, _) = (scene.add(mesh(&inner)), scene.add(mesh(&outer)));
    let mut contacts = ContactList::default();
    // Under the paper's law nothing pushes what is swallowed.
    let by_rays = DetectionOptions { law: ContactLaw::RayLength, ..DetectionOptions::default() };
    let counts = |contacts: &ContactList<f64>| {
        (contacts.statistics.escapes_started, contacts.statistics.escaping_pairs, contacts.statistics.escape_contacts)
    };
    scene.set_options(DetectionOptions { escape: false, ..by_rays });
    scene.query(&mut contacts);
    assert_eq!((contacts.len(), counts(&contacts)), (0, (0, 0, 0)));

    scene.set_options(by_rays);
    scene.query(&mut contacts);
    let all = contacts.len() as u64;
    assert!(all > 0);
    assert_eq!(counts(&contacts), (1, 1, all));
    assert!(contacts.contacts.iter().all(|contact| contact.kind == ContactKind::Escape));
    let away = contacts.contacts[0].direction;
    scene.advance(1.0 / 60.0).expect("a length");
    scene.query(&mut contacts);
    assert_eq!(counts(&contacts), (0, 1, all));
    assert_eq!(contacts.contacts[0].direction, away);

    let far = moved(&inner, &Vector3::new(0.0, 0.0, 3.0));
    scene.mesh_mut(first).expect("it was added").set_positions(&far).expect("finite");
    scene.query(&mut contacts);
    scene.advance(1.0 / 60.0).expect("a length");
    scene.mesh_mut(first).expect("it was added").set_positions(&inner).expect("finite");
    scene.query(&mut contacts);
    assert_eq!(counts(&contacts), (1, 1, all), "the pair had forgotten its escape");
}

/// A box in a slab that is thin across one of the 26 directions: the way out leads across, whichever body is the first.
#[test]
fn an_escape_takes_the_shortest_way() {
    let directions = (0..27).filter(|&i| i != 13).map(|i: i32| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1].map(f64::from));
    // Under the paper's law nothing else pushes what is swallowed.
    let (law, sampling) = (ContactLaw::RayLength, Sampling::Vertices);
    let options = DetectionOptions { law, sampling, ..DetectionOptions::default() };
    for direction in directions {
        let across = Vector3::from(direction).normalize();
        let along = across.cross(&Vector3::ith((across.iamax() + 1) % 3, 1.0)).normalize();
        let third = across.cross(&along);
        let turned = |[x, y, z]: [f64; 3]| <[f64; 3]>::from(across * x + along * y + third * z);
        let slab = cuboid([1.0, 3.0, 3.0], [0.0; 3]).into_iter().map(turned).collect::<Vec<_>>();
        let middle = across * 0.8 + along * 1.5;
        let inner = cuboid([0.1; 3], middle.into());
        // From the corner that lies deepest.
        let depth = 1.0 - 0.8 + 0.1 * across.abs().sum();
        for (a, b, sign) in [(&inner, &slab, 1.0), (&slab, &inner, -1.0)] {
            let found = contacts_of(a, b, &options);
            let [push] = found.pushes() else { panic!("{} pushes along {across}", found.pushes().len()) };
            assert!((push.direction - across * sign).norm() < 1e-12, "{} for {across}", push.direction);
            assert!((push.depth - depth).abs() < 1e-12);
            // Half of the box's surface: either body carries a half of the load.
            assert!((push.area - 0.5 * 6.0 * 0.2 * 0.2).abs() < 1e-12, "{}", push.area);
            let counts = &found.statistics;
            assert_eq!((counts.escapes_started, counts.escaping_pairs, counts.escape_contacts), (1, 1, 8));
            let before = contacts_of(a, b, &DetectionOptions { escape: false, ..options }).statistics.rays;
            assert_eq!(counts.rays, before + 8, "a ray from each corner inside");
        }
    }
}

/// A box within two others that overlap: some rays out of them enter the second before they leave the first. The box is inside
/// all the same, and leaves the same way whichever body comes first and wherever the second lies.
#[test]
fn what_parts_that_overlap_have_swallowed_escapes_in_any_order() {
    let joined = |second: [f64; 3]| {
        let mut positions = cuboid([1.0, 1.1, 1.2], [0.0; 3]);
        positions.extend(cuboid([0.6; 3], second));
        let faces = CUBOID_FACES.into_iter().chain(CUBOID_FACES.map(|face| face.map(|vertex| vertex + 8)));
        Mesh::new(&positions, &faces.collect::<Vec<_>>()).expect("two boxes are closed")
    };
    let options = DetectionOptions { law: ContactLaw::RayLength, ..DetectionOptions::default() };
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let mut second = [0.0; 3];
            second[axis] = sign;
            let inner = Mesh::new(&cuboid([0.2; 3], [0.01, 0.02, 0.03]), &CUBOID_FACES).expect("a box is closed");
            let meshes = [inner, joined(second)];
            let octrees = meshes.each_ref().map(Octree::new);
            let [way, back] = [[0, 1], [1, 0]].map(|[a, b]| {
                let mut found = ContactList::default();
                let [a, b] = [a, b].map(|body: usize| (&meshes[body], &octrees[body]));
                query_pair(a.0, a.1, b.0, b.1, &options, &mut found).expect("octrees are new");
                let [push] = found.pushes() else { panic!("{} pushes, second at {second:?}", found.pushes().len()) };
                assert_every_ray_is_counted(&found);
                *push
            });
            assert_eq!((way.direction, way.depth), (-back.direction, back.depth), "second at {second:?}");
        }
    }
}

/// Bars through each other's middles hold each other; they part across, as far as both are thick, by rays from their edges
/// alone, as no vertex lies inside.
#[test]
fn bars_that_hold_each_other_part_by_their_edges() {
    let (a, b) = (cuboid([1.0, 0.2, 0.1], [0.0; 3]), cuboid([0.3, 1.0, 0.12], [0.0; 3]));
    let mut scene = Scene::new(1).expect("no threads are needed");
    scene.set_options(DetectionOptions { sampling: Sampling::Vertices, ..DetectionOptions::default() });
    for positions in [&a, &b] {
        scene.add(Mesh::new(positions, &CUBOID_FACES).expect("a box is closed"));
    }
    let mut contacts = ContactList::default();
    scene.query(&mut contacts);
    assert_eq!(contacts.statistics.escapes_started, 1);
    scene.advance(1.0 / 60.0).expect("a length");
    scene.query(&mut contacts);
    let [push] = contacts.pushes() else { panic!("{} pushes", contacts.pushes().len()) };
    assert_eq!(push.direction.abs(), Vector3::z());
    assert!((push.depth - 0.22).abs() < 1e-12);
    let counts = &contacts.statistics;
    assert_eq!((counts.rays, counts.escape_contacts), (contacts.len() as u64, contacts.len() as u64));
    assert_eq!((counts.escapes_started, counts.escaping_pairs), (0, 1));
    // Four edges of the thinner pass through the other; diagonals lie within faces and are none.
    assert_eq!(contacts.len(), 4);
}

/// A ball in the hole of a ring lies within the ring's box, and outside the ring.
#[test]
fn what_lies_in_a_hole_is_not_swallowed() {
    let (ring, ball) = (shapes::torus(24, 12, 0.4), shapes::sphere(1).scaled(0.3));
    for (a, b) in [(&ring, &ball), (&ball, &ring)] {
        let meshes = [a.mesh(), b.mesh()];
        let octrees = [Octree::new(&meshes[0]), Octree::new(&meshes[1])];
        let (mut found, options) = (ContactList::default(), DetectionOptions::<f64>::default());
        query_pair(&meshes[0], &octrees[0], &meshes[1], &octrees[1], &options, &mut found).expect("octrees are new");
        assert_eq!((found.len(), found.statistics.pairs, found.statistics.escapes_started), (0, 1, 0));
    }
}

/// A body that had contacts which pushed one way escapes as soon as it is swallowed whole, under the paper's law: nothing
/// else pushes it then.
#[test]
fn what_is_pushed_in_at_a_stroke_escapes_at_once() {
    let (block, body) = (cuboid([1.0; 3], [0.0; 3]), cuboid([0.2; 3], [0.0, 0.0, 1.1]));
    let mut scene = Scene::new(1).expect("no threads are needed");
    scene.set_options(DetectionOptions { law: ContactLaw::RayLength, ..DetectionOptions::default() });
    let mesh = |positions: &[[f64; 3]]| Mesh::new(positions, &CUBOID_FACES).expect("a box is closed");
    let (_, pushed) = (scene.add(mesh(&block)), scene.add(mesh(&body)));
    let mut contacts = ContactList::default();
    for _ in 0..3 {
        scene.query(&mut contacts);
        assert_every_ray_is_counted(&contacts);
        assert!(!contacts.is_empty() && contacts.statistics.escaping_pairs == 0);
    }
    let inside = moved(&body, &Vector3::new(0.0, 0.0, -0.6));
    scene.mesh_mut(pushed).expect("it was added").set_positions(&inside).expect("finite");
    scene.query(&mut contacts);
    assert_eq!(contacts.statistics.escapes_started, 1);
}
