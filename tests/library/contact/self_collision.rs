//! Contacts of a body with itself: against two bodies in place of two lobes, against a closed form, and with every ray
//! cast.

use crate::common::STRIDE;
use crate::common::ends::{Offset, ends};
use crate::common::random::Random;
use crate::common::shapes::{self, Point, Shape};
use raycontact::contact::{ContactList, DetectionOptions, Sampling, Statistics, query_self, query_self_with_all_rays};
use raycontact::escape::query_pair;
use raycontact::force::{PenaltyLaw, Weighting, add_forces};
use raycontact::math::{Scalar, Vector3};
use raycontact::mesh::Mesh;
use raycontact::query::{Layout, Octree};
use raycontact::scene::Scene;
use std::collections::HashMap;

/// The contacts, which must be those that every ray would find, in either layout.
fn own_contacts<T: Scalar>(shape: &Shape, options: &DetectionOptions<T>) -> ContactList<T> {
    let mesh = shape.mesh::<T>();
    let mut all = ContactList::default();
    query_self_with_all_rays(&mesh, &Octree::new(&mesh), options, &mut all).expect("the octree is new");
    for layout in [Layout::PaperOctree, Layout::Bvh] {
        let mut culled = ContactList::default();
        let octree = Octree::with_layout(&mesh, layout);
        query_self(&mesh, &octree, options, &mut culled).expect("the octree is new");
        assert_eq!(culled.contacts, all.contacts, "{layout:?}");
        assert_eq!(culled.statistics.own_surface_hits, all.statistics.own_surface_hits, "{layout:?}");
        assert_balanced(&culled);
    }
    assert!(all.contacts.iter().all(|contact| (contact.colliding, contact.collided) == (0, 0)));
    assert_balanced(&all);
    all
}

/// Every ray is a contact, or counted under the reason why it is none.
fn assert_balanced<T: Scalar>(contacts: &ContactList<T>) {
    let counts = &contacts.statistics;
    assert_eq!(counts.rays, counts.misses + counts.own_surface_hits + counts.self_contacts);
    assert_eq!(counts.self_contacts, contacts.len() as u64);
}

/// The judge for two lobes: the same as two bodies of their own. Gives how many contacts there are.
fn assert_same_as_pair<T: Scalar>(a: &Shape, b: &Shape, sampling: Sampling<T>) -> usize {
    let options = DetectionOptions { sampling, ..DetectionOptions::paper() };
    let own = own_contacts(&a.joined(b), &options);
    let meshes = [a.mesh::<T>(), b.mesh::<T>()];
    let octrees = [Octree::new(&meshes[0]), Octree::new(&meshes[1])];
    let mut pair = ContactList::default();
    query_pair(&meshes[0], &octrees[0], &meshes[1], &octrees[1], &options, &mut pair).expect("the octrees are new");
    let second = Offset { triangle: a.triangles.len() as u32, vertex: a.positions.len() as u32 };
    let offset = |body: u32| if body == 0 { Offset::default() } else { second };
    let mut expected: Vec<_> =
        pair.contacts.iter().map(|c| ends(c, [offset(c.colliding), offset(c.collided)])).collect();
    let mut found: Vec<_> = own.contacts.iter().map(|contact| ends(contact, [Offset::default(); 2])).collect();
    // A body alone is gone through in the order of its triangles, a pair in that of its octrees and patches.
    for all in [&mut found, &mut expected] {
        all.sort_by(|a, b| {
            (a.triangles, a.weights).partial_cmp(&(b.triangles, b.weights)).expect("weights are finite")
        });
    }
    assert_eq!(found, expected);
    found.len()
}

#[test]
fn two_lobes_touch_as_two_bodies_do() {
    let mut touching = 0;
    for step in (0..240).step_by(STRIDE) {
        let mut random = Random::new(step);
        let tube = 0.1 + 0.15 * (1.0 + random.signed());
        let a = shapes::torus(16, 8, 0.4);
        let b = match step % 3 {
            0 => shapes::torus(16, 8, tube),
            1 => shapes::sphere(2),
            // A plate through the ring's tube: rays leave it through its own far side.
            _ => shapes::sphere(1).map(|[x, y, z]| [1.6 * x, 1.6 * y, 0.3 * z]),
        };
        let b = b.turned(3.0 * random.signed(), 3.0 * random.signed()).moved(random.point(1.0));
        // A spacing that joins no triangles: contacts of a body with itself know no patches.
        let count = match step / 3 % 3 {
            0 => assert_same_as_pair::<f64>(&a, &b, Sampling::Vertices),
            1 => assert_same_as_pair::<f64>(&a, &b, Sampling::Spacing(0.1)),
            _ => assert_same_as_pair::<f32>(&a, &b, Sampling::Spacing(0.1)),
        };
        touching += usize::from(count > 0);
    }
    assert!(touching > 160 / STRIDE);
}

/// Two prongs on a base, of unit cubes; the second is pushed over until it is `depth` deep in the first.
fn fork(depth: f64) -> Shape {
    let is_solid = |[x, y, z]: [i32; 3]| {
        (0..2).contains(&y)
            && match z {
                0 => (0..3).contains(&x),
                1..8 => x == 0 || x == 2,
                _ => false,
            }
    };
    let (mut vertices, mut positions, mut triangles) = (HashMap::new(), Vec::new(), Vec::new());
    let cells = (0..3).flat_map(|x| (0..2).flat_map(move |y| (0..8).map(move |z| [x, y, z])));
    for cell in cells.filter(|&cell| is_solid(cell)) {
        for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]) {
            let mut beyond = cell;
            beyond[axis] += 2 * side - 1;
            if is_solid(beyond) {
                continue;
            }
            let mut corner = |du: i32, dv: i32| {
                let mut point = cell;
                point[axis] += side;
                point[(axis + 1) % 3] += du;
                point[(axis + 2) % 3] += dv;
                *vertices.entry(point).or_insert_with(|| {
                    let [x, y, z] = point.map(f64::from);
                    let push = if x >= 2.0 { (1.0 + depth) * ((z - 1.0) / 2.0).clamp(0.0, 1.0) } else { 0.0 };
                    positions.push([x - push, y, z]);
                    positions.len() as u32 - 1
                })
            };
            let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            triangles.extend(if side == 1 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
        }
    }
    Shape { positions, triangles, inside: Vec::new() }
}

/// Where the prongs are straight, each triangle of the two faces has a contact across the other prong's face, as deep as
/// the prongs overlap; and the forces drive the prongs apart without a net force or moment.
#[test]
fn prongs_of_a_fork_part() {
    let depth = 0.25;
    let shape = fork(depth);
    let found = own_contacts::<f64>(&shape, &DetectionOptions::default());
    let straight: Vec<_> = found.contacts.iter().filter(|contact| contact.p1.position.z > 3.0).collect();
    assert_eq!(straight.len(), 2 * 5 * 2 * 2);
    for contact in straight {
        let inward = if contact.p1.position.x == 1.0 { -1.0 } else { 1.0 };
        assert_eq!(contact.direction, Vector3::new(inward, 0.0, 0.0));
        // A half of half a unit square: the other prong's face casts as well.
        assert_eq!((contact.depth, contact.cos_alpha, contact.area), (depth, 1.0, 0.25));
    }
    assert!(own_contacts::<f64>(&fork(-0.25), &DetectionOptions::default()).is_empty());

    let law = PenaltyLaw::new(100.0, 0.0, Weighting::Area).expect("a valid law");
    let mut forces = vec![vec![Vector3::zeros(); shape.positions.len()]];
    add_forces(&found, &law, None::<&[Vec<Vector3<f64>>]>, None, &mut forces);
    let (mut net, mut moment, mut on_first, mut on_second) = (Vector3::zeros(), Vector3::zeros(), 0.0, 0.0);
    for (force, position) in forces[0].iter().zip(&shape.positions) {
        let position = Vector3::from(*position);
        net += force;
        moment += position.cross(force);
        let prong = if position.x == 0.0 || position.x == 1.0 { &mut on_first } else { &mut on_second };
        *prong += force.x;
    }
    assert!(net.norm() < 1e-12 && moment.norm() < 1e-12, "{net}, {moment}");
    // Twenty halves of half a unit square on either face, both ways: 100 · 0.25 · 10, and what the bend adds.
    assert!(on_first < -250.0 && on_second > 250.0, "{on_first}, {on_second}");
}

/// Winding numbers above 1 without any crossing: one part inside another.
#[test]
fn nested_parts_are_found_without_a_crossing() {
    let (inner, outer) = (shapes::sphere(1).map(|p| p.map(|x| 0.3 * x)), shapes::sphere(1));
    for options in [DetectionOptions::default(), DetectionOptions::<f64>::paper()] {
        let found = own_contacts(&outer.joined(&inner), &options);
        // All of the inner part lies inside the outer, but the way out leads through its own far side.
        assert!(found.is_empty());
        let inner_count = if options.sampling == Sampling::Vertices { 42 } else { 80 };
        assert_eq!(found.statistics.own_surface_hits, inner_count);
    }
    // A hollow body: the inner surface is the wall of a cavity, and winds the other way.
    let mut cavity = inner;
    cavity.triangles.iter_mut().for_each(|corners| corners.swap(0, 1));
    let found = own_contacts(&outer.joined(&cavity), &DetectionOptions::<f64>::default());
    assert_eq!(found.statistics.own_surface_hits, 0);
}

/// A flat plate within its body: the vertices on either side see none but the triangles of the other side, and the way out is still
/// through the plate's own far side.
#[test]
fn a_plate_within_its_body_is_one_fold() {
    let plate = shapes::block([4, 4, 1]).map(|[x, y, z]| [0.2 * x - 0.4, 0.2 * y - 0.4, 0.1 * z]);
    let found = own_contacts(&shapes::cube(1).joined(&plate), &DetectionOptions::<f64>::paper());
    assert_eq!((found.len(), found.statistics.own_surface_hits), (0, 50));
}

/// Whether a triangle and a box have more than a border in common: what is left of the triangle within each of the box's
/// planes in turn.
fn reaches_into(corners: [Point; 3], [lower, upper]: [Point; 2]) -> bool {
    let mut left = corners.to_vec();
    for (axis, end, sign) in (0..3).flat_map(|axis| [(axis, lower[axis], 1.0), (axis, upper[axis], -1.0)]) {
        let height = |point: &Point| sign * (point[axis] - end);
        let sides = (0..left.len()).map(|i| (left[i], left[(i + 1) % left.len()])).collect::<Vec<_>>();
        left.clear();
        for (from, to) in sides {
            if height(&from) > 0.0 {
                left.push(from);
            }
            if (height(&from) > 0.0) != (height(&to) > 0.0) {
                let part = height(&from) / (height(&from) - height(&to));
                left.push(std::array::from_fn(|axis| from[axis] + part * (to[axis] - from[axis])));
            }
        }
    }
    !left.is_empty()
}

/// No more rays than need be: none for a surface in one piece that touches itself nowhere, one for each of several pieces;
/// where two pieces cross, those of the triangles that lie inside or cross, and one for the rest of either.
#[test]
fn rays_are_cast_where_the_surface_winds_twice() {
    let counts = |shape: &Shape, layout| {
        let mesh = shape.mesh::<f64>();
        let mut contacts = ContactList::default();
        let octree = Octree::with_layout(&mesh, layout);
        query_self(&mesh, &octree, &DetectionOptions::default(), &mut contacts).expect("the octree is new");
        contacts.statistics
    };
    let (block, by) = (shapes::block([3, 3, 3]), [1.3, 1.6, 1.45]);
    let crossing = block.joined(&block.moved(by));
    let boxes = [by.map(|x| [x, x + 3.0]), [[0.0, 3.0]; 3]].map(|ends| [ends.map(|e| e[0]), ends.map(|e| e[1])]);
    let reach = |(number, triangle): (usize, &[u32; 3])| {
        let corners = triangle.map(|vertex| crossing.positions[vertex as usize]);
        usize::from(reaches_into(corners, boxes[number / block.triangles.len()]))
    };
    let inside: usize = crossing.triangles.iter().enumerate().map(reach).sum();
    assert!((20..block.triangles.len()).contains(&inside), "{inside} triangles");
    for layout in [Layout::PaperOctree, Layout::Bvh] {
        assert_eq!(counts(&block, layout).rays, 0);
        let apart = counts(&block.joined(&block.moved([5.0, 0.0, 0.0])), layout);
        assert_eq!([apart.rays, apart.misses], [2, 2]);
        assert_eq!(counts(&crossing, layout).rays, inside as u64 + 2, "{layout:?}");
    }
}

/// Follows a body through these positions: what a scene finds by what it remembers from step to step is what every ray
/// finds. Gives in how many steps it touches itself, and in how many no ray is cast.
fn assert_nothing_lost(shape: &Shape, steps: impl Iterator<Item = Vec<Point>>) -> [usize; 2] {
    let mut mesh = shape.mesh::<f64>();
    let mut octree = Octree::new(&mesh);
    let mut scene = Scene::new(1).expect("no threads are needed");
    let body = scene.add(mesh.clone());
    scene.set_self_collision(body, true).expect("it was added");
    let options = DetectionOptions::default();
    let (mut culled, mut all) = (ContactList::default(), ContactList::default());
    let (mut touching, mut not_looked_at) = (0, 0);
    for (step, positions) in steps.enumerate() {
        mesh.set_positions(&positions).expect("finite");
        scene.mesh_mut(body).expect("it was added").set_positions(&positions).expect("finite");
        scene.query(&mut culled);
        assert_balanced(&culled);
        octree.update(&mesh).expect("its own");
        query_self_with_all_rays(&mesh, &octree, &options, &mut all).expect("up to date");
        assert_eq!(culled.contacts, all.contacts, "step {step}");
        touching += usize::from(!all.is_empty());
        not_looked_at += usize::from(culled.statistics.rays == 0);
    }
    [touching, not_looked_at]
}

/// A tube that wanders at random, slowly and fast by turns, now and then through itself. Long runs: the program
/// self_collision.
#[test]
fn culling_and_memory_lose_nothing() {
    let shape = shapes::torus(20, 6, 0.25);
    let mut random = Random::new(5);
    let mut waves = [[0.0; 4]; 6];
    let steps = (0..1200 / STRIDE).map(|step| {
        let pace = if step / 50 % 2 == 0 { 0.001 } else { 0.15 };
        for number in waves.as_flattened_mut() {
            *number = f64::clamp(*number + pace * random.signed(), -1.0, 1.0);
        }
        let moved = |p: &Point| {
            let mut at = *p;
            for (k, [height, x, y, z]) in waves.iter().enumerate() {
                at[k % 3] += height * (2.0 * (1.0 + k as f64) * (p[0] * x + p[1] * y + p[2] * z)).sin();
            }
            at
        };
        shape.positions.iter().map(moved).collect()
    });
    let [touching, not_looked_at] = assert_nothing_lost(&shape, steps);
    assert!(touching > 5 && not_looked_at > 20, "{touching}, {not_looked_at}");
}

/// Prongs that close so slowly that a scene lives by what it remembers: their first touch is not missed, however large the
/// units are.
#[test]
fn a_slow_approach_is_not_missed() {
    for size in [1.0 / 1024.0, 1.0, 1024.0] {
        let at = |step: u32| fork(-0.3 + 0.001 * f64::from(step)).scaled(size);
        let [touching, _] = assert_nothing_lost(&at(0), (0..400).map(|step| at(step).positions));
        // From step 301 on, where they are 0.001 deep.
        assert!((90..110).contains(&touching), "{touching}");
    }
}

/// A bar of that many sides, along x; each side is two slivers.
fn bar(sides: u32) -> Shape {
    let ring = |x: f64| {
        (0..sides).map(move |k| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(sides)).sin_cos();
            [x, cos, sin]
        })
    };
    let positions: Vec<Point> = ring(-3.0).chain(ring(3.0)).chain([[-3.0, 0.0, 0.0], [3.0, 0.0, 0.0]]).collect();
    let of_side = |k: u32| {
        let (a, b) = (k, (k + 1) % sides);
        [[a, b, a + sides], [b, b + sides, a + sides], [2 * sides, b, a], [2 * sides + 1, a + sides, b + sides]]
    };
    Shape { positions, triangles: (0..sides).flat_map(of_side).collect(), inside: Vec::new() }
}

/// Bars of long slivers, across each other: each sliver touches many, and its box overlaps most of the other bar's. They are
/// not taken for garbage.
#[test]
fn slivers_that_cross_are_not_taken_for_a_tangle() {
    for sides in [150, 300] {
        let crossed = bar(sides).joined(&bar(sides).turned(1.3, 0.4).moved([0.1, 0.3, 0.2]));
        let mesh = crossed.mesh::<f64>();
        let (mut all, mut culled) = (ContactList::default(), ContactList::default());
        let (octree, options) = (Octree::new(&mesh), DetectionOptions::default());
        query_self(&mesh, &octree, &options, &mut culled).expect("the octree is new");
        query_self_with_all_rays(&mesh, &octree, &options, &mut all).expect("the octree is new");
        assert_eq!(culled.contacts, all.contacts, "{sides}");
        assert!(!all.is_empty() && culled.statistics.tangled_bodies == 0, "{sides}");
    }
}

/// A fine body that changes its size fast, so that soon any of its parts might be near any other: what a scene remembers is
/// no reason to take it for a tangled one.
#[test]
fn fast_growth_is_not_taken_for_a_tangle() {
    let rest = shapes::torus(200, 100, 0.4);
    let mut scene = Scene::new(1).expect("no threads are needed");
    let body = scene.add(rest.mesh::<f64>());
    scene.set_self_collision(body, true).expect("it was added");
    let mut contacts = ContactList::default();
    for (step, size) in [1.0, 1.5, 2.25, 3.4, 5.0, 5.1].into_iter().enumerate() {
        scene.mesh_mut(body).expect("it was added").set_positions(&rest.scaled(size).positions).expect("finite");
        scene.query(&mut contacts);
        let Statistics { tangled_bodies, self_contacts, .. } = contacts.statistics;
        assert_eq!([tangled_bodies, self_contacts], [0, 0], "step {step}");
    }
}

/// Two halves with a gap, moved so far that rounding is as large as the gap: a scene that knows them from where they were
/// apart finds the same as one that sees them there first. All coordinates are exact.
#[test]
fn a_gap_is_not_remembered_where_rounding_is_as_large() {
    let rest = shapes::cube(2).joined(&shapes::cube(2).moved([2.0 + f64::exp2(-20.0), 0.0, 0.0]));
    let scene_at = |by: f64| {
        let mut scene = Scene::new(1).expect("no threads are needed");
        let body = scene.add(rest.moved([by; 3]).mesh::<f64>());
        scene.set_self_collision(body, true).expect("it was added");
        scene
    };
    let look = |scene: &mut Scene<f64>| {
        let mut list = ContactList::default();
        scene.query(&mut list);
        (scene.overlaps_itself(0).expect("it was added"), list.contacts)
    };
    let mut scene = scene_at(0.0);
    assert!(!look(&mut scene).0);
    for (exponent, touches) in [(20.0, false), (27.0, true)] {
        let by = f64::exp2(exponent);
        scene.mesh_mut(0).expect("it was added").set_positions(&rest.moved([by; 3]).positions).expect("finite");
        let (found, first) = (look(&mut scene), look(&mut scene_at(by)));
        assert_eq!((found.0, &found), (touches, &first), "2^{exponent}");
    }
}

/// Scaled by a power of two, the contacts are scaled to the bit.
#[test]
fn scaling_by_a_power_of_two_scales_contacts() {
    let shape = fork(0.3).turned(0.4, 0.7);
    let found = own_contacts::<f64>(&shape, &DetectionOptions::default());
    assert!(!found.is_empty());
    for exponent in [-40, -3, 5, 60] {
        let factor = f64::exp2(f64::from(exponent));
        let scaled = own_contacts::<f64>(&shape.scaled(factor), &DetectionOptions::default());
        assert_eq!(scaled.len(), found.len());
        for (scaled, contact) in scaled.contacts.iter().zip(&found.contacts) {
            assert_eq!(scaled.depth, contact.depth * factor);
            assert_eq!((scaled.p1.triangle, scaled.p2.triangle), (contact.p1.triangle, contact.p2.triangle));
        }
    }
}

/// An open mesh has no inside: it has no contacts with itself, and is counted; in parts or whole.
#[test]
fn open_meshes_have_no_contacts_with_themselves() {
    let mut shape = shapes::sphere(1).joined(&shapes::sphere(1).moved([0.3, 0.2, 0.1]));
    shape.triangles.truncate(shape.triangles.len() - 3);
    let mesh = Mesh::<f64>::open(&shape.positions, &shape.triangles).expect("it may be open");
    assert_eq!(mesh.topology().components().len(), 2);
    let (octree, options) = (Octree::new(&mesh), DetectionOptions::default());
    let mut contacts = ContactList::default();
    query_self(&mesh, &octree, &options, &mut contacts).expect("the octree is new");
    assert_eq!((contacts.len(), contacts.statistics.open_bodies), (0, 1));
    query_self_with_all_rays(&mesh, &octree, &options, &mut contacts).expect("the octree is new");
    assert_eq!((contacts.len(), contacts.statistics.open_bodies), (0, 1));
}
