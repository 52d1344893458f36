//! Garbage through the C interface: every call ends soon, with a status that is its own, and what is accepted gives numbers
//! that are defined. The counts are those of docs/reliability.md.

mod common;

use common::c::*;
use common::random::Random;
use common::shapes::{self, Point, Shape};
use raycontact::capi::{rayc_contact, rayc_status};
use std::collections::BTreeMap;

/// What became of the tries, printed for the table in docs/reliability.md.
#[derive(Default)]
struct Outcomes(BTreeMap<String, usize>);

impl Outcomes {
    fn count(&mut self, outcome: impl std::fmt::Debug) {
        *self.0.entry(format!("{outcome:?}")).or_default() += 1;
    }

    fn print(&self, what: &str) {
        println!("{what}: {} tries, {:?}", self.0.values().sum::<usize>(), self.0);
    }
}

/// Numbers at which arithmetic has its ends.
const ODD_NUMBERS: [f64; 14] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN,
    f32::MAX as f64,
    f32::MIN as f64,
    f64::MIN_POSITIVE,
    5e-324,
    -5e-324,
    1e-40,
    1e300,
    0.0,
    -0.0,
];

/// What holds for every contact of surfaces whose sizes do not overflow.
fn check_contact(contact: &rayc_contact) {
    let depths = [contact.depth, contact.cos_alpha, contact.area];
    let weights = contact.p1.weights.iter().chain(&contact.p2.weights);
    assert!(depths.iter().chain(weights).all(|x| !x.is_nan()), "depth, cosine, area: {depths:?}");
    assert!(contact.depth >= 0.0 && (0.0..=1.0 + 1e-6).contains(&contact.cos_alpha), "{depths:?}");
}

/// A scene of `shape` and a sound body, both also touching themselves, whose first body takes `positions` and then its own
/// again. Gives the status of the first, and holds that the last step is as if nothing had been.
fn step_and_back(shape: &Shape, positions: &[Point], precision: u32) -> rayc_status {
    let make = |shape: &Shape| Mesh::new(precision, false, &vectors(&shape.positions), &shape.triangles);
    let sound = shapes::octahedron().moved([0.7, 0.2, 0.1]);
    let (mut scene, mut contacts) = (Scene::new(precision, 1).expect("no threads"), Contacts::new());
    for shape in [shape, &sound] {
        let body = scene.add(&make(shape).expect("it was sound")).expect("the same precision");
        scene.set_self_collision(body);
    }
    let status = scene.set_positions(0, positions);
    assert_eq!(scene.query(&mut contacts), RAYC_STATUS_OK);
    contacts.all().iter().for_each(check_contact);
    assert_eq!(scene.set_positions(0, &shape.positions), RAYC_STATUS_OK);
    assert_eq!(scene.query(&mut contacts), RAYC_STATUS_OK);
    contacts.all().iter().for_each(check_contact);
    status
}

#[test]
fn odd_numbers_at_creation_and_in_a_step() {
    let (mut created, mut renewed) = (Outcomes::default(), Outcomes::default());
    let shape = shapes::octahedron();
    for (number, precision) in ODD_NUMBERS.iter().flat_map(|&number| [(number, 32), (number, 64)]) {
        for (vertex, axis) in (0..shape.positions.len()).flat_map(|vertex| (0..3).map(move |axis| (vertex, axis))) {
            let mut odd = shape.clone();
            odd.positions[vertex][axis] = number;
            let mesh = Mesh::new(precision, false, &vectors(&odd.positions), &odd.triangles);
            created.count(mesh.as_ref().map_or_else(|status| *status, |_| RAYC_STATUS_OK));
            let expected = match number {
                _ if !number.is_finite() => RAYC_STATUS_NOT_FINITE,
                _ if precision == 32 && !(number as f32).is_finite() => RAYC_STATUS_MESH_BEYOND_RANGE,
                _ => RAYC_STATUS_OK,
            };
            let refused = mesh.err();
            match expected {
                // It may be what no closed surface is, but it is finite.
                RAYC_STATUS_OK => assert_ne!(refused, Some(RAYC_STATUS_NOT_FINITE), "{number:e} in {precision} bits"),
                _ => assert_eq!(refused, Some(expected), "{number:e} in {precision} bits"),
            }
            if axis == 0 || common::STRIDE == 1 {
                let status = step_and_back(&shape, &odd.positions, precision);
                assert_eq!(status, expected, "{number:e} in {precision} bits");
                renewed.count(status);
            }
        }
    }
    created.print("one odd coordinate at creation");
    renewed.print("one odd coordinate in a step");
}

#[test]
fn bodies_that_collapse_turn_inside_out_or_explode() {
    type Map = fn(Point, usize) -> Point;
    let maps: [(&str, Map); 9] = [
        ("all vertices equal", |_, _| [0.5, 0.4, 0.3]),
        ("all on a line", |[x, ..], _| [x, 0.1, 0.1]),
        ("all in a plane", |[x, y, _], _| [x, y, 0.1]),
        ("turned inside out", |[x, y, z], _| [-x, y, z]),
        ("half turned inside out", |[x, y, z], _| [x.abs(), y, z]),
        ("thrown about", |_, vertex| Random::new(vertex as u64).point(1.0)),
        ("exploded", |_, vertex| Random::new(vertex as u64).point(1e30)),
        ("exploded to the end of f32", |_, vertex| Random::new(vertex as u64).point(f64::from(f32::MAX))),
        ("shrunk to denormals", |point, _| point.map(|x| x * 1e-44)),
    ];
    for (name, map) in maps {
        let mut outcomes = Outcomes::default();
        for shape in [shapes::octahedron(), shapes::cube(2), shapes::star(), shapes::torus(8, 5, 0.4)] {
            for precision in [32, 64] {
                let positions: Vec<Point> = shape.positions.iter().enumerate().map(|(v, &p)| map(p, v)).collect();
                let status = step_and_back(&shape, &positions, precision);
                assert_eq!(status, RAYC_STATUS_OK, "{name}: the numbers are finite");
                outcomes.count(status);
                let mesh = Mesh::new(precision, false, &vectors(&positions), &shape.triangles);
                outcomes.count(mesh.as_ref().map_or_else(|status| *status, |_| RAYC_STATUS_OK));
            }
        }
        outcomes.print(name);
    }
}

#[test]
fn triangles_of_random_numbers() {
    let mut outcomes = Outcomes::default();
    let mut random = Random::new(1);
    let positions = shapes::cube(2).positions;
    for _ in 0..20_000 {
        let mut index = || ((random.signed() + 1.0) * 14.0) as u32;
        let count = index() as usize % 9;
        let triangles: Vec<[u32; 3]> = (0..count).map(|_| [index(), index(), index()]).collect();
        let open = index() % 2 == 0;
        match Mesh::new(64, open, &vectors(&positions), &triangles) {
            Ok(mesh) => {
                outcomes.count(RAYC_STATUS_OK);
                let octree = Octree::new(&mesh).expect("memory");
                let mut contacts = Contacts::new();
                assert_eq!(contacts.query_pair((&mesh, &octree), (&mesh, &octree)), RAYC_STATUS_OK);
            }
            Err(status) => outcomes.count(status),
        }
    }
    outcomes.print("triangles of random numbers");
    assert!(outcomes.0.len() >= 6, "{:?}", outcomes.0);
}

/// From creation to contacts with a sound body, by both ways of asking.
fn whole_step(shape: &Shape) {
    let sound = shapes::octahedron().moved([0.7, 0.2, 0.1]);
    let mut meshes =
        [shape, &sound].map(|s| Mesh::new(64, false, &vectors(&s.positions), &s.triangles).expect("a closed surface"));
    let mut octrees = meshes.each_ref().map(|mesh| Octree::new(mesh).expect("memory"));
    let mut contacts = Contacts::new();
    assert_eq!(meshes[0].set_positions(&shape.turned(0.1, 0.2).positions), RAYC_STATUS_OK);
    assert_eq!(octrees[0].update(&meshes[0]), RAYC_STATUS_OK);
    let [a, b] = [0, 1].map(|k| (&meshes[k], &octrees[k]));
    assert_eq!(contacts.query_pair(a, b), RAYC_STATUS_OK);
    contacts.all().iter().for_each(check_contact);
    assert!(!contacts.all().is_empty(), "{} triangles", shape.triangles.len());
}

#[test]
fn a_fan_of_slivers() {
    for count in [3, 30, 300, 3000] {
        whole_step(&shapes::fan(count));
    }
}

/// Minutes: cargo test --release --test c_garbage -- --ignored
#[test]
#[ignore = "takes gigabytes and minutes"]
fn large_meshes() {
    for count in [10_000, 100_000, 500_000] {
        let start = std::time::Instant::now();
        whole_step(&shapes::fan(count));
        println!("fan of {} slivers: {:.1} s", 2 * count, start.elapsed().as_secs_f64());
    }
    for side in [100, 707, 2236] {
        let start = std::time::Instant::now();
        let shape = shapes::torus(side, side, 0.4);
        whole_step(&shape);
        println!("torus of {} triangles: {:.1} s", shape.triangles.len(), start.elapsed().as_secs_f64());
    }
}
