//! Nearest points of surfaces: every way of asking gives the bits of testing every triangle, whatever the shape, the point
//! and the scale.

use crate::common::random::Random;
use crate::common::shapes::{self, Point, Shape};
use crate::common::{STRIDE, shapes::dot};
use raycontact::math::{Scalar, Vector3};
use raycontact::mesh::Mesh;
use raycontact::query::{Layout, Octree, Tracer};
use raycontact::triangle::ClosestPoint;

fn rounded<T: Scalar>(point: Point) -> Vector3<T> {
    Vector3::from(point.map(T::of))
}

/// Everything that an answer says, to the bit.
fn bits<T: Scalar>(answer: &Option<ClosestPoint<T>>) -> Option<(u32, Vec<u64>)> {
    let bit = |number: &T| number.to_f64().to_bits();
    answer.map(|found| {
        let numbers = found.weights.iter().chain(found.position.iter()).chain([&found.distance]);
        (found.triangle, numbers.map(bit).collect())
    })
}

/// Points around a mesh of about size 1: anywhere, on vertices, edges and faces, near those, and far away.
fn points<T: Scalar>(mesh: &Mesh<T>, random: &mut Random) -> Vec<Vector3<T>> {
    let mut points = Vec::new();
    let size = mesh.aabb().longest_side().to_f64();
    let middle: Point = mesh.aabb().centre().map(|x| x.to_f64()).into();
    let around = |random: &mut Random, reach: f64| {
        let offset = random.point(reach * size);
        rounded(std::array::from_fn(|axis| middle[axis] + offset[axis]))
    };
    let count = mesh.topology().triangles().len() as u32;
    for _ in 0..48 / STRIDE {
        let [a, b, c] = mesh.corners(((random.signed() + 1.0) / 2.0 * f64::from(count)) as u32);
        let part = T::of(random.signed().abs());
        let on_edge = a + (b - a) * part;
        points.extend([around(random, 0.3), around(random, 1.0), a, on_edge, on_edge + (c - a) * T::of(0.3)]);
        points.push((a + b) * T::of(0.5));
        points.push(a + (a - rounded(middle)) * T::of(random.signed()));
        points.push(on_edge + around(random, 1e-6) - rounded::<T>(middle));
        points.extend([around(random, 1e3), around(random, 1e9)]);
    }
    points.extend([mesh.aabb().centre(), Vector3::zeros(), mesh.aabb().lower]);
    points
}

/// All ways of asking; gives what they say.
fn answers<T: Scalar>(
    tracers: &[Tracer<'_, T>],
    points: &[Vector3<T>],
    bounds: &[T],
    name: &str,
) -> Vec<Option<ClosestPoint<T>>> {
    let of_all = |(point, &bound)| tracers[0].closest_point_of_all(point, bound);
    let expected: Vec<_> = points.iter().zip(bounds).map(of_all).collect();
    for tracer in tracers {
        let mut many = Vec::new();
        tracer.closest_points(points, bounds, &mut many);
        assert_eq!(many.len(), points.len());
        for (place, (point, &bound)) in points.iter().zip(bounds).enumerate() {
            let single = tracer.closest_point(point, bound);
            assert_eq!(bits(&single), bits(&expected[place]), "{name}: {point:?} within {bound:?}: {single:?}");
            assert_eq!(bits(&many[place]), bits(&single), "{name}: {point:?} within {bound:?}, among many");
        }
    }
    expected
}

fn all_shapes() -> Vec<(&'static str, Shape)> {
    vec![
        ("tetrahedron", shapes::tetrahedron()),
        ("cube", shapes::cube(1)),
        ("block", shapes::block([4, 3, 2]).turned(0.4, 1.1)),
        ("sphere", shapes::sphere(2)),
        ("torus", shapes::torus(40, 20, 0.4)),
        ("star", shapes::star()),
        ("fan", shapes::fan(40)),
        ("needles", shapes::torus(14, 8, 0.4).map(|[x, y, z]| [x, 1e-5 * y, z]).turned(0.7, 0.3)),
        ("flat", shapes::cube(3).map(|[x, y, _]| [x, y, 0.3 * x + 0.7 * y])),
        ("line", shapes::cube(2).map(|[x, _, _]| [x, x / 3.0, -x])),
        ("dot", shapes::octahedron().map(|_| [0.1, 0.2, 0.3])),
    ]
}

fn check_shapes<T: Scalar>() {
    let mut random = Random::new(7);
    for (name, shape) in all_shapes() {
        // Meshes are refused that have no volume, but may lose it.
        let mut mesh = rest_of(name, &shape).mesh::<T>();
        mesh.set_positions(&shape.rounded()).expect("positions are finite");
        let octrees = [Layout::Bvh, Layout::PaperOctree].map(|layout| Octree::with_layout(&mesh, layout));
        let tracers = octrees.each_ref().map(|octree| octree.tracer(&mesh).expect("it is new"));
        let points = points(&mesh, &mut random);
        let endless = vec![T::INFINITY; points.len()];
        let found = answers(&tracers, &points, &endless, name);
        for (point, found) in points.iter().zip(&found) {
            let found = found.unwrap_or_else(|| panic!("{name}: nothing near {point:?}"));
            let sum = found.weights.iter().fold(T::zero(), |sum, &weight| sum + weight);
            assert!((sum - T::one()).abs() <= T::ROUNDING_UNIT * T::of(2.0), "{name}: {found:?}");
            assert!(found.weights.iter().all(|&weight| weight >= T::zero()), "{name}: {found:?}");
        }
        // Exactly as far, hardly nearer, and half as far.
        let exact: Vec<T> = found.iter().map(|found| found.map_or(T::zero(), |found| found.distance)).collect();
        let again = answers(&tracers, &points, &exact, name);
        assert!(again.iter().map(bits).eq(found.iter().map(bits)), "{name}: as far as it is");
        for factor in [1.0 - 2.0 * T::ROUNDING_UNIT.to_f64(), 0.5] {
            let less: Vec<T> = exact.iter().map(|&distance| distance * T::of(factor)).collect();
            let none = answers(&tracers, &points, &less, name);
            let are_on_it = exact.iter().filter(|&&distance| distance * T::of(factor) == distance).count();
            assert_eq!(none.iter().flatten().count(), are_on_it, "{name}: nearer than it is");
        }
        let more: Vec<T> = exact.iter().map(|&distance| distance * T::of(1.0 + random.signed().abs())).collect();
        assert!(answers(&tracers, &points, &more, name).iter().map(bits).eq(found.iter().map(bits)));
    }
}

/// The same triangles where they have a volume.
fn rest_of(name: &str, shape: &Shape) -> Shape {
    match name {
        "flat" => shapes::cube(3),
        "line" => shapes::cube(2),
        "dot" => shapes::octahedron(),
        _ => shape.clone(),
    }
}

#[test]
fn closest_points_are_those_of_all_triangles_in_f64() {
    check_shapes::<f64>();
}

#[test]
fn closest_points_are_those_of_all_triangles_in_f32() {
    check_shapes::<f32>();
}

/// More points than are put in order at a time, one behind the other and shuffled, some of which are no numbers.
#[test]
fn it_does_not_matter_in_which_order_points_come() {
    let (mesh, mut random) = (shapes::torus(40, 20, 0.4).mesh::<f64>(), Random::new(3));
    let octree = Octree::new(&mesh);
    let tracer = octree.tracer(&mesh).expect("it is new");
    let on_row = |i: usize| Vector3::new((i as f64 * 3e-4).cos() * 1.3, (i as f64 * 3e-4).sin() * 1.3, 0.2);
    let in_row: Vec<_> = (0..9001).map(on_row).collect();
    let mut shuffled: Vec<_> = (0..9001).map(|_| rounded(random.point(1.5))).collect();
    (shuffled[5], shuffled[17], shuffled[5000]) = ([f64::NAN; 3].into(), [f64::INFINITY; 3].into(), [1e300; 3].into());
    for points in [in_row, shuffled] {
        let (mut many, bounds) = (Vec::new(), vec![0.5; points.len()]);
        tracer.closest_points(&points, &bounds, &mut many);
        for (point, found) in points.iter().zip(&many) {
            assert_eq!(bits(found), bits(&tracer.closest_point(point, 0.5)), "{point:?}");
        }
        assert!(many.iter().flatten().count() > 2000);
    }
}

/// On a box the nearest point is that of the box itself, to the bit where its faces lie at whole numbers.
#[test]
fn closest_points_of_a_box_are_known() {
    let mesh = shapes::block([4, 3, 2]).mesh::<f64>();
    let octree = Octree::new(&mesh);
    let tracer = octree.tracer(&mesh).expect("it is new");
    let size = [4.0, 3.0, 2.0];
    let mut random = Random::new(3);
    for _ in 0..2000 {
        let point: Point = random.point(4.0).map(|x| x + 1.5);
        let clamped: Point = std::array::from_fn(|axis| point[axis].clamp(0.0, size[axis]));
        let mut expected = clamped;
        if clamped == point {
            let depth = |axis: usize| point[axis].min(size[axis] - point[axis]);
            let axis = (0..3).min_by(|&a, &b| depth(a).total_cmp(&depth(b))).expect("three");
            expected[axis] = if point[axis] < size[axis] / 2.0 { 0.0 } else { size[axis] };
        }
        let found = tracer.closest_point(&point.into(), f64::INFINITY).expect("it is somewhere");
        let apart: Point = std::array::from_fn(|axis| point[axis] - expected[axis]);
        assert!((found.distance - dot(apart, apart).sqrt()).abs() <= 64.0 * f64::EPSILON * 8.0, "{point:?}: {found:?}");
        assert!((found.position - Vector3::from(expected)).norm() < 1e-14, "{point:?}: {found:?}");
    }
}

/// Where triangles meet, each of them would give the same answer: the order of triangles and corners does not matter.
#[test]
fn triangles_agree_on_their_edges_and_vertices() {
    for shape in [shapes::torus(40, 20, 0.4).turned(0.3, 0.7), shapes::star().turned(0.2, 1.1), shapes::sphere(2)] {
        let mut other = shape.clone();
        other.triangles.reverse();
        other.triangles.iter_mut().enumerate().for_each(|(place, corners)| corners.rotate_left(place % 3));
        let [mesh, other] = [shape, other].map(|shape| shape.mesh::<f64>());
        let [octree, other_octree] = [&mesh, &other].map(Octree::new);
        let tracer = octree.tracer(&mesh).expect("it is new");
        let other = other_octree.tracer(&other).expect("it is new");
        let (mut on_edges, mut random) = (0, Random::new(11));
        for _ in 0..4000 / STRIDE {
            let point = Vector3::from(random.point(2.0));
            let [found, again] =
                [tracer, other].map(|tracer| tracer.closest_point(&point, f64::INFINITY).expect("it is somewhere"));
            assert_eq!(found.distance.to_bits(), again.distance.to_bits(), "{point:?}: {found:?}, {again:?}");
            assert_eq!(found.position, again.position, "{point:?}");
            on_edges += usize::from(found.weights.iter().filter(|&&weight| weight == 0.0).count() == 1);
        }
        assert!(on_edges > 1000 / STRIDE, "only {on_edges} on edges");
    }
}

/// Lengths of a power of two more or less: the same bits, as far as the numbers reach.
#[test]
fn scaling_by_powers_of_two_scales_the_answer() {
    let shape = shapes::torus(20, 10, 0.4).turned(0.3, 0.7);
    let mesh = shape.mesh::<f32>();
    let octree = Octree::new(&mesh);
    let tracer = octree.tracer(&mesh).expect("it is new");
    let points = points(&mesh, &mut Random::new(5));
    for exponent in [-80, -40, -3, 20, 60, 90] {
        let factor = 2f32.powi(exponent);
        let mut scaled = mesh.clone();
        let positions: Vec<[f32; 3]> = mesh.positions().iter().map(|position| (position * factor).into()).collect();
        scaled.set_positions(&positions).expect("finite");
        let octree = Octree::new(&scaled);
        let scaled = octree.tracer(&scaled).expect("it is new");
        for point in &points {
            let found = tracer.closest_point(point, 2.0).map(|found| ClosestPoint {
                position: found.position * factor,
                distance: found.distance * factor,
                ..found
            });
            assert_eq!(
                bits(&scaled.closest_point(&(point * factor), 2.0 * factor)),
                bits(&found),
                "{exponent}: {point:?}"
            );
        }
    }
}

/// Coordinates near the largest and the smallest numbers.
#[test]
fn distances_neither_overflow_nor_vanish() {
    for factor in [1e307, 1e200, 1e-200, 1e-300] {
        let mesh = shapes::torus(14, 8, 0.4).mesh::<f64>();
        let mut scaled = mesh.clone();
        let positions: Vec<[f64; 3]> = mesh.positions().iter().map(|position| (position * factor).into()).collect();
        scaled.set_positions(&positions).expect("finite");
        let octrees = [Layout::Bvh, Layout::PaperOctree].map(|layout| Octree::with_layout(&scaled, layout));
        let octree = Octree::new(&mesh);
        let tracer = octree.tracer(&mesh).expect("it is new");
        let tracers = octrees.each_ref().map(|octree| octree.tracer(&scaled).expect("it is new"));
        let mut random = Random::new(9);
        for _ in 0..50 {
            let point = Vector3::from(random.point(2.0));
            let expected = tracer.closest_point(&point, f64::INFINITY).expect("it is somewhere").distance * factor;
            for tracer in tracers {
                let found = tracer.closest_point(&(point * factor), f64::INFINITY).expect("it is somewhere");
                assert!((found.distance - expected).abs() <= 1e-12 * factor, "{factor}: {found:?}, not {expected}");
            }
        }
    }
}

#[test]
fn points_and_bounds_that_are_no_numbers_have_no_closest_point() {
    let mesh = shapes::cube(1).mesh::<f64>();
    for layout in [Layout::Bvh, Layout::PaperOctree] {
        let octree = Octree::with_layout(&mesh, layout);
        let tracer = octree.tracer(&mesh).expect("it is new");
        for odd in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
            assert_eq!(tracer.closest_point(&Vector3::new(0.5, odd, 0.5), f64::INFINITY), None);
        }
        assert_eq!(tracer.closest_point(&Vector3::zeros(), f64::NAN), None);
        assert_eq!(tracer.closest_point(&Vector3::zeros(), -1.0), None);
        assert!(tracer.closest_point(&mesh.positions()[3], 0.0).is_some_and(|found| found.distance == 0.0));
    }
}
