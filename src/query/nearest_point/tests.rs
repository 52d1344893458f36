use super::*;
use crate::mesh::Mesh;
use crate::mesh::test_mesh::{torus_positions, torus_triangles};
use crate::query::octree::{Layout, Octree};
use crate::simd::on_every_path;

/// Points asked one by one, and many at a time.
#[derive(Clone, Copy)]
struct Asked<'a, T: Scalar> {
    tracer: &'a Tracer<'a, T>,
    points: &'a [Vector3<T>],
    bounds: &'a [T],
}

impl<T: Scalar> Kernel<T> for Asked<'_, T> {
    type Output = [Vec<Option<ClosestPoint<T>>>; 2];

    fn run<L: Lanes<T>>(self) -> Self::Output {
        let Self { tracer, points, bounds } = self;
        let mut found = vec![None; points.len()];
        L::outlined(ClosestPoints { tracer, points, bounds, sought: All, found: &mut found });
        let Tree::Bvh(tree) = tracer.tree else { unreachable!("it is the default") };
        let one = |(point, &bound): (&Vector3<T>, &T)| {
            let query = QueryPoint::new(point, &MeshScale::new(tracer.mesh().aabb()))?;
            let mut nearest = Nearest::within(&query, bound);
            tree.find_closest_with::<L>(tracer.mesh(), &query, &mut nearest);
            tracer.resolved(&query, &nearest, bound)
        };
        [found, points.iter().zip(bounds).map(one).collect()]
    }
}

/// On, below and above the surface, in the middle of the tube, scattered and far away; within bounds of all sizes.
fn assert_same_on_all_paths<T: Scalar>() {
    let sides = [48, 12];
    let positions: Vec<_> = torus_positions(sides, 3).into_iter().map(|point| point.map(T::of)).collect();
    let mesh = Mesh::new(&positions, &torus_triangles(sides)).expect("it is closed");
    let octree = Octree::new(&mesh);
    let tracer = octree.tracer(&mesh).expect("it is new");
    let (mut points, mut bounds) = (Vec::new(), Vec::new());
    for (place, position) in mesh.positions().iter().enumerate() {
        let ring = position.xy().normalize();
        let middle = Vector3::new(ring.x, ring.y, T::zero());
        let part = T::of([0.0, 0.1, 0.5, 1.0, 3.0, -200.0, 1e7][place / 20 % 7]);
        let scattered = if place / 100 % 3 == 0 { positions[place * 37 % positions.len()] } else { [T::zero(); 3] };
        points.push(position + (middle - position) * part + Vector3::from(scattered));
        bounds.push(T::of([f64::INFINITY, 0.3, 0.05, 0.0][place / 50 % 4]));
    }
    let expected: Vec<_> =
        points.iter().zip(&bounds).map(|(point, &bound)| tracer.closest_point_of_all(point, bound)).collect();
    assert!(expected.iter().flatten().count() > 200 && expected.contains(&None));
    let answers = on_every_path::<T, _>(Asked { tracer: &tracer, points: &points, bounds: &bounds });
    for (path, [many, one_by_one]) in answers.iter().enumerate() {
        for (place, point) in points.iter().enumerate() {
            let answers = [many[place], one_by_one[place]];
            assert_eq!(answers, [expected[place]; 2], "path {path}, {point:?} within {:?}", bounds[place]);
        }
    }
}

/// The same of the surface without a part of it.
fn assert_same_beyond<T: Scalar>() {
    let sides = [48, 12];
    let positions: Vec<_> = torus_positions(sides, 3).into_iter().map(|point| point.map(T::of)).collect();
    let mesh = Mesh::new(&positions, &torus_triangles(sides)).expect("it is closed");
    // By quarters, one of them of single vertices.
    let parts: Vec<u32> = (0..positions.len() as u32).map(|v| if v < 144 { 9 + v } else { v / 144 }).collect();
    let points: Vec<_> = mesh.positions().iter().take(576).step_by(9).map(|point| point * T::of(0.97)).collect();
    let bounds: Vec<_> = (0..64).map(|v| if v % 2 == 0 { T::INFINITY } else { T::of(0.3) }).collect();
    for layout in [Layout::Bvh, Layout::PaperOctree] {
        let octree = Octree::with_layout(&mesh, layout);
        let tracer = octree.tracer(&mesh).expect("it is new");
        for part in [1, 108, 7777] {
            let beyond = Beyond { parts: &parts, part };
            let expected = points.iter().zip(&bounds).map(|(point, &bound)| {
                let query = QueryPoint::new(point, &MeshScale::new(mesh.aabb()))?;
                let mut nearest = Nearest::within(&query, bound);
                for (triangle, corners) in (0..).zip(mesh.topology().triangles()) {
                    if !corners.iter().any(|&vertex| parts[vertex as usize] == part) {
                        nearest.keep_nearer(tracer.square_to(&query, triangle), triangle);
                    }
                }
                tracer.resolved(&query, &nearest, bound)
            });
            let expected: Vec<_> = expected.collect();
            let asked = AskedBeyond { tracer: &tracer, points: &points, bounds: &bounds, beyond };
            for (path, found) in on_every_path::<T, _>(asked).iter().enumerate() {
                assert_eq!(*found, expected, "{layout:?}, path {path}, part {part}");
            }
            let mut found = vec![None; points.len()];
            tracer.closest_points_beyond((&parts, part), &points, &bounds, &mut found);
            assert_eq!(found, expected, "{layout:?}, part {part}");
        }
    }
}

/// Points beyond a part.
#[derive(Clone, Copy)]
struct AskedBeyond<'a, T: Scalar> {
    tracer: &'a Tracer<'a, T>,
    points: &'a [Vector3<T>],
    bounds: &'a [T],
    beyond: Beyond<'a>,
}

impl<T: Scalar> Kernel<T> for AskedBeyond<'_, T> {
    type Output = Vec<Option<ClosestPoint<T>>>;

    fn run<L: Lanes<T>>(self) -> Self::Output {
        let Self { tracer, points, bounds, beyond } = self;
        let mut found = vec![None; points.len()];
        L::outlined(ClosestPoints { tracer, points, bounds, sought: beyond, found: &mut found });
        found
    }
}

#[test]
fn all_paths_find_the_same_closest_points_beyond_a_part() {
    assert_same_beyond::<f64>();
    assert_same_beyond::<f32>();
}

#[test]
fn all_paths_find_the_same_closest_points() {
    assert_same_on_all_paths::<f64>();
    assert_same_on_all_paths::<f32>();
}
