//! Single rays: the test of Möller and Trumbore, held to what a hit means and, for rays that stay clear of edges, to the
//! watertight one; where rays leave a box.

use crate::common::STRIDE;
use crate::common::random::Random;
use crate::common::shapes::{self, Point};
use raycontact::math::{Aabb, Vector3};
use raycontact::mesh::Mesh;
use raycontact::query::{Layout, Octree};
use raycontact::triangle::{Hit, Ray, ShearedRay, TriangleTest};

/// The point that the weights name.
fn point_of(mesh: &Mesh<f64>, hit: &Hit<f64>) -> Vector3<f64> {
    let corners = mesh.corners(hit.triangle);
    (0..3).map(|corner| corners[corner] * hit.weights[corner]).sum()
}

#[test]
fn hits_lie_on_the_ray_and_in_the_triangle_and_are_those_of_the_watertight_test() {
    let mut random = Random::new(8);
    let mesh: Mesh<f64> = shapes::torus(24, 12, 0.4).turned(0.3, 0.2).scaled(3.0).mesh();
    let octree = Octree::new(&mesh);
    let watertight = octree.tracer(&mesh).expect("fresh");
    let other = watertight.with_test(TriangleTest::MollerTrumbore);
    let (mut entries, mut exits, mut misses) = (0, 0, 0);
    let mut rounded_otherwise = false;
    for _ in 0..2000 / STRIDE {
        let [origin, direction]: [Point; 2] = [random.point(4.0), random.point(1.0)];
        // Directions of any length: t counts in them.
        let ray = Ray::new(Vector3::from(origin), Vector3::from(direction) * 3.0);
        let (expected, found) = (watertight.nearest_hit(&ray), other.nearest_hit(&ray));
        assert_eq!(found, other.nearest_hit_of_all(&ray));
        let Some(expected) = expected else {
            assert_eq!(found, None);
            misses += 1;
            continue;
        };
        let found = found.expect("no ray is so close to an edge");
        assert_eq!((found.triangle, found.is_exit), (expected.triangle, expected.is_exit));
        assert!((found.t - expected.t).abs() <= 1e-12 * (1.0 + expected.t));
        assert!(found.weights.iter().zip(expected.weights).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        assert!((point_of(&mesh, &found) - (ray.origin + ray.direction * found.t)).norm() < 1e-11);
        rounded_otherwise |= found.weights != expected.weights;
        *(if found.is_exit { &mut exits } else { &mut entries }) += 1;
    }
    let counts = [entries, exits, misses].map(|count| count * STRIDE);
    assert!(counts.iter().all(|&count| count > 100), "{counts:?} entries, exits and misses");
    assert!(rounded_otherwise, "it is another test");
}

/// No hit inside the box lies beyond the exit, and it is hardly farther: 64 units of rounding of the box's reach.
#[test]
fn rays_leave_a_box_at_its_faces() {
    let aabb = Aabb { lower: Vector3::new(-1.0, 2.0, -4.0), upper: Vector3::new(1.0, 6.0, -1.0) };
    let origin = Vector3::new(0.5, 3.0, -3.0);
    // To each of the six faces: the direction, where the exit is, how fast it is approached.
    let rays = [
        ([1.0, 0.5, 0.25], 0.5, 1.0),
        ([-0.5, 0.25, 0.125], 3.0, 0.5),
        ([0.25, 4.0, 0.5], 0.75, 4.0),
        ([0.25, -2.0, 0.5], 0.5, 2.0),
        ([0.125, 0.0, 8.0], 0.25, 8.0),
        ([0.0, 0.0, -0.25], 4.0, 0.25),
    ];
    for (direction, exit, speed) in rays {
        let found = Ray::new(origin, Vector3::from(direction)).exit_from(&aabb);
        let units_beyond = (found - exit) * speed / (f64::EPSILON / 2.0);
        // The box reaches 3 from the origin.
        assert!((units_beyond - 3.0 * 64.0).abs() < 16.0, "{direction:?}: {units_beyond} units of rounding");
    }
    assert_eq!(Ray::new(origin, Vector3::zeros()).exit_from(&aabb), f64::INFINITY);
    let ray = Ray::new(origin, Vector3::x()).until(0.25);
    assert_eq!((ray.origin, ray.direction, ray.t_max), (origin, Vector3::x(), 0.25));
}

/// Each ray by itself against every triangle that it does not start from: whether one is met from inside before the end.
#[test]
fn rays_leave_their_mesh_where_a_triangle_is_met_from_inside() {
    let mut random = Random::new(4);
    let mesh: Mesh<f64> = shapes::torus(20, 10, 0.5).turned(0.4, 0.9).mesh();
    let triangles = mesh.topology().triangles();
    let (mut rays, mut touched) = (Vec::new(), Vec::new());
    for number in 0..300 {
        let start = number * 7 % triangles.len();
        let corners = triangles[start];
        // From a vertex, the middle of an edge or that of a face, by turns.
        let vertices = [[corners[0]; 3], [corners[0], corners[1], corners[0]], corners][number % 3];
        let sum: Vector3<f64> = vertices.iter().map(|&vertex| mesh.positions()[vertex as usize]).sum();
        let origin = if number % 3 == 1 {
            (mesh.positions()[corners[0] as usize] + mesh.positions()[corners[1] as usize]) / 2.0
        } else {
            sum / 3.0
        };
        rays.push(Ray::new(origin, Vector3::from(random.point(1.0))).until(2.0 + 2.0 * random.signed()));
        touched.push(vertices);
    }
    let expected: Vec<bool> = rays
        .iter()
        .zip(&touched)
        .map(|(ray, touched)| {
            let sheared = ShearedRay::new(ray);
            (0..triangles.len() as u32).any(|triangle| {
                let is_start = touched.iter().all(|vertex| triangles[triangle as usize].contains(vertex));
                let hit = sheared.intersect(&mesh.corners(triangle), triangle);
                !is_start && hit.is_some_and(|hit| hit.is_exit && hit.t < ray.t_max)
            })
        })
        .collect();
    assert!((50..250).contains(&expected.iter().filter(|&&leaves| leaves).count()));
    for layout in [Layout::Bvh, Layout::PaperOctree] {
        let octree = Octree::with_layout(&mesh, layout);
        let mut found = vec![true; 3];
        octree.tracer(&mesh).expect("fresh").leave_before_end(&rays, &touched, &mut found);
        assert_eq!(found, expected, "{layout:?}");
    }
}

/// Rays from an edge of a ball, within it, to the triangles around: but for the two that they start from they leave through
/// them, whichever way the edge's two vertices are named.
#[test]
fn rays_from_an_edge_pass_over_none_but_its_own_triangles() {
    let mesh: Mesh<f64> = shapes::sphere(1).turned(0.3, 0.2).mesh();
    let middle = |triangle: u32| mesh.corners(triangle).iter().sum::<Vector3<f64>>() / 3.0;
    for layout in [Layout::Bvh, Layout::PaperOctree] {
        let octree = Octree::with_layout(&mesh, layout);
        let tracer = octree.tracer(&mesh).expect("fresh");
        let mut leaves = Vec::new();
        for edge in mesh.topology().edges().step_by(STRIDE) {
            let [a, b] = edge.vertices;
            let start = (mesh.positions()[a as usize] + mesh.positions()[b as usize]) * 0.5;
            for (from, to) in [(a, b), (b, a)] {
                for &triangle in mesh.topology().triangles_around(from) {
                    let ray = Ray::new(start, middle(triangle) - start).until(1.1);
                    let named = [[from, to, from], [from, from, to], [from, to, to], [to, from, to]];
                    tracer.leave_before_end(&[ray; 4], &named, &mut leaves);
                    assert_eq!(leaves, [!edge.triangles.contains(&triangle); 4], "{layout:?}, {edge:?}, {triangle}");
                }
            }
        }
    }
}
