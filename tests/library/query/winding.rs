//! The signs of a ray's crossings sum to the winding number, whichever way the ray goes: through faces, and exactly
//! through vertices and edges. The judge is the solid angle of the surface (van Oosterom and Strackee 1983).

use crate::common::random::Random;
use proptest::prelude::*;
use raycontact::math::{Scalar, Vector3};
use raycontact::mesh::Mesh;
use raycontact::query::{Layout, Octree};
use raycontact::triangle::Ray;

/// Two tori that overlap, whose tubes are wider than their holes, so that each passes through itself around its middle, where it
/// winds forth and back: winding numbers 0, 1 and 2.
fn overlapping_tori() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let (around, across) = (12u32, 8u32);
    let angle = |i: u32, count: u32| std::f64::consts::TAU * f64::from(i) / f64::from(count);
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let (u, v) = (angle(i, around), angle(j, across));
            let radius = 1.0 + 1.5 * v.cos();
            positions.push([radius * u.cos(), radius * u.sin(), 1.5 * v.sin()].map(|x| (x * 64.0).round() / 64.0));
            let at = |i: u32, j: u32| i % around * across + j % across;
            triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    positions.extend_from_within(..);
    positions[(around * across) as usize..].iter_mut().for_each(|position| position[0] += 0.75);
    triangles.extend_from_within(..);
    triangles[(2 * around * across) as usize..]
        .iter_mut()
        .for_each(|corners| *corners = corners.map(|v| v + around * across));
    (positions, triangles)
}

fn winding_by_solid_angle(mesh: &Mesh<f64>, point: &Vector3<f64>) -> f64 {
    let triangles = 0..mesh.topology().triangles().len() as u32;
    let doubled: f64 = triangles
        .map(|triangle| {
            let [a, b, c] = mesh.corners(triangle).map(|corner| corner - point);
            let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
            let denominator = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
            2.0 * a.dot(&b.cross(&c)).atan2(denominator)
        })
        .sum();
    doubled / (4.0 * std::f64::consts::PI)
}

fn winding_by_ray<T: Scalar>(mesh: &Mesh<T>, octree: &Octree<T>, origin: Vector3<T>, towards: Vector3<T>) -> i32 {
    let tracer = octree.tracer(mesh).expect("the octree is new");
    let mut crossings = Vec::new();
    tracer.crossings(&Ray::new(origin, towards - origin), &mut crossings);
    crossings.iter().map(|crossing| if crossing.is_exit { 1 } else { -1 }).sum()
}

/// Points in random order, more than are put in order at a time, and some that have no number.
fn check_many_at_once<T: Scalar>() {
    let (positions, triangles) = overlapping_tori();
    let judge = Mesh::new(&positions, &triangles).expect("the tori are closed");
    let positions: Vec<[T; 3]> = positions.iter().map(|position| position.map(T::of)).collect();
    let mesh = Mesh::new(&positions, &triangles).expect("the tori are closed");
    let mut random = Random::new(11);
    let mut points: Vec<Vector3<T>> = (0..5000).map(|_| Vector3::from(random.point(2.7).map(T::of))).collect();
    points[3] = Vector3::repeat(T::INFINITY);
    points[4] = Vector3::new(T::zero(), -T::INFINITY, T::INFINITY) * T::zero();
    points[5] = Vector3::repeat(T::LARGEST);
    for layout in [Layout::Bvh, Layout::PaperOctree] {
        let octree = Octree::with_layout(&mesh, layout);
        let (tracer, mut numbers) = (octree.tracer(&mesh).expect("the octree is new"), vec![Some(9)]);
        tracer.winding_numbers(&points, &mut numbers);
        assert_eq!(numbers[3..6], [None, None, Some(0)]);
        let mut seen = [0; 3];
        for (point, &number) in points.iter().zip(&numbers).skip(6) {
            let expected = winding_by_solid_angle(&judge, &point.map(|x| x.to_f64()));
            // On the surface itself it has no number.
            if (expected - expected.round()).abs() < 1e-6 {
                assert_eq!(number.map(f64::from), Some(expected.round()), "{layout:?}, {point:?}");
                seen[expected.round() as usize] += 1;
            }
        }
        assert!(seen.iter().all(|&count| count > 100), "{seen:?}");
    }
}

#[test]
fn many_points_at_once_have_their_winding_numbers() {
    check_many_at_once::<f64>();
    check_many_at_once::<f32>();
    let open = Mesh::open(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]).expect("it has an area");
    let octree = Octree::new(&open);
    let mut numbers = Vec::new();
    octree.tracer(&open).expect("the octree is new").winding_numbers(&[Vector3::zeros()], &mut numbers);
    assert_eq!(numbers, [None]);
}

proptest! {
    #[test]
    fn signs_sum_to_the_winding_number(
        point in [-2.6..2.6, -2.6..2.6, -1.6..1.6f64],
        triangle in 0..192u32,
        aim in 0..3usize,
    ) {
        let (positions, triangles) = overlapping_tori();
        let mesh = Mesh::new(&positions, &triangles).expect("the tori are closed");
        // On the grid of the mesh, so that rays through vertices and edges are exact in either precision.
        let origin = Vector3::from(point.map(|x: f64| (x * 32.0).round() / 32.0));
        let expected = winding_by_solid_angle(&mesh, &origin);
        prop_assume!((expected - expected.round()).abs() < 1e-6); // not on the surface itself

        let corners = mesh.corners(triangle);
        let towards = match aim {
            0 => corners[0],
            1 => (corners[0] + corners[1]) / 2.0,
            _ => (corners[0] + corners[1] + corners[2]) / 3.0,
        };
        prop_assume!(towards != origin);
        let narrow: Vec<[f32; 3]> = positions.iter().map(|p| p.map(|x| x as f32)).collect();
        let narrow = Mesh::new(&narrow, &triangles).expect("the tori are closed");
        for layout in [Layout::Bvh, Layout::PaperOctree] {
            let octree = Octree::with_layout(&mesh, layout);
            let found = winding_by_ray(&mesh, &octree, origin, towards);
            prop_assert_eq!(f64::from(found), expected.round(), "{:?}, f64", layout);
            let tracer = octree.tracer(&mesh).expect("the octree is new");
            let number = tracer.winding_number(&origin, &mut Vec::new());
            prop_assert_eq!(number.map(f64::from), Some(expected.round()), "{:?}, along z", layout);
            let octree = Octree::with_layout(&narrow, layout);
            let found = winding_by_ray(&narrow, &octree, origin.cast(), towards.cast());
            prop_assert_eq!(f64::from(found), expected.round(), "{:?}, f32", layout);
        }
    }
}
