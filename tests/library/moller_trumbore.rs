//! The test of Möller and Trumbore, held to what a hit means and, for rays that stay clear of edges, to the watertight one.

use crate::common::STRIDE;
use crate::common::random::Random;
use crate::common::shapes::{self, Point};
use raycontact::math::Vector3;
use raycontact::mesh::Mesh;
use raycontact::octree::Octree;
use raycontact::ray::{Hit, Ray, TriangleTest};

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
        *(if found.is_exit { &mut exits } else { &mut entries }) += 1;
    }
    let counts = [entries, exits, misses].map(|count| count * STRIDE);
    assert!(counts.iter().all(|&count| count > 100), "{counts:?} entries, exits and misses");
}
