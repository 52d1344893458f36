//! The pressure law: every surface point inside the other body is pushed by its distance to that body's surface.

use crate::common::{assert_every_ray_is_counted, shapes};
use crate::support::shapes::{cuboid, icosphere, turn};
use crate::support::{Mode, Vector, net_force};
use raycontact::contact::{Contact, ContactLaw, ContactList, DetectionOptions, Sampling};
use raycontact::escape::query_pair;
use raycontact::mesh::Mesh;
use raycontact::query::{Layout, Octree};

fn contacts_of(meshes: [&Mesh<f64>; 2], layout: Layout, options: &DetectionOptions<f64>) -> ContactList<f64> {
    let octrees = meshes.map(|mesh| Octree::with_layout(mesh, layout));
    let mut contacts = ContactList::default();
    query_pair(meshes[0], &octrees[0], meshes[1], &octrees[1], options, &mut contacts).expect("octrees are new");
    assert_every_ray_is_counted(&contacts);
    contacts
}

/// Two stars, deep in one another and turned.
fn stars() -> [Mesh<f64>; 2] {
    let star = shapes::star();
    let turned = turn([1.0, 0.4, 0.2], 0.8);
    let moved = star.map(|point| (turned * Vector::from(point) + Vector::new(0.3, 0.2, 0.25)).into());
    [star.mesh(), moved.mesh()]
}

/// The judges: all triangles for the distance, the winding number for what is inside.
#[test]
fn contacts_are_all_points_inside_and_know_their_distance() {
    let meshes = stars();
    for sampling in [Sampling::default(), Sampling::Vertices, Sampling::Spacing(0.1)] {
        let options = DetectionOptions { sampling, ..DetectionOptions::default() };
        let found = contacts_of(meshes.each_ref(), Layout::Bvh, &options);
        assert!(found.len() > 20 && found.statistics.own_surface_hits == 0, "{:?}", found.statistics);
        let octrees = meshes.each_ref().map(Octree::new);
        for contact in &found.contacts {
            let other = contact.collided as usize;
            let tracer = octrees[other].tracer(&meshes[other]).expect("it is new");
            let nearest = tracer.closest_point_of_all(&contact.p1.position, f64::INFINITY).expect("it is finite");
            let distance = contact.depth * contact.cos_alpha;
            assert!((distance - nearest.distance).abs() <= 1e-14 * (1.0 + contact.depth), "{contact:?}");
            assert_eq!(tracer.winding_number(&contact.p1.position, &mut Vec::new()), Some(1));
        }
    }
    // From the vertices both cast, and those inside are known.
    let options = DetectionOptions { sampling: Sampling::Vertices, ..DetectionOptions::default() };
    let found = contacts_of(meshes.each_ref(), Layout::Bvh, &options);
    for side in [0, 1] {
        let octree = Octree::new(&meshes[1 - side]);
        let tracer = octree.tracer(&meshes[1 - side]).expect("it is new");
        let mut inside = meshes[side].positions().iter();
        let count = inside.by_ref().filter(|point| tracer.winding_number(point, &mut Vec::new()) == Some(1)).count();
        let cast = found.contacts.iter().filter(|contact| contact.colliding as usize == side).count();
        assert_eq!(cast, count, "side {side}");
    }
}

#[test]
fn both_layouts_give_the_same_contacts() {
    let meshes = stars();
    for sampling in [Sampling::default(), Sampling::Vertices] {
        for law in [ContactLaw::Pressure, ContactLaw::RayLength] {
            let options = DetectionOptions { law, sampling, ..DetectionOptions::default() };
            let [wide, classic] = [Layout::Bvh, Layout::PaperOctree].map(|layout| {
                let mut contacts = contacts_of(meshes.each_ref(), layout, &options).contacts;
                let place = |contact: &Contact<f64>| (contact.colliding, contact.p1.position.data.0);
                contacts.sort_by(|a, b| place(a).partial_cmp(&place(b)).expect("finite"));
                // The sums by which directions share the load are taken in another order.
                contacts.iter_mut().for_each(|contact| contact.area = 0.0);
                contacts
            });
            assert_eq!(wide, classic, "{options:?}");
        }
    }
}

/// Of two cubes, one set down a little beside the middle of the other, the side faces push by what they are below the top:
/// d² / 2 against the normal force (1 − s) d.
#[test]
fn a_cube_beside_the_middle_of_another_is_not_pushed_aside() {
    let lower = cuboid([-0.5; 3], [0.5; 3]).mesh(|point| *point);
    for (aside, depth) in [(0.001, 0.05), (0.01, 0.1), (0.3, 0.02)] {
        let by = Vector::new(aside, 0.0, 1.0 - depth);
        let force = |mode| {
            let upper = cuboid([-0.5; 3], [0.5; 3]).mesh(|point| point + by);
            net_force(mode, &upper, &lower, &Vector::zeros()).force
        };
        let lateral = force(Mode::Default).xy().norm() / force(Mode::Default).z;
        assert!(lateral <= 1.2 * depth / (2.0 * (1.0 - aside)), "{aside}, {depth}: {lateral}");
    }
    // The paper's law: by more than it is held up.
    let upper = cuboid([-0.5; 3], [0.5; 3]).mesh(|point| point + Vector::new(0.001, 0.0, 0.95));
    let force = net_force(Mode::RayLength, &upper, &lower, &Vector::zeros()).force;
    assert!(force.xy().norm() > force.z, "{force:?}");
}

/// A small cube inside a large one, aside of its middle: all its faces are nearest to one wall, so the force is k times its
/// volume towards that wall, in closed form.
#[test]
fn what_is_swallowed_is_pushed_to_the_nearest_wall() {
    let outer = cuboid([-1.0; 3], [1.0; 3]).mesh(|point| *point);
    for parts in [[0.6, 0.0, 0.0], [0.1, -0.65, 0.2]] {
        let by = Vector::from(parts);
        let inner = cuboid([-0.2; 3], [0.2; 3]).mesh(|point| point + by);
        let force = net_force(Mode::Default, &inner, &outer, &Vector::zeros()).force;
        let axis = by.iamax();
        // Both are as flat, so the shares go by the roots of their areas, and the outer one's sees nothing.
        let share = 2.0 / (0.4 + 2.0);
        let expected = Vector::ith(axis, share * 0.4f64.powi(3) * by[axis].signum());
        assert!((force - expected).norm() < 0.02 * expected.norm(), "{force:?}, not {expected:?}");
    }
}

/// Beside a flat body only the round one casts; of two round ones both do.
#[test]
fn the_rounder_body_carries_the_load() {
    let ball = |by: [f64; 3]| icosphere(8).mesh(|point| point + Vector::from(by));
    let slab = cuboid([-3.0, -3.0, -2.0], [3.0, 3.0, 0.0]).mesh(|point| *point);
    let from = |meshes: [&Mesh<f64>; 2], side: u32| {
        let found = contacts_of(meshes, Layout::Bvh, &DetectionOptions::default());
        found.contacts.iter().filter(|contact| contact.colliding == side).count()
    };
    let (first, second) = (ball([0.0, 0.0, 0.6]), ball([0.1, 0.0, 2.1]));
    assert!(from([&first, &slab], 0) > 50 && from([&slab, &first], 1) > 50);
    assert_eq!(from([&first, &slab], 1) + from([&slab, &first], 0), 0);
    assert!(from([&first, &second], 0) > 20 && from([&first, &second], 1) > 20);
}

/// On the surface the distance is zero, and so is the quotient's divisor.
#[test]
fn points_on_the_surface_have_finite_contacts() {
    let cube = cuboid([0.0; 3], [1.0; 3]);
    let meshes = [cube.mesh(|point| *point), cube.mesh(|point| point + Vector::new(0.25, 0.25, 0.0))];
    for sampling in [Sampling::default(), Sampling::Vertices] {
        let options = DetectionOptions { sampling, ..DetectionOptions::default() };
        for contact in &contacts_of(meshes.each_ref(), Layout::Bvh, &options).contacts {
            assert!((0.0..=1.0).contains(&contact.cos_alpha) && contact.depth >= 0.0, "{contact:?}");
        }
    }
}

/// Boxes turned any way and sunk into a slab by any depth, thinner than the spacing of their rays or not: straight up, and
/// the share of it that the box's rays carry by that share of the volume below the slab's top, as far as that is the nearest of
/// the slab's faces everywhere. The judge is the volume of the polyhedron. Where a strip of a side counted whole or not at all, the
/// force went aside by up to three quarters of itself.
#[test]
fn what_is_sunk_into_a_flat_face_is_pushed_straight_up_by_its_volume() {
    let slab = cuboid([-5.0, -5.0, -5.0], [5.0, 5.0, 0.0]).mesh(|point| *point);
    for accuracy in [0.03, 0.01, 0.003, 0.001] {
        let mut random = crate::support::random(7);
        let options = DetectionOptions { sampling: Sampling::Accuracy(accuracy), ..DetectionOptions::default() };
        let mut worst = [0f64; 2];
        let sizes = [[0.5, 0.5, 0.5], [0.5, 0.5, 0.1], [0.2, 0.7, 0.5]];
        for (number, size) in sizes.into_iter().cycle().take(60).enumerate() {
            let shape = cuboid(size.map(|x| -x), size);
            let [x, y, z] = size;
            let (area, slab_area) = (8.0 * (x * y + y * z + z * x), 400.0_f64);
            let share = slab_area.sqrt() / (f64::sqrt(area) + slab_area.sqrt());
            let axis = [random(), random(), random()];
            let turned = turn(axis, if number % 2 == 0 { 0.05 } else { 3.0 } * random());
            let depth = 0.25 * (1.0 + random()) * 0.5 + 1e-4;
            let lowest = shape.points.iter().map(|point| (turned * point).z).fold(f64::MAX, f64::min);
            let body = shape.mesh(|point| turned * point - Vector::z() * (lowest + depth));
            let found = contacts_of([&body, &slab], Layout::Bvh, &options);
            let force = |side: u32| -> Vector {
                let of_side = found.contacts.iter().filter(|contact| contact.colliding == side);
                of_side.map(|contact| contact.direction * (contact.area * contact.depth * contact.cos_alpha)).sum()
            };
            let truth = Vector::z() * (share * crate::support::limits::volume_below_zero(&body));
            worst[0] = worst[0].max((force(0) - truth).norm() / truth.norm());
            worst[1] = worst[1].max(force(1).xy().norm() / truth.norm());
        }
        println!("{accuracy}: {worst:?}");
        assert!(worst[0] < 3.5 * accuracy && worst[1] < 1e-12, "{accuracy}: {worst:?}");
    }
}

/// The net force on the first of two bodies, the sum of all forces, and how many of the contacts are of edges.
fn force_without_escape(shapes: [&shapes::Shape; 2], sampling: Sampling<f64>) -> (Vector, f64, u64) {
    let meshes = shapes.map(|shape| shape.mesh());
    let options = DetectionOptions { sampling, escape: false, ..DetectionOptions::default() };
    let found = contacts_of([&meshes[0], &meshes[1]], Layout::Bvh, &options);
    let push = |contact: &Contact<f64>| {
        let push = contact.direction * (contact.area * contact.depth * contact.cos_alpha);
        if contact.colliding == 0 { push } else { -push }
    };
    let all = found.contacts.iter().map(|contact| push(contact).norm()).sum();
    (found.contacts.iter().map(push).sum(), all, found.statistics.edge_contacts)
}

/// Bars with sharp edges, one edge d deep across the other. Within an edge with half the angle a between its faces, a point
/// below the other edge by s is (d − s) sin a deep in its middle and 0 where it comes out, (d − s) tan a to either side. So the
/// pressure on both faces, upward and integrated, is 2/3 d³ tan² a sin a for edges at right angles, and more by 1 / sin ψ where
/// they cross at the angle ψ. Either body carries a half of it. Vertices find nothing there, so their edges do.
#[test]
fn edges_across_edges_push_by_the_integral_of_the_pressure() {
    let mut of_edges = 0;
    for (half_angle, cells, turn) in [20.0f64, 30.0, 45.0, 60.0, 70.0].into_iter().flat_map(|half_angle| {
        let cells = [[1, 1, 1], [4, 2, 2], [16, 6, 6]].into_iter();
        cells.flat_map(move |cells| [90.0f64, 50.0].map(|turn| (half_angle.to_radians(), cells, turn.to_radians())))
    }) {
        // The edge above lies on the axis x.
        let bar = shapes::block(cells).map(|point| {
            let [x, y, z]: [f64; 3] = std::array::from_fn(|axis| point[axis] / cells[axis] as f64 - 1.0);
            [2.0 * x + 1.0, 0.7 * half_angle.sin() * (y - z), 0.7 * half_angle.cos() * (y + z)]
        });
        for depth in [1e-2, 1e-3, 1e-4, 1e-6] {
            let upper = bar.map(|[x, y, z]| [x, -y, -z]).turned(turn, 0.0).moved([0.013, 0.027, -depth]);
            let expected = 2.0 / 3.0 * depth.powi(3) * half_angle.tan().powi(2) * half_angle.sin() / turn.sin();
            for (sampling, tolerance) in [(Sampling::default(), 0.02), (Sampling::Vertices, 0.1)] {
                let (force, _, edge_contacts) = force_without_escape([&upper, &bar], sampling);
                // Where a vertex lies inside, it stands for much more than that.
                if sampling == Sampling::Vertices && edge_contacts == 0 {
                    continue;
                }
                let error = (force - Vector::z() * expected).norm() / expected;
                assert!(error < tolerance, "{half_angle} {cells:?} {turn} {depth}: {error}, {edge_contacts} edges");
                of_edges += usize::from(edge_contacts > 0);
            }
        }
    }
    assert!(of_edges > 5, "{of_edges}");
}

/// A ball through a thin plate, nearly up to its middle and beyond: samples that follow the load give the force in closed form;
/// where no ray starts inside, as from vertices, edges do not push by more than twice that. Before, the plate's diagonals, which
/// lie in its faces, pushed 1300 times as much.
#[test]
fn edges_across_a_thin_plate_push_no_more_than_the_pressure() {
    const THICKNESS: f64 = 0.02;
    let ball = shapes::sphere(3).scaled(0.5);
    let plate = shapes::cube(1).map(|[x, y, z]| [x, y, 0.5 * THICKNESS * z]);
    // Of a smooth ball that reaches so deep below the plate's top.
    let exact = |depth: f64| {
        let at = |k: u32| (f64::from(k) + 0.5) / 2000.0 * THICKNESS;
        let ring = |s: f64| s.min(THICKNESS - s) * std::f64::consts::PI * (1.0 - 2.0 * (depth - s));
        (0..2000).map(|k| ring(at(k))).sum::<f64>() / 2000.0 * THICKNESS
    };
    let mut of_edges = 0;
    for k in 0..400 {
        let depth = 0.05 + f64::from(k) / 400.0 * 0.9;
        let moved = ball.moved([0.013, 0.007, 0.5 * THICKNESS + 0.5 - depth]);
        for sampling in [Sampling::default(), Sampling::Vertices] {
            let (force, all, edge_contacts) = force_without_escape([&moved, &plate], sampling);
            let error = (force.z - exact(depth)).abs();
            // Of a shell near the ball's widest ring little is left upward, and the ball has flat faces.
            let most = match sampling {
                Sampling::Vertices if edge_contacts > 0 => exact(depth).abs() + 0.02 * exact(0.25),
                Sampling::Vertices => f64::INFINITY,
                _ => 0.03 * all,
            };
            assert!(error < most, "{depth}, {sampling:?}: off by {error} of {}", exact(depth));
            of_edges += usize::from(edge_contacts > 0);
        }
    }
    assert!(of_edges > 5, "{of_edges}");
}
