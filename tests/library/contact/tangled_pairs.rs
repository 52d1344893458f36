//! Pairs of which a body is tangled cast no rays and are counted; no other pair is touched by that.

use crate::common::random::Random;
use crate::common::shapes::{self, Point, Shape};
use raycontact::contact::{ContactLaw, ContactList, DetectionOptions, Sampling};
use raycontact::escape::query_pair;
use raycontact::math::Scalar;
use raycontact::mesh::Mesh;
use raycontact::query::Octree;
use raycontact::scene::Scene;

/// The shape's mesh, with its vertices elsewhere.
fn bent<T: Scalar>(shape: &Shape, seed: u64, place: impl Fn(Point, &mut Random) -> Point) -> Mesh<T> {
    let (mut mesh, mut random) = (shape.mesh::<T>(), Random::new(seed));
    let positions: Vec<[T; 3]> = shape.positions.iter().map(|&p| place(p, &mut random).map(T::of)).collect();
    mesh.set_positions(&positions).expect("finite");
    mesh
}

/// Every vertex anywhere: every triangle is as large as the body.
fn thrown<T: Scalar>(shape: &Shape, seed: u64) -> Mesh<T> {
    bent(shape, seed, |_, random| random.point(1.0))
}

fn query<T: Scalar>(meshes: [&Mesh<T>; 2], options: DetectionOptions<T>) -> ContactList<T> {
    let [a, b] = meshes.map(Octree::new);
    let mut contacts = ContactList::default();
    query_pair(meshes[0], &a, meshes[1], &b, &options, &mut contacts).expect("new");
    contacts
}

/// Every kind of rays.
fn all_options<T: Scalar>() -> [DetectionOptions<T>; 6] {
    let default = DetectionOptions::default;
    [
        default(),
        DetectionOptions { escape: false, ..default() },
        DetectionOptions { law: ContactLaw::RayLength, ..default() },
        DetectionOptions { sampling: Sampling::Vertices, ..default() },
        DetectionOptions { sampling: Sampling::Accuracy(T::of(0.03)), ..default() },
        DetectionOptions { sampling: Sampling::Spacing(T::of(0.1)), ..default() },
    ]
}

fn broken_bodies_cast_no_rays<T: Scalar>() {
    for [around, across] in [[14, 8], [30, 16], [90, 50]] {
        let torus = shapes::torus(around, across, 0.4);
        let beside = torus.moved([0.6, 0.1, 0.0]).mesh::<T>();
        let [first, second] = [1, 2].map(|seed| thrown::<T>(&torus, seed));
        for (number, options) in all_options::<T>().into_iter().enumerate() {
            for (name, pair) in
                [("both", [&first, &second]), ("first", [&first, &beside]), ("second", [&beside, &first])]
            {
                let list = query(pair, options);
                let counts = list.statistics;
                let found = [counts.tangled_pairs, counts.rays, counts.estimate_rays, list.len() as u64];
                assert_eq!(found, [1, 0, 0, 0], "{} triangles, options {number}, {name}", 2 * around * across);
            }
        }
    }
}

/// 16 832 rays of two bodies of 224 triangles each met all triangles before, 522 times an ordinary step; of 9800 a query took
/// more than a minute.
#[test]
fn pairs_with_a_broken_body_cast_no_rays() {
    broken_bodies_cast_no_rays::<f64>();
    broken_bodies_cast_no_rays::<f32>();
}

/// From vertices here and there to all of them by some edges, and as far apart as positions of an explosion are.
#[test]
fn half_broken_bodies_cast_few_rays() {
    let torus = shapes::torus(60, 32, 0.4);
    let spikes = [0.1, 0.3].map(|part| {
        bent::<f64>(&torus, 5, |p, random| if random.signed().abs() < part { random.point(1.0) } else { p })
    });
    // Edges are about 0.1 long.
    let rags = [0.3, 0.8].map(|by| {
        bent::<f64>(&torus, 6, |p, random| {
            let by = random.point(by);
            std::array::from_fn(|axis| p[axis] + by[axis])
        })
    });
    let explosion = bent::<f64>(&torus, 7, |_, random| random.point(1.0).map(|x| x * (10.0 * x).exp()));
    for (number, mesh) in spikes.iter().chain(&rags).chain([&explosion]).enumerate() {
        let counts = query([mesh, &torus.moved([0.5, 0.0, 0.1]).mesh()], DetectionOptions::default()).statistics;
        assert_eq!([counts.tangled_pairs, counts.rays], [1, 0], "{number}");
    }
}

/// A spike, slivers that each ray meets by the hundred, a needle that lies across, and plates that cross one another at every
/// layer: dear, but nothing of a body touches itself.
#[test]
fn what_does_not_touch_itself_is_not_tangled() {
    let torus = shapes::torus(30, 16, 0.4);
    let spike = bent::<f64>(&torus, 1, |p, _| if p == torus.positions[0] { [30.0, 0.0, 0.0] } else { p });
    let fan = shapes::fan(600);
    let needle = torus.map(|[x, y, z]| [x, 0.02 * y, 0.02 * z]);
    let plates = |turn: f64| {
        let plate = shapes::block([4, 4, 1]).map(|[x, y, z]| [0.5 * x - 1.0, 0.5 * y - 1.0, 0.01 * z - 0.96]);
        let all = (1..24).fold(plate.clone(), |all, k| all.joined(&plate.moved([0.0, 0.0, 0.08 * f64::from(k)])));
        all.turned(0.0, turn)
    };
    let pairs = [
        [spike, torus.moved([0.5, 0.0, 0.1]).mesh()],
        [fan.mesh(), fan.turned(0.3, 0.2).moved([0.1, 0.05, 0.1]).mesh()],
        [needle.turned(0.7, 0.6).mesh(), needle.turned(0.72, 0.58).moved([0.01, 0.0, 0.0]).mesh()],
        [plates(0.0).mesh(), plates(1.5).mesh()],
    ];
    for (number, [a, b]) in pairs.iter().enumerate() {
        for options in all_options() {
            let counts = query([a, b], options).statistics;
            assert!(counts.tangled_pairs == 0 && counts.rays > 0, "{number}: {counts:?}");
        }
    }
}

/// Bodies of parts that overlap one another anywhere. Their triangles touch as often as those of garbage, but fold nowhere: of
/// the tori and balls two pairs in three had no contacts, of boxes three in four.
#[test]
fn parts_that_overlap_keep_their_contacts() {
    let parts = [
        (12, shapes::torus(24, 12, 0.3)),
        (60, shapes::sphere(2).scaled(0.3)),
        (30, shapes::block([1, 1, 1]).scaled(0.4)),
        (40, shapes::block([8, 1, 1]).map(|p| [0.2 * p[0] - 0.8, 0.02 * p[1], 0.02 * p[2]])),
    ];
    for (count, part) in &parts {
        let mut random = Random::new(*count);
        let mut body = || {
            let mut place = || {
                let [turn, tilt, _] = random.point(3.0);
                part.turned(turn, tilt).moved(random.point(0.5))
            };
            (1..*count).fold(place(), |all, _| all.joined(&place())).mesh::<f64>()
        };
        for number in 0..4 {
            let list = query([&body(), &body()], DetectionOptions::paper());
            assert!(list.statistics.tangled_pairs == 0 && !list.is_empty(), "{count} parts, {number}");
        }
    }
}

/// Ten broken bodies among two that are whole: these keep their contacts, on any number of threads and with self-collision.
#[test]
fn a_heap_of_broken_bodies_leaves_others_alone() {
    let torus = shapes::torus(30, 16, 0.4);
    let found = [1, 2].map(|threads| {
        let mut scene = Scene::<f64>::new(threads).expect("the threads start");
        let whole = [0.0, 0.6].map(|x| scene.add(torus.moved([x, 0.1, 0.0]).mesh()));
        let mut expected = ContactList::default();
        scene.query(&mut expected);
        assert!(!expected.is_empty());
        let broken: Vec<u32> = (0..10).map(|_| scene.add(torus.mesh())).collect();
        for &body in whole.iter().chain(&broken) {
            scene.set_self_collision(body, true).expect("it was added");
        }
        let mut list = ContactList::default();
        for step in 0..3 {
            for (seed, &body) in (step * 10..).zip(&broken) {
                let positions =
                    thrown::<f64>(&torus, seed).positions().iter().map(|&p| p.into()).collect::<Vec<[f64; 3]>>();
                scene.mesh_mut(body).expect("it was added").set_positions(&positions).expect("finite");
            }
            scene.query(&mut list);
            scene.advance(1.0 / 60.0).expect("a time");
            let counts = list.statistics;
            assert_eq!([counts.pairs, counts.tangled_pairs, counts.tangled_bodies], [66, 65, 10]);
            assert_eq!(list.contacts, expected.contacts);
        }
        list.contacts
    });
    assert_eq!(found[0], found[1]);
}

/// A pair that was broken for a step is like one that has just met.
#[test]
fn a_pair_that_is_whole_again_is_as_before() {
    let (outer, inner) = (shapes::torus(30, 16, 0.4), shapes::torus(30, 16, 0.3).scaled(0.3).moved([1.0, 0.0, 0.0]));
    let mut scene = Scene::<f64>::new(1).expect("no threads are needed");
    let body = [&outer, &inner].map(|shape| scene.add(shape.mesh()))[0];
    let (mut before, mut after) = (ContactList::default(), ContactList::default());
    scene.query(&mut before);
    let set = |scene: &mut Scene<f64>, points: &[Point]| {
        scene.mesh_mut(body).expect("it was added").set_positions(points).expect("finite");
    };
    let broken: Vec<Point> = thrown::<f64>(&outer, 3).positions().iter().map(|&p| p.into()).collect();
    set(&mut scene, &broken);
    scene.query(&mut after);
    assert_eq!((after.len(), after.statistics.tangled_pairs, after.statistics.escaping_pairs), (0, 1, 0));
    set(&mut scene, &outer.positions);
    scene.query(&mut after);
    assert!(after.contacts == before.contacts && after.statistics == before.statistics && !after.is_empty());
}
