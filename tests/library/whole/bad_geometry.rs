//! Geometry as bad as it comes: every answer is defined (a status, a miss, finite numbers), and comes.

use crate::common::shapes::{self, Point, Shape};
use raycontact::contact::{ContactList, DetectionOptions};
use raycontact::escape::query_pair;
use raycontact::math::{Scalar, Vector3};
use raycontact::mesh::{Mesh, MeshError};
use raycontact::query::{Layout, Octree};
use raycontact::triangle::{Ray, TriangleTest};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

const LAYOUTS: [Layout; 2] = [Layout::Bvh, Layout::PaperOctree];

/// Fails instead of hanging. What runs here takes a few seconds in a debug build.
fn must_end(work: impl FnOnce() + Send + 'static) {
    let (sender, receiver) = channel();
    let worker = std::thread::spawn(move || {
        work();
        // The test may have given up meanwhile.
        let _ = sender.send(());
    });
    match receiver.recv_timeout(Duration::from_secs(60)) {
        Err(RecvTimeoutError::Timeout) => panic!("still running after a minute"),
        Ok(()) | Err(RecvTimeoutError::Disconnected) => {
            if let Err(panic) = worker.join() {
                std::panic::resume_unwind(panic);
            }
        }
    }
}

/// Rays of every kind, good and bad, from inside, from vertices and from afar.
fn rays<T: Scalar>(mesh: &Mesh<T>) -> Vec<Ray<T>> {
    let positions = mesh.positions();
    let directions = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [1.0, 1.0, 0.0], [0.3, -0.2, 0.9], [-1e-30, 1.0, 1e-30]];
    let mut rays: Vec<Ray<T>> = Vec::new();
    for origin in [Vector3::zeros(), positions[0], Vector3::new(T::of(1e30), T::one(), T::zero())] {
        rays.extend(directions.map(|direction| Ray::new(origin, Vector3::from(direction.map(T::of)))));
        rays.extend(positions.iter().take(20).map(|&target| Ray::new(origin, target - origin)));
    }
    rays
}

/// Every question to the octrees of `mesh`: no hang, no panic, finite answers, and with `exact` the same from all.
fn question<T: Scalar>(mesh: &Mesh<T>, exact: bool) {
    for layout in LAYOUTS {
        let octree = Octree::with_layout(mesh, layout);
        if exact {
            octree.validate(mesh).expect("the octree is whole");
        }
        let tracer = octree.tracer(mesh).expect("the octree is fresh");
        let (rays, mut hits, mut found, mut crossings) = (rays(mesh), Vec::new(), Vec::new(), Vec::new());
        tracer.nearest_hits(&rays, &mut hits);
        tracer.leave_before_end(&rays, &vec![[0; 3]; rays.len()], &mut found);
        for (ray, hit) in rays.iter().zip(&hits) {
            if let Some(hit) = hit {
                assert!(hit.t.is_finite() && hit.t >= T::zero(), "{ray:?}: {hit:?}");
                assert!(hit.weights.iter().all(|w| (0.0..=1.0).contains(&w.to_f64())), "{ray:?}: {hit:?}");
            }
            tracer.crossings(ray, &mut crossings);
            if exact {
                assert_eq!(*hit, tracer.nearest_hit_of_all(ray), "{layout:?}, {ray:?}");
                assert_eq!(*hit, tracer.nearest_hit(ray), "{layout:?}, {ray:?}");
            }
            tracer.with_test(TriangleTest::MollerTrumbore).nearest_hit(ray);
        }
    }
}

/// The contacts of a bad mesh with a good one, and with itself, are finite numbers.
fn collide<T: Scalar>(bad: &Mesh<T>, options: DetectionOptions<T>) {
    let good = shapes::torus(8, 6, 0.4).mesh::<T>();
    let octrees = [bad, &good].map(Octree::new);
    for (a, b) in [(0, 1), (1, 0), (0, 0)] {
        let mesh = |i: usize| if i == 0 { bad } else { &good };
        let mut list = ContactList::default();
        query_pair(mesh(a), &octrees[a], mesh(b), &octrees[b], &options, &mut list).expect("fresh octrees");
        for contact in &list.contacts {
            assert!(contact.depth.is_finite() && contact.depth >= T::zero(), "{contact:?}");
            assert!(contact.area.is_finite() && contact.area >= T::zero(), "{contact:?}");
            assert!((0.0..=1.0).contains(&contact.cos_alpha.to_f64()), "{contact:?}");
            assert!(contact.direction.iter().all(|x| x.is_finite()), "{contact:?}");
        }
    }
}

/// A good mesh, brought to bad positions.
fn deformed<T: Scalar>(shape: &Shape, map: impl Fn(Point) -> Point) -> Mesh<T> {
    let mut mesh = shape.mesh::<T>();
    mesh.set_positions(&shape.map(map).rounded()).expect("positions are finite");
    mesh
}

/// A good shape, and where its points go.
type Deformation = (Shape, fn(Point) -> Point);

fn without_area() -> Vec<Deformation> {
    vec![
        (shapes::sphere(1), |[x, y, _]| [x, y, 0.0]),
        (shapes::sphere(1), |[x, _, _]| [x, 0.5 * x, 0.25 * x]),
        (shapes::sphere(1), |_| [0.5, 0.25, 0.125]),
        // Some only: one half pressed flat.
        (shapes::cube(3), |[x, y, z]| [x, y, z.max(0.0)]),
    ]
}

/// Neighbours fall upon one another.
fn with_duplicate_vertices() -> Vec<Deformation> {
    vec![
        (shapes::torus(12, 6, 0.4), |point| point.map(|x| (x * 3.0).round() / 3.0)),
        (shapes::sphere(1), |point| point.map(|x| (x * 2.0).round() / 2.0)),
    ]
}

fn with_slivers() -> Vec<Deformation> {
    vec![
        (shapes::sphere(1), |[x, y, z]| [x + y, y + z, (x + 2.0 * y + z) * (1.0 + 1e-14 * x)]),
        (shapes::cube(3), |[x, y, z]| [x, y * 1e-12, z * 1e12]),
        (shapes::torus(12, 6, 0.4), |[x, y, z]| [x + 1e7 * y, y, z + 1e3 * x]),
    ]
}

fn denormal() -> Vec<Deformation> {
    vec![
        (shapes::sphere(1), |point| point.map(|x| x * 1e-40)),
        (shapes::sphere(1), |point| point.map(|x| x * 1e-310)),
        (shapes::cube(3), |[x, y, z]| [x, y * 1e-42, z * 5e-324]),
        (shapes::star(), |[x, y, z]| [x * 1e-20, y * 1e-30, z]),
    ]
}

fn huge() -> Vec<Deformation> {
    vec![
        (shapes::sphere(1), |point| point.map(|x| x * 1e30)),
        (shapes::torus(12, 6, 0.4), |[x, y, z]| [if x > 0.0 { 1e30 } else { -1e30 }, y, z]),
        (shapes::cube(3), |[x, y, z]| [x * 1e30, y * 1e-30, z]),
        (shapes::star(), |[x, y, z]| if x + y + z > 1.0 { [1e30, -1e30, 1e30] } else { [x, y, z] }),
    ]
}

fn check_rays(deformations: Vec<Deformation>, exact: bool) {
    must_end(move || {
        for (shape, map) in deformations {
            question(&deformed::<f64>(&shape, map), exact);
            question(&deformed::<f32>(&shape, map), exact);
        }
    });
}

fn check_contacts(deformations: Vec<Deformation>, paper: bool) {
    must_end(move || {
        for (shape, map) in deformations {
            let (double, single) = (deformed::<f64>(&shape, map), deformed::<f32>(&shape, map));
            collide(&double, if paper { DetectionOptions::paper() } else { DetectionOptions::default() });
            collide(&single, if paper { DetectionOptions::paper() } else { DetectionOptions::default() });
        }
    });
}

#[test]
fn rays_to_triangles_without_area() {
    check_rays(without_area(), true);
}

#[test]
fn rays_to_duplicate_vertices() {
    check_rays(with_duplicate_vertices(), true);
}

#[test]
fn rays_to_slivers() {
    check_rays(with_slivers(), true);
}

/// Products of such coordinates lose digits, or all, below the smallest number: hits may then be missed and layouts
/// differ, but all ends well.
#[test]
fn rays_to_denormal_coordinates() {
    check_rays(denormal(), false);
}

#[test]
fn rays_to_coordinates_of_1e30() {
    check_rays(huge(), false);
}

#[test]
fn contacts_by_rays_from_vertices() {
    for deformations in [without_area(), with_duplicate_vertices(), with_slivers(), denormal(), huge()] {
        check_contacts(deformations, true);
    }
}

#[test]
fn contacts_by_rays_from_faces() {
    for deformations in [without_area(), with_duplicate_vertices()] {
        check_contacts(deformations, false);
    }
}

/// Triangles that are long beside the overlap are cut into pieces, but only so often.
#[test]
fn contacts_of_needles_by_rays_from_faces() {
    for deformations in [with_slivers(), denormal(), huge()] {
        check_contacts(deformations, false);
    }
}

/// A long bar whose end reaches 2⁻³⁰ deep into a wall: pieces of the overlap's size would be without number.
#[test]
fn pieces_left_uncut_are_counted() {
    must_end(|| {
        let wall = shapes::cube(1).mesh::<f64>();
        let octree = Octree::new(&wall);
        let mut list = ContactList::default();
        for (depth, is_counted) in [(0.25, false), (1.0 / 1_073_741_824.0, true)] {
            let bar = deformed::<f64>(&shapes::cube(1), |[x, y, z]| [x + 2.0 - depth, 1e-9 * (y + 0.3), z]);
            query_pair(&wall, &octree, &bar, &Octree::new(&bar), &DetectionOptions::default(), &mut list)
                .expect("fresh octrees");
            crate::common::assert_every_ray_is_counted(&list);
            assert_eq!(list.statistics.uncut_pieces > 0, is_counted, "{:?}", list.statistics);
            assert!(list.statistics.rays < 40_000, "{:?}", list.statistics);
        }
    });
}

/// In f64 there is room: 1e30 is nothing special.
#[test]
fn f64_is_exact_at_1e30() {
    must_end(|| question(&deformed::<f64>(&shapes::sphere(1), |point| point.map(|x| x * 1e30)), true));
}

#[test]
fn the_ends_of_the_range() {
    for size in [1e38, 1e300, 1.7e308] {
        must_end(move || {
            let shape = shapes::octahedron();
            if size < 3.4e38 {
                let mesh = deformed::<f32>(&shape, |point| point.map(|x| x * size));
                question(&mesh, false);
                collide(&mesh, DetectionOptions::paper());
            }
            let mesh = deformed::<f64>(&shape, |point| point.map(|x| x * size));
            question(&mesh, false);
            collide(&mesh, DetectionOptions::paper());
        });
    }
}

#[test]
fn one_tetrahedron() {
    fn check<T: Scalar>() {
        let mesh = shapes::tetrahedron().mesh::<T>();
        question(&mesh, true);
        collide(&mesh, DetectionOptions::default());
        for layout in LAYOUTS {
            let octree = Octree::with_layout(&mesh, layout);
            let tracer = octree.tracer(&mesh).expect("the octree is fresh");
            let hit = tracer.nearest_hit(&Ray::new(Vector3::zeros(), Vector3::new(1.0, 1.0, 1.0).map(T::of)));
            assert_eq!(hit.expect("a vertex lies ahead").t, T::one(), "to the vertex");
        }
    }
    must_end(check::<f64>);
    must_end(check::<f32>);
}

#[test]
fn rays_without_a_direction_meet_nothing() {
    fn check<T: Scalar>() {
        let mesh = shapes::cube(2).mesh::<T>();
        let (nan, infinity) = (T::INFINITY - T::INFINITY, T::INFINITY);
        let zero = T::zero();
        let bad = [nan, infinity, -infinity, zero];
        let mut directions = vec![Vector3::zeros(), Vector3::repeat(-zero)];
        for number in bad.into_iter().filter(|number| !number.is_zero()) {
            for place in 0..3 {
                for other in [T::one(), zero, -infinity] {
                    let mut direction = Vector3::repeat(other);
                    direction[place] = number;
                    directions.push(direction);
                }
            }
        }
        for layout in LAYOUTS {
            let octree = Octree::with_layout(&mesh, layout);
            let tracer = octree.tracer(&mesh).expect("the octree is fresh");
            for &direction in &directions {
                for t_max in [infinity, T::one(), nan] {
                    let ray = Ray::new(Vector3::new(0.1, 0.2, 0.3).map(T::of), direction).until(t_max);
                    expect_nothing(&tracer, &ray);
                }
            }
            // And good directions from no place, or to no end.
            for number in [nan, infinity, -infinity] {
                expect_nothing(&tracer, &Ray::new(Vector3::new(number, zero, zero), Vector3::x()));
                expect_nothing(&tracer, &Ray::new(Vector3::new(zero, number, zero), Vector3::x()));
            }
            expect_nothing(&tracer, &Ray::new(Vector3::zeros(), Vector3::x()).until(nan));
            expect_nothing(&tracer, &Ray::new(Vector3::zeros(), Vector3::x()).until(-T::one()));
        }
    }
    must_end(check::<f64>);
    must_end(check::<f32>);
}

fn expect_nothing<T: Scalar>(tracer: &raycontact::query::Tracer<'_, T>, ray: &Ray<T>) {
    let (mut hits, mut found, mut crossings) = (Vec::new(), Vec::new(), Vec::new());
    for test in [TriangleTest::Watertight, TriangleTest::MollerTrumbore] {
        let tracer = tracer.with_test(test);
        assert_eq!(tracer.nearest_hit(ray), None, "{ray:?}, {test:?}");
        assert_eq!(tracer.nearest_hit_of_all(ray), None, "{ray:?}, {test:?}");
        tracer.nearest_hits(&[*ray; 20], &mut hits);
        assert!(hits.iter().all(Option::is_none), "{ray:?}, {test:?}");
        tracer.leave_before_end(&[*ray; 20], &[[0; 3]; 20], &mut found);
        assert!(!found.contains(&true), "{ray:?}, {test:?}");
        tracer.crossings(ray, &mut crossings);
        assert!(crossings.is_empty(), "{ray:?}, {test:?}");
    }
}

#[test]
fn bad_meshes_are_refused_and_bad_positions_change_nothing() {
    let mut mesh = shapes::cube(1).mesh::<f64>();
    let before = mesh.positions().to_vec();
    for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut positions: Vec<Point> = before.iter().map(|&position| position.into()).collect();
        positions[5][1] = number;
        assert_eq!(mesh.set_positions(&positions), Err(MeshError::NotFinite { vertex: 5, is_renewal: true }));
        assert_eq!(mesh.positions(), before);
    }
    assert_eq!(mesh.set_positions(&[[0.0; 3]; 3]), Err(MeshError::WrongCount { given: 3, expected: 8 }));
    let flat = shapes::cube(1).map(|[x, y, _]| [x, y, 0.0]);
    assert!(matches!(flat.try_mesh::<f64>(), Err(MeshError::DegenerateTriangle { .. })));
    let inward = shapes::cube(1).map(|point| point.map(|x| -x));
    assert!(matches!(inward.try_mesh::<f64>(), Err(MeshError::Inward { .. })));
}
