//! The faults of the method's original code, each a case that must pass.

use crate::common::STRIDE;
use crate::common::shapes::{self, Point, Shape, cross, dot, unit};
use raycontact::contact::{Contact, ContactList, DetectionOptions, Sampling};
use raycontact::escape::query_pair;
use raycontact::force::{PenaltyLaw, Weighting, add_forces};
use raycontact::math::{Scalar, Vector3};
use raycontact::mesh::Mesh;
use raycontact::query::{Layout, Octree};
use raycontact::triangle::Ray;

const LAYOUTS: [Layout; 2] = [Layout::Bvh, Layout::PaperOctree];

fn contacts<T: Scalar>(a: &Mesh<T>, b: &Mesh<T>, layout: Layout, sampling: Sampling<T>) -> ContactList<T> {
    let octrees = [a, b].map(|mesh| Octree::with_layout(mesh, layout));
    let mut list = ContactList::default();
    let options = DetectionOptions { sampling, ..DetectionOptions::default() };
    query_pair(a, &octrees[0], b, &octrees[1], &options, &mut list).expect("the octrees are fresh");
    list.contacts = crate::common::sorted_along_surface(list.contacts);
    list
}

fn two_tori() -> [Shape; 2] {
    [shapes::torus(16, 8, 0.4), shapes::torus(16, 8, 0.4).turned(0.4, 0.9).moved([0.25, 0.1, 0.3])]
}

/// The mesh with every position multiplied.
fn scaled<T: Scalar>(mesh: &Mesh<T>, factor: T) -> Mesh<T> {
    let mut scaled = mesh.clone();
    let positions = mesh.positions();
    scaled.set_positions_with(positions.len(), |vertex| positions[vertex] * factor).expect("positions stay finite");
    scaled
}

/// The contact as it should be where all lengths are multiplied.
fn scaled_contact<T: Scalar>(contact: &Contact<T>, factor: T) -> Contact<T> {
    let mut scaled = *contact;
    scaled.p1.position *= factor;
    scaled.p2.position *= factor;
    scaled.depth *= factor;
    scaled.area *= factor * factor;
    scaled
}

/// Fault 1: own triangles were left out by an absolute threshold, so that small scenes lost contacts.
#[test]
fn scaling_by_a_power_of_two_changes_no_bit() {
    fn check<T: Scalar>(exponents: std::ops::RangeInclusive<i32>) {
        let [a, b] = two_tori().map(|shape| shape.mesh::<T>());
        for (layout, sampling) in [
            (Layout::Bvh, Sampling::Vertices),
            (Layout::PaperOctree, Sampling::Vertices),
            (Layout::Bvh, Sampling::default()),
        ] {
            let expected = contacts(&a, &b, layout, sampling);
            assert!(expected.len() > 30, "{} contacts", expected.len());
            for exponent in exponents.clone().step_by(STRIDE) {
                let factor = T::of(f64::from(exponent).exp2());
                let found = contacts(&scaled(&a, factor), &scaled(&b, factor), layout, sampling);
                assert_eq!(found.statistics, expected.statistics, "2^{exponent}, {layout:?}, {sampling:?}");
                for (found, expected) in found.contacts.iter().zip(&expected.contacts) {
                    assert_eq!(*found, scaled_contact(expected, factor), "2^{exponent}, {layout:?}, {sampling:?}");
                }
            }
        }
    }
    check::<f64>(-60..=60);
    check::<f32>(-30..=30);
}

/// Many thin plates, one above the other, as one mesh.
fn plates(count: usize, thickness: f64, pitch: f64) -> Shape {
    let mut all = Shape { positions: Vec::new(), triangles: Vec::new(), inside: Vec::new() };
    for level in 0..count {
        let plate = shapes::cube(3).map(|[x, y, z]| [x, y, z * thickness / 2.0 + pitch * level as f64]);
        let first = all.positions.len() as u32;
        all.triangles.extend(plate.triangles.iter().map(|corners| corners.map(|vertex| vertex + first)));
        all.positions.extend(plate.positions);
    }
    all
}

/// Fault 2: the search stopped at the first cell with a hit, and so gave a farther one behind thin layers.
#[test]
fn thin_layers_give_the_nearest_hit() {
    fn check<T: Scalar>() {
        let (thickness, pitch) = (1e-4, 3e-4);
        let shape = plates(6, thickness, pitch).turned(0.3, 0.4);
        let mesh = shape.mesh::<T>();
        for layout in LAYOUTS {
            let octree = Octree::with_layout(&mesh, layout);
            let tracer = octree.tracer(&mesh).expect("the octree is fresh");
            for i in (0..1000).step_by(STRIDE) {
                let part = |step: f64| (f64::from(i) * step).fract() * 1.6 - 0.8;
                let start = [part(0.618_034), part(0.414_214), 0.004 * (part(0.302_776) + 0.3)];
                let start =
                    Shape { positions: vec![start], triangles: Vec::new(), inside: Vec::new() }.turned(0.3, 0.4);
                let origin = Vector3::from(start.positions[0].map(T::of));
                let direction = Vector3::new(part(0.259_921), part(0.709_976), part(0.913_864)).map(T::of);
                let ray = Ray::new(origin, direction);
                assert_eq!(tracer.nearest_hit(&ray), tracer.nearest_hit_of_all(&ray), "{layout:?}, {ray:?}");
            }
        }
    }
    check::<f64>();
    check::<f32>();
}

#[test]
fn a_ray_down_a_stack_of_plates_meets_them_in_turn() {
    let (thickness, pitch) = (1e-4, 3e-4);
    let mesh = plates(12, thickness, pitch).mesh::<f64>();
    for octree in LAYOUTS.map(|layout| Octree::with_layout(&mesh, layout)) {
        let tracer = octree.tracer(&mesh).expect("the octree is fresh");
        for level in 0..12 {
            for (from_below, is_exit, height) in [(-0.5, false, -0.5 * thickness), (0.0, true, 0.5 * thickness)] {
                let middle = pitch * f64::from(level);
                let ray = Ray::new(Vector3::new(0.1, 0.07, middle + from_below * pitch), Vector3::z());
                let hit = tracer.nearest_hit(&ray).expect("a plate lies ahead");
                assert!((ray.origin.z + hit.t - middle - height).abs() < 1e-15, "level {level}: {hit:?}");
                assert_eq!(hit.is_exit, is_exit);
            }
        }
    }
}

/// A vertex normal by its definition, from the positions as they are.
fn normal_at<T: Scalar>(mesh: &Mesh<T>, vertex: u32) -> Point {
    let mut sum = [0.0; 3];
    for (triangle, corners) in mesh.topology().triangles().iter().enumerate() {
        if corners.contains(&vertex) {
            let [a, b, c] = mesh.corners(triangle as u32).map(|corner| corner.map(T::to_f64));
            let normal = cross((b - a).into(), (c - a).into());
            sum = std::array::from_fn(|axis| sum[axis] + normal[axis]);
        }
    }
    unit(sum)
}

/// Fault 3: normals left out triangle 0 and were those of the step before.
#[test]
fn normals_include_triangle_0_and_follow_every_step() {
    let shape = shapes::torus(12, 8, 0.4);
    let mut mesh = shape.mesh::<f64>();
    for step in 0..8 {
        let turned = shape.turned(f64::from(step), 0.7 * f64::from(step));
        mesh.set_positions(&turned.positions).expect("positions are finite");
        for &vertex in mesh.topology().surface_vertices() {
            let found = mesh.vertex_normal(vertex).expect("the torus is smooth").normal;
            assert!(dot(found.into(), normal_at(&mesh, vertex)) > 1.0 - 1e-14, "step {step}, vertex {vertex}");
        }
    }
}

/// A ring that spins fast around a sphere in its hole, without touching: with last step's normals there would be
/// hundreds of contacts.
#[test]
fn fast_rotation_gives_no_contact() {
    let ring = shapes::torus(24, 12, 0.4);
    let mut mesh = ring.mesh::<f64>();
    let ball = shapes::sphere(1).scaled(0.55).mesh::<f64>();
    let (mut octree, ball_octree) = (Octree::new(&mesh), Octree::new(&ball));
    let mut list = ContactList::default();
    for step in 0..10 {
        mesh.set_positions(&ring.turned(1.3 * f64::from(step), 0.9 * f64::from(step)).positions).expect("finite");
        octree.update(&mesh).expect("the octree is the mesh's own");
        for options in [DetectionOptions::paper(), DetectionOptions::default()] {
            query_pair(&mesh, &octree, &ball, &ball_octree, &options, &mut list).expect("the octrees are fresh");
            assert_eq!(list.len(), 0, "step {step}");
            crate::common::assert_every_ray_is_counted(&list);
            assert!(list.statistics.rays + list.statistics.estimate_rays > 30, "the boxes overlap");
        }
    }
}

/// The positions on a grid so coarse that adding a large power of two is exact.
fn on_grid(shape: &Shape, steps_per_unit: f64) -> Shape {
    shape.map(|point| point.map(|x| (x * steps_per_unit).round() / steps_per_unit))
}

/// Fault 4: triangles beyond ±800 vanished.
#[test]
fn far_from_the_origin_contacts_are_the_same() {
    fn check<T: Scalar>(steps_per_unit: f64, offsets: &[f64]) {
        let near = two_tori().map(|shape| on_grid(&shape, steps_per_unit));
        for layout in LAYOUTS {
            let [a, b] = near.each_ref().map(|shape| shape.mesh::<T>());
            let expected = contacts(&a, &b, layout, Sampling::Vertices);
            assert!(expected.len() > 30);
            for &offset in offsets {
                let by = [offset, -2.0 * offset, 0.5 * offset];
                let [a, b] = near.each_ref().map(|shape| shape.moved(by).mesh::<T>());
                let found = contacts(&a, &b, layout, Sampling::Vertices);
                assert_eq!(found.len(), expected.len(), "offset {offset}");
                for (found, expected) in found.contacts.iter().zip(&expected.contacts) {
                    let numbers = |c: &Contact<T>| (c.depth, c.cos_alpha, c.direction, c.p2.weights);
                    assert_eq!(numbers(found), numbers(expected), "offset {offset}");
                    // The load's shares count samples on the overlap box's border, which is as coarse as its coordinates.
                    let ratio = (found.area / expected.area).to_f64();
                    assert!((ratio - 1.0).abs() < 1e-3, "offset {offset}: area {ratio} times as large");
                    assert_eq!(found.p2.vertices, expected.p2.vertices);
                }
            }
        }
    }
    check::<f64>(1024.0, &[1024.0, 1_048_576.0, 1_073_741_824.0]);
    check::<f32>(256.0, &[1024.0, 16384.0]);
}

#[test]
fn large_bodies_keep_their_triangles_beyond_800() {
    let shapes = two_tori().map(|shape| shape.scaled(4096.0));
    let [a, b] = shapes.each_ref().map(Shape::mesh::<f64>);
    assert!(a.aabb().upper.x > 800.0);
    let [small_a, small_b] = two_tori().map(|shape| shape.mesh::<f64>());
    for layout in LAYOUTS {
        let expected = contacts(&small_a, &small_b, layout, Sampling::Vertices).len();
        assert_eq!(contacts(&a, &b, layout, Sampling::Vertices).len(), expected);
    }
}

/// Fault 5: triangles of 3.7e-7 to 7.5e-7 never ended.
#[test]
fn tiny_triangles_end() {
    for edge in [1e-12, 3.7e-7, 5e-7, 7.5e-7] {
        for scale in [edge, edge / 0.3] {
            let [a, b] = two_tori().map(|shape| shape.scaled(scale).mesh::<f32>());
            let [expected_a, expected_b] = two_tori().map(|shape| shape.mesh::<f32>());
            for layout in LAYOUTS {
                let expected = contacts(&expected_a, &expected_b, layout, Sampling::default()).len();
                let found = contacts(&a, &b, layout, Sampling::default()).len();
                // Rounding differs at other scales, so a contact at a border may come or go.
                assert!(found.abs_diff(expected) <= 2, "scale {scale}: {found}, not {expected}");
            }
        }
    }
}

#[test]
fn tiny_triangles_within_a_large_mesh_end() {
    // Drawn together at one pole, where edges become 1e-7 of the size and less.
    let shape = shapes::sphere(3).map(|[x, y, z]| {
        let squeeze = if z > 0.0 { (1.0 - z).powi(3) } else { 1.0 };
        [x * squeeze, y * squeeze, if z > 0.0 { 1.0 - squeeze.cbrt().powi(5) } else { z }]
    });
    let mesh = shape.mesh::<f64>();
    for layout in LAYOUTS {
        let octree = Octree::with_layout(&mesh, layout);
        octree.validate(&mesh).expect("the octree is whole");
        let tracer = octree.tracer(&mesh).expect("the octree is fresh");
        for &position in mesh.positions().iter().step_by(STRIDE) {
            let ray = Ray::new(Vector3::new(0.0, 0.0, -0.5), position - Vector3::new(0.0, 0.0, -0.5));
            assert!(tracer.nearest_hit(&ray).is_some());
        }
    }
}

/// Fault 6: 1.1 to 1.6 % of the rays aimed at vertices or edges leaked.
#[test]
fn rays_aimed_at_vertices_and_edges_never_leak() {
    fn check<T: Scalar>(shape: &Shape) {
        let mesh = shape.mesh::<T>();
        let octrees = LAYOUTS.map(|layout| Octree::with_layout(&mesh, layout));
        for octree in &octrees {
            let tracer = octree.tracer(&mesh).expect("the octree is fresh");
            let rays: Vec<Ray<T>> = shape.inside.iter().flat_map(|&from| rays_to_borders(&mesh, from)).collect();
            let mut hits = Vec::new();
            tracer.nearest_hits(&rays, &mut hits);
            let leak = rays.iter().zip(&hits).find(|(_, hit)| hit.is_none());
            assert!(leak.is_none(), "{leak:?}");
        }
    }
    for shape in [shapes::torus(16, 8, 0.4), shapes::sphere(2), shapes::star(), shapes::cube(4), shapes::tetrahedron()]
    {
        for turn in [0.0, 0.37] {
            check::<f64>(&shape.turned(turn, turn));
            check::<f32>(&shape.turned(turn, turn));
        }
    }
}

fn rays_to_borders<T: Scalar>(mesh: &Mesh<T>, from: Point) -> Vec<Ray<T>> {
    let origin = Vector3::from(from.map(T::of));
    let mut rays = Vec::new();
    for triangle in (0..mesh.topology().triangles().len() as u32).step_by(STRIDE) {
        let [a, b, _] = mesh.corners(triangle);
        for part in [0.0, 0.5, 0.3] {
            rays.push(Ray::new(origin, a + (b - a) * T::of(part) - origin));
        }
    }
    rays
}

/// The net force of a sphere on a large block whose upper face is z = 0, the sphere's lowest point at −depth.
fn force_at(depth: f64, levels: usize, sampling: Sampling<f64>, weighting: Weighting) -> Vector3<f64> {
    let block = shapes::block([1; 3]).map(|[x, y, z]| [40.0 * x - 20.0, 40.0 * y - 20.0, 40.0 * z - 40.0]);
    let sphere = shapes::sphere(levels).turned(0.3, 0.5);
    let lowest = sphere.positions.iter().map(|point| point[2]).fold(f64::INFINITY, f64::min);
    let [a, b] = [sphere.moved([0.1, 0.2, -lowest - depth]), block].map(|shape| shape.mesh::<f64>());
    let found = contacts(&a, &b, Layout::Bvh, sampling);
    let law = PenaltyLaw::new(1.0, 0.0, weighting).expect("the law is valid");
    let mut forces = [a, b].map(|mesh| vec![Vector3::zeros(); mesh.positions().len()]);
    add_forces::<f64, Vec<Vector3<f64>>, _>(&found, &law, None, None, &mut forces);
    forces[0].iter().sum()
}

/// Fault 8: forces jumped at first touch, and were stronger on finer meshes.
#[test]
fn forces_start_from_nothing_and_grow_without_jumps() {
    for (sampling, weighting) in [
        (Sampling::Vertices, Weighting::Vertex),
        (Sampling::Vertices, Weighting::Area),
        (Sampling::default(), Weighting::Area),
    ] {
        assert_eq!(force_at(-1e-9, 2, sampling, weighting), Vector3::zeros(), "apart");
        let step = 2e-3;
        let forces: Vec<f64> =
            (0..100).step_by(STRIDE).map(|i| force_at(f64::from(i) * step, 2, sampling, weighting).z).collect();
        // No faster than if every ray of the sphere pushed: a jump is not small with the step. Samples on faces move as
        // the overlap grows, so that the force may waver by less than that; from vertices it only grows.
        let steepest = if weighting == Weighting::Vertex { 162.0 } else { 4.0 * std::f64::consts::PI };
        let most = steepest * step * STRIDE as f64;
        let least = if sampling == Sampling::Vertices { 0.0 } else { -0.01 * most };
        for (i, pair) in forces.windows(2).enumerate() {
            let change = pair[1] - pair[0];
            assert!((least..most).contains(&change), "step {i}: {change}, {sampling:?}, {weighting:?}");
        }
    }
}

#[test]
fn area_weights_make_the_force_independent_of_the_mesh() {
    for levels in [2, 3] {
        let at = |levels| force_at(0.3, levels, Sampling::default(), Weighting::Area).z;
        let ratio = at(levels + 1) / at(levels);
        assert!((ratio - 1.0).abs() < 0.1, "a sphere four times as fine pushes {ratio} times as strongly");
    }
    let at = |levels| force_at(0.3, levels, Sampling::Vertices, Weighting::Vertex).z;
    assert!(at(3) / at(2) > 2.0, "without weights it does");
}
