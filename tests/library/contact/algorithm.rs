//! Algorithm 1 of Hermann, Faure and Raffin 2008, written a second time without the library's octree, ray test or
//! normals, and the number of threads, which must not matter.

use crate::common::shapes::{self, Point, Shape, cross, dot, unit};
use raycontact::contact::{Contact, ContactList, DetectionOptions, Statistics};
use raycontact::escape::query_pair;
use raycontact::math::Scalar;
use raycontact::mesh::Mesh;
use raycontact::query::{Layout, Octree};
use raycontact::scene::Scene;
use raycontact::triangle::Ray;

/// The torus of the standard workloads, body `k` of the stack, at rest.
fn stacked(k: usize) -> Shape {
    let k = k as f64;
    let centre = [0.13 * k.sin(), 0.13 * (1.7 * k).cos(), 0.6 * k];
    shapes::torus(40, 20, 0.4).turned(0.37 * k, 0.15 * (2.1 * k).sin()).moved(centre)
}

fn contacts<T: Scalar>(a: &Mesh<T>, b: &Mesh<T>, layout: Layout, options: &DetectionOptions<T>) -> ContactList<T> {
    let octrees = [a, b].map(|mesh| Octree::with_layout(mesh, layout));
    let mut list = ContactList::default();
    query_pair(a, &octrees[0], b, &octrees[1], options, &mut list).expect("the octrees are fresh");
    list
}

/// A contact as the paper's words define it: the vertex, the triangle it is pulled to, the distance.
#[derive(Debug)]
struct Expected {
    vertex: u32,
    triangle: u32,
    depth: f64,
}

fn minus(a: Point, b: Point) -> Point {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn normal(shape: &Shape, triangle: usize) -> Point {
    let [a, b, c] = shape.triangles[triangle].map(|vertex| shape.positions[vertex as usize]);
    cross(minus(b, a), minus(c, a))
}

/// Where the ray meets the plane of a triangle, if that is inside the triangle and ahead.
fn distance(shape: &Shape, triangle: usize, origin: Point, direction: Point) -> Option<f64> {
    let corners = shape.triangles[triangle].map(|vertex| shape.positions[vertex as usize]);
    let normal = normal(shape, triangle);
    let t = dot(minus(corners[0], origin), normal) / dot(direction, normal);
    let point: Point = std::array::from_fn(|axis| origin[axis] + t * direction[axis]);
    let is_left_of = |i: usize| {
        let (from, to) = (corners[i], corners[(i + 1) % 3]);
        dot(cross(minus(to, from), minus(point, from)), normal) >= 0.0
    };
    (t >= 0.0 && (0..3).all(is_left_of)).then_some(t)
}

/// All hits of a ray with a shape, by triangle.
fn hits(shape: &Shape, origin: Point, direction: Point) -> impl Iterator<Item = (usize, f64)> {
    (0..shape.triangles.len()).filter_map(move |i| distance(shape, i, origin, direction).map(|t| (i, t)))
}

fn inside_box(shape: &Shape, point: Point) -> bool {
    (0..3).all(|axis| {
        let along = shape.positions.iter().map(|position| position[axis]);
        along.clone().fold(f64::INFINITY, f64::min) <= point[axis]
            && point[axis] <= along.fold(-f64::INFINITY, f64::max)
    })
}

/// "For every vertex p1 of A inside the intersection of the two bodies' boxes, trace a ray along −n1 in B. p2 is the
/// nearest hit. Drop it if the ray enters B. Trace the same ray in A itself, without the triangles around p1; drop the
/// pair if that hit is nearer than p2."
fn one_way(a: &Shape, b: &Shape) -> Vec<Expected> {
    let mut found = Vec::new();
    for (vertex, &p1) in a.positions.iter().enumerate() {
        if !inside_box(a, p1) || !inside_box(b, p1) {
            continue;
        }
        let is_around = |triangle: usize| a.triangles[triangle].contains(&(vertex as u32));
        let mut n1 = [0.0; 3];
        for triangle in (0..a.triangles.len()).filter(|&triangle| is_around(triangle)) {
            let normal = normal(a, triangle);
            n1 = std::array::from_fn(|axis| n1[axis] + normal[axis]);
        }
        let direction = unit(n1).map(|x| -x);
        let Some((triangle, depth)) = hits(b, p1, direction).min_by(|x, y| x.1.total_cmp(&y.1)) else { continue };
        if dot(direction, normal(b, triangle)) <= 0.0 {
            continue;
        }
        if hits(a, p1, direction).any(|(triangle, t)| t < depth && !is_around(triangle)) {
            continue;
        }
        // A ray that is out of A at once may never meet it; what lies beyond the boxes is no contact of theirs.
        if !inside_box(a, std::array::from_fn(|axis| p1[axis] + depth * direction[axis])) {
            continue;
        }
        found.push(Expected { vertex: vertex as u32, triangle: triangle as u32, depth });
    }
    found
}

fn assert_same(expected: &[Expected], found: &[&Contact<f64>], name: &str) {
    assert_eq!(expected.len(), found.len(), "{name}");
    for (expected, found) in expected.iter().zip(found) {
        assert_eq!(found.p1.vertices[0], expected.vertex, "{name}");
        assert!((found.depth - expected.depth).abs() < 1e-12, "{name}: {expected:?}, {found:?}");
        assert_eq!(found.p2.triangle, expected.triangle, "{name}: {found:?}");
    }
}

#[test]
fn contacts_are_those_of_algorithm_1() {
    let star = shapes::star().turned(0.3, 0.2);
    let pairs = [
        ("two tori", shapes::torus(20, 10, 0.4), shapes::torus(20, 10, 0.4).turned(0.4, 0.9).moved([0.25, 0.1, 0.3])),
        ("a star in a sphere's side", star.clone(), shapes::sphere(2).turned(0.1, 0.7).moved([0.7, 0.2, 0.1])),
        ("two stars", star.clone(), star.turned(0.5, 0.4).moved([0.31, 0.17, 0.23])),
        // Seven sides: with eight, rays meet the opposite vertex exactly, and the ray test above would leak there.
        ("thin tube, own surface first", shapes::torus(24, 7, 0.1), shapes::torus(20, 10, 0.4).moved([0.5, 0.2, 0.15])),
    ];
    for (name, a, b) in pairs {
        let (ab, ba) = (one_way(&a, &b), one_way(&b, &a));
        let (mesh_a, mesh_b) = (a.mesh::<f64>(), b.mesh::<f64>());
        for layout in [Layout::Bvh, Layout::PaperOctree] {
            let list = contacts(&mesh_a, &mesh_b, layout, &DetectionOptions::paper());
            let sorted = crate::common::sorted_by_vertex(list.contacts);
            let (from_a, from_b): (Vec<_>, Vec<_>) = sorted.iter().partition(|contact| contact.colliding == 0);
            assert_same(&ab, &from_a, name);
            assert_same(&ba, &from_b, name);
        }
        assert!(!ab.is_empty() || !ba.is_empty(), "{name} tests nothing");
    }
}

/// At the tip of a thorn the inward normal may be out of it at once: what such a ray meets first of its own body is its
/// outside, and that drops the pair all the same.
#[test]
fn rays_that_start_out_of_their_own_body_are_dropped_where_they_meet_it() {
    let mut dropped = 0;
    for turn in [-0.42, -0.28, -0.14, 0.14, 0.28, 0.42] {
        // Leaning a little, so that no ray meets an edge of its far side exactly: there the ray test above would leak.
        let thorn = shapes::sphere(3).turned(0.0, turn).map(|[x, y, z]| {
            let width = 0.6 * (1.0 + z);
            [width * x + 0.01 * y * (1.0 + z), width * y, z]
        });
        let ball = shapes::sphere(3).turned(0.3, 0.2).moved([0.05, 0.1, -1.3]);
        let expected = one_way(&thorn, &ball);
        let mesh = thorn.mesh::<f64>();
        for layout in [Layout::Bvh, Layout::PaperOctree] {
            let list = contacts(&mesh, &ball.mesh::<f64>(), layout, &DetectionOptions::paper());
            let sorted = crate::common::sorted_by_vertex(list.contacts);
            let from_thorn: Vec<_> = sorted.iter().filter(|contact| contact.colliding == 0).collect();
            assert_same(&expected, &from_thorn, &format!("turned by {turn}, {layout:?}"));
        }
        let octree = Octree::new(&mesh);
        let tracer = octree.tracer(&mesh).expect("the octree is fresh");
        let mut crossings = Vec::new();
        for vertex in 0..thorn.positions.len() as u32 {
            let normal = mesh.vertex_normal(vertex).expect("no triangle is without area");
            tracer.crossings(&Ray::new(mesh.positions()[vertex as usize], -normal.normal), &mut crossings);
            let first = crossings.iter().find(|hit| !thorn.triangles[hit.triangle as usize].contains(&vertex));
            dropped += usize::from(first.is_some_and(|hit| !hit.is_exit));
        }
    }
    assert!(dropped >= 3, "{dropped} such vertices");
}

#[test]
fn two_stacked_tori_have_327_contacts() {
    let (a, b) = (stacked(0).mesh::<f64>(), stacked(1).mesh::<f64>());
    for layout in [Layout::Bvh, Layout::PaperOctree] {
        assert_eq!(contacts(&a, &b, layout, &DetectionOptions::paper()).len(), 327, "{layout:?}");
    }
}

#[test]
fn every_ray_is_counted_once() {
    let (a, b) = (stacked(0).mesh::<f64>(), stacked(1).mesh::<f64>());
    for options in [DetectionOptions::paper(), DetectionOptions::default()] {
        let list = contacts(&a, &b, Layout::Bvh, &options);
        crate::common::assert_every_ray_is_counted(&list);
        assert_eq!(list.statistics.pairs, 1);
    }
}

#[test]
fn both_layouts_give_the_same_contacts() {
    let (a, b) = (stacked(0).mesh::<f32>(), stacked(1).mesh::<f32>());
    for options in [DetectionOptions::paper(), DetectionOptions::default()] {
        let [wide, classic] = [Layout::Bvh, Layout::PaperOctree].map(|layout| contacts(&a, &b, layout, &options));
        // Only the wide layout knows beforehand of what lies outside.
        let of_rays = |Statistics { rays, own_surface_hits, patches, .. }| [rays, own_surface_hits, patches];
        assert_eq!(of_rays(wide.statistics), of_rays(classic.statistics));
        let [wide, classic] = [wide, classic].map(|list| crate::common::sorted_along_surface(list.contacts));
        assert_eq!(wide.len(), classic.len());
        for (wide, classic) in wide.iter().zip(&classic) {
            // The load's shares are sums in the order of the leaves.
            assert!((wide.area - classic.area).abs() <= 1e-5 * classic.area, "{wide:?}, {classic:?}");
            assert_eq!(Contact { area: classic.area, ..*wide }, *classic);
        }
    }
}

/// Deep in one another much of the surface in the overlap box lies outside the other body. The wide layout casts nothing from
/// there but near the other surface, and loses nothing by that.
#[test]
fn what_lies_outside_the_other_body_casts_no_rays() {
    let torus = shapes::torus(160, 80, 0.4);
    for turn in [0.5, 1.1, 1.9] {
        let (a, b) = (torus.mesh::<f32>(), torus.turned(turn, turn).moved([0.3, 0.4, 0.25]).mesh::<f32>());
        for options in [DetectionOptions::paper(), DetectionOptions::default()] {
            let [wide, classic] = [Layout::Bvh, Layout::PaperOctree].map(|layout| contacts(&a, &b, layout, &options));
            let asked = [&wide, &classic].map(|list| list.statistics.rays + list.statistics.estimate_rays);
            // Samples that follow the load stay away by themselves, but for the first look.
            let [less, all] = if options == DetectionOptions::paper() { [5, 4] } else { [10, 9] };
            assert!(asked[0] * less < asked[1] * all, "{asked:?}");
            assert_eq!(wide.statistics.own_surface_hits, classic.statistics.own_surface_hits);
            crate::common::assert_every_ray_is_counted(&wide);
            let [mut wide, mut classic] =
                [wide, classic].map(|list| crate::common::sorted_along_surface(list.contacts));
            let load = |contacts: &[Contact<f32>]| -> f32 {
                contacts.iter().map(|contact| contact.area * contact.depth * contact.cos_alpha).sum()
            };
            assert!((load(&wide) / load(&classic) - 1.0).abs() < 2e-3, "{} {}", load(&wide), load(&classic));
            if options != DetectionOptions::paper() {
                // The errors of all decide which halves fade in, also of what lies outside: a few may do so in one list alone.
                let all = load(&wide);
                let start = |contact: &Contact<f32>| (contact.p1.position, contact.piece, contact.colliding);
                let [left, kept] = [&classic, &wide].map(|list| list.iter().map(start).collect::<Vec<_>>());
                let mut dropped = Vec::new();
                for (list, others) in [(&mut wide, &left), (&mut classic, &kept)] {
                    list.retain(|contact| {
                        let is_in_both = others.contains(&start(contact));
                        dropped.extend((!is_in_both).then_some(*contact));
                        is_in_both
                    });
                }
                assert!(load(&dropped) < 2e-3 * all, "{} of {all}", load(&dropped));
            }
            assert_eq!(wide.len(), classic.len());
            for (wide, classic) in wide.iter().zip(&classic) {
                // Shares of the paper's law count the surface that casts, and halves of elements fade in by the errors of all.
                let is_near = (wide.area - classic.area).abs() <= 1e-2 * classic.area;
                assert!(is_near || options != DetectionOptions::paper(), "{wide:?}, {classic:?}");
                // Where in its list a contact has what it bears on is another place in each.
                assert_eq!(Contact { area: classic.area, spread: classic.spread, ..*wide }, *classic);
            }
        }
    }
}

#[test]
fn scenes_give_the_pairs_contacts_whatever_the_number_of_threads() {
    // Enough of them to be shared between threads.
    let bodies = 6;
    for options in [DetectionOptions::paper(), DetectionOptions::default()] {
        let mut expected = ContactList::default();
        let meshes: Vec<Mesh<f64>> = (0..bodies).map(|k| stacked(k).mesh()).collect();
        for (i, a) in meshes.iter().enumerate() {
            for (j, b) in meshes.iter().enumerate().skip(i + 1) {
                let mut pair = contacts(a, b, Layout::Bvh, &options);
                for contact in &mut pair.contacts {
                    (contact.colliding, contact.collided) =
                        ([i, j][contact.colliding as usize] as u32, [i, j][contact.collided as usize] as u32);
                }
                expected.append(&pair);
            }
        }
        assert!(expected.len() > 900);
        for threads in [1, 2, 4] {
            let mut scene = Scene::new(threads).expect("the threads start");
            scene.set_options(options);
            meshes.iter().for_each(|mesh| {
                scene.add(mesh.clone());
            });
            let mut found = ContactList::default();
            for step in 0..2 {
                scene.query(&mut found);
                assert_eq!(found, expected, "{threads} threads, step {step}");
            }
        }
    }
}
