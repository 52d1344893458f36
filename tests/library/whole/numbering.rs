//! Net force and torque do not depend on how triangles, their corners, vertices and bodies are numbered.

use crate::common::assert_every_ray_is_counted;
use crate::common::random::Random;
use crate::common::shapes::{self, Point, Shape};
use raycontact::contact::{ContactLaw, ContactList, DetectionOptions, Sampling};
use raycontact::escape::query_pair;
use raycontact::math::Vector3;
use raycontact::query::Octree;
use raycontact::scene::Scene;

/// A permutation of 0, …, count − 1.
fn permutation(count: usize, random: &mut Random) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    for place in (1..count).rev() {
        let other = ((random.signed() + 1.0) / 2.0 * (place + 1) as f64) as usize;
        order.swap(place, other);
    }
    order
}

/// The same surface with other numbers.
fn renumbered(shape: &Shape, random: &mut Random) -> Shape {
    let old_of = permutation(shape.positions.len(), random);
    let mut new_of = vec![0; old_of.len()];
    old_of.iter().enumerate().for_each(|(new, &old)| new_of[old] = new as u32);
    let positions = old_of.iter().map(|&old| shape.positions[old]).collect();
    let triangle = |old: usize| {
        let mut corners = shape.triangles[old].map(|vertex| new_of[vertex as usize]);
        corners.rotate_left(((random.signed() + 1.0) * 1.5) as usize);
        corners
    };
    let triangles = permutation(shape.triangles.len(), &mut Random::new(old_of[0] as u64)).into_iter().map(triangle);
    Shape { triangles: triangles.collect(), positions, inside: Vec::new() }
}

/// Net force on the body of this number and its torque about the origin, for unit stiffness; and the sum of all forces'
/// sizes.
fn load(contacts: &ContactList<f64>, body: u32) -> ([Vector3<f64>; 2], f64) {
    assert_every_ray_is_counted(contacts);
    let (mut force, mut torque, mut sum) = (Vector3::zeros(), Vector3::zeros(), 0.0);
    for contact in &contacts.contacts {
        let push = contact.direction * (contact.area * contact.depth * contact.cos_alpha);
        let push = if contact.colliding == body { push } else { -push };
        force += push;
        torque += contact.p1.position.cross(&push);
        sum += push.norm();
    }
    ([force, torque], sum)
}

fn pair_contacts(shapes: &[Shape; 2], options: &DetectionOptions<f64>) -> ContactList<f64> {
    let [a, b] = shapes.each_ref().map(Shape::mesh::<f64>);
    let octrees = [Octree::new(&a), Octree::new(&b)];
    let mut list = ContactList::default();
    query_pair(&a, &octrees[0], &b, &octrees[1], options, &mut list).expect("the octrees are new");
    list
}

/// The contacts of a scene that stands still, after so many steps.
fn scene_contacts(shapes: &[Shape; 2], options: &DetectionOptions<f64>, steps: usize) -> ContactList<f64> {
    let mut scene = Scene::new(1).expect("no thread is started");
    scene.set_options(*options);
    shapes.iter().for_each(|shape| {
        scene.add(shape.mesh());
    });
    let mut list = ContactList::default();
    for _ in 0..steps {
        scene.query(&mut list);
        scene.advance(1.0 / 60.0).expect("a length");
    }
    list
}

/// The same shape turned and moved, on no grid.
fn placed(shape: Shape, random: &mut Random, reach: f64) -> Shape {
    let (about_z, about_x) = (3.0 * random.signed(), 3.0 * random.signed());
    shape.turned(about_z, about_x).moved(random.point(reach))
}

fn stretched(shape: Shape, by: Point) -> Shape {
    shape.map(|point| std::array::from_fn(|axis| point[axis] * by[axis]))
}

/// A body of parts that overlap one another.
fn clump(random: &mut Random) -> Shape {
    let parts = [shapes::torus(12, 6, 0.4), shapes::sphere(1), shapes::cube(1), shapes::star()];
    let part = |shape: &Shape, random: &mut Random| {
        let by = [0; 3].map(|_| 0.35 + 0.2 * random.signed());
        placed(stretched(shape.clone(), by), random, 0.3)
    };
    let first = part(&parts[0], random);
    parts[1..].iter().fold(first, |clump, next| clump.joined(&part(next, random)))
}

/// Deep pairs: turned at random, swallowed, in the middle of one another, and copies moved along an axis, whose rays meet
/// edges and faces exactly. Not copies in one and the same place: every point of one lies on the other there, and rounding
/// decides whether it is inside.
fn pairs() -> Vec<(String, [Shape; 2])> {
    let mut random = Random::new(7);
    type Kind = (&'static str, fn() -> Shape);
    let kinds: [Kind; 8] = [
        ("torus", || shapes::torus(20, 10, 0.4)),
        ("ball", || shapes::sphere(2)),
        ("star", shapes::star),
        ("cube", || shapes::cube(1).scaled(0.8)),
        ("plate", || stretched(shapes::cube(3), [1.0, 0.8, 0.05])),
        ("bar", || stretched(shapes::cube(2), [0.2, 1.2, 0.3])),
        ("tetrahedron", shapes::tetrahedron),
        ("two balls", || shapes::sphere(1).scaled(0.5).joined(&shapes::sphere(1).scaled(0.4).moved([0.8, 0.1, 0.2]))),
    ];
    let mut found = Vec::new();
    for (i, (first, first_shape)) in kinds.iter().enumerate() {
        for (second, second_shape) in &kinds[i..] {
            let shapes = [placed(first_shape(), &mut random, 0.1), placed(second_shape(), &mut random, 0.3)];
            found.push((format!("{first}, {second}"), shapes));
        }
    }
    for (name, shape) in kinds {
        found.push((format!("{name}, swallowed"), [shapes::cube(1).scaled(3.0), shape().moved([0.3, 0.2, 0.1])]));
        found.push((format!("{name}, in the middle"), [shapes::cube(1).scaled(3.0), shape()]));
        found.push((format!("{name}, its copy moved along an axis"), [shape(), shape().moved([0.25, 0.0, 0.0])]));
    }
    found
}

/// How long each pair is asked: in a query of its own, and in a scene that has tried for some steps.
const STEPS: [usize; 3] = [0, 1, 20];

/// Deep pairs of bodies whose parts overlap.
fn clumps() -> Vec<(String, [Shape; 2])> {
    let mut random = Random::new(17);
    let mut pair = |number: usize| {
        let shapes = [0.1, 0.3].map(|reach| {
            let clump = clump(&mut random);
            placed(clump, &mut random, reach)
        });
        (format!("clumps {number}"), shapes)
    };
    (0..24).map(&mut pair).collect()
}

fn check(sampling: Sampling<f64>) {
    check_pairs(pairs(), DetectionOptions { sampling, ..DetectionOptions::default() });
}

fn check_pairs(pairs: Vec<(String, [Shape; 2])>, options: DetectionOptions<f64>) {
    let mut random = Random::new(11);
    let (mut wrong, mut escapes, mut worst) = (Vec::new(), 0, 0.0f64);
    for (name, shapes) in pairs {
        for steps in STEPS {
            let contacts = |shapes: &[Shape; 2]| match steps {
                0 => pair_contacts(shapes, &options),
                _ => scene_contacts(shapes, &options, steps),
            };
            let expected_contacts = contacts(&shapes);
            escapes += expected_contacts.statistics.escaping_pairs;
            let (expected, sum) = load(&expected_contacts, 0);
            for (number, swapped) in [false, false, true, true].into_iter().enumerate() {
                let mut other = shapes.each_ref().map(|shape| renumbered(shape, &mut random));
                if swapped {
                    other.reverse();
                }
                let (found, _) = load(&contacts(&other), u32::from(swapped));
                let error = (0..2).fold(0.0f64, |worst, i| worst.max((found[i] - expected[i]).norm()));
                worst = worst.max(error / sum.max(f64::MIN_POSITIVE));
                // Edges that lie in the other's faces push by rounding alone, 1.6e-31 in all, of which no part can be asked for: a
                // strip is as wide as its edge is deep, so this is the square of a depth of 1e-16.
                if error > 1e-6 * sum && sum > 1e-20 {
                    wrong.push(format!("{name}, {steps} steps, {number}: {} of {sum}", error));
                }
            }
        }
    }
    assert!(escapes > 10, "{escapes}");
    assert!(wrong.is_empty(), "{} wrong: {wrong:#?}", wrong.len());
    println!("largest difference of force or torque, as a part of all forces: {worst:.1e}");
}

#[test]
fn numbers_do_not_matter_to_force_and_torque() {
    check(Sampling::default());
}

#[test]
fn numbers_do_not_matter_where_rays_start_from_vertices() {
    check(Sampling::Vertices);
}

#[test]
fn numbers_do_not_matter_where_rays_stand_for_patches() {
    check(Sampling::Spacing(0.3));
    check(Sampling::Accuracy(0.05));
}

/// Which points are inside, and where a body's border is, does not depend on the direction of the ray that tells it, though it
/// may enter another part first, or pass a sharp edge.
#[test]
fn numbers_do_not_matter_to_bodies_whose_parts_overlap() {
    for sampling in [Sampling::default(), Sampling::Vertices] {
        for past_folds in [false, true] {
            check_pairs(clumps(), DetectionOptions { sampling, past_folds, ..DetectionOptions::default() });
        }
    }
}

/// A ray may leave its own body and the other through faces in one plane.
#[test]
fn numbers_do_not_matter_to_the_law_of_ray_lengths() {
    for sampling in [Sampling::default(), Sampling::Spacing(0.3)] {
        let options = DetectionOptions { law: ContactLaw::RayLength, sampling, ..DetectionOptions::default() };
        check_pairs(pairs(), options);
    }
}
