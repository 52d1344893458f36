use crate::math::{Aabb, Pose, Scalar, Vector3};
use crate::mesh::Mesh;
use crate::mesh::test_mesh::{cube_about, torus_at};
use crate::query::Octree;
use crate::triangle::{ClosestPoint, Ray};

const SIDES: [u32; 2] = [96, 24];

/// Turned about two axes, and moved.
fn pose(step: u32) -> Pose {
    let step = f64::from(step);
    let ((sin, cos), (sin_x, cos_x)) = ((0.9 * step).sin_cos(), (1.7 * step).sin_cos());
    let rotation = [[cos, -sin, 0.0], [cos_x * sin, cos_x * cos, -sin_x], [sin_x * sin, sin_x * cos, cos_x]];
    Pose { position: [0.3 * step.cos(), 0.2 * step, -0.1 * step], rotation }
}

fn follow<T: Scalar>(mesh: &mut Mesh<T>, octree: &mut Octree<T>, pose: &Pose) {
    let aabb = octree.moved_box(mesh, pose).expect("it is in range");
    mesh.follow(pose, aabb);
}

fn placed_count<T: Scalar>(mesh: &Mesh<T>) -> usize {
    mesh.placed_positions().iter().filter(|position| position.x.is_finite()).count()
}

/// The judge: the same mesh at positions of its own, and every triangle tested.
fn assert_same<T: Scalar>(mesh: &Mesh<T>, octree: &Octree<T>, judge: &Mesh<T>) {
    assert_eq!(mesh.aabb(), judge.aabb());
    let judge_tree = Octree::new(judge);
    let (tracer, expected) = (octree.tracer(mesh).expect("fresh"), judge_tree.tracer(judge).expect("fresh"));
    let origins: Vec<_> = judge
        .positions()
        .iter()
        .step_by(if cfg!(debug_assertions) { 290 } else { 29 })
        .map(|&p| p * T::of(0.9))
        .collect();
    let direction = |p: &Vector3<T>| Vector3::new(p.y, T::of(0.3) - p.x, p.z + T::of(0.1));
    let rays: Vec<_> = origins.iter().map(|p| Ray::new(*p, direction(p))).collect();
    let (mut hits, mut crossings, mut all) = (Vec::new(), Vec::new(), Vec::new());
    tracer.nearest_hits(&rays, &mut hits);
    assert!(hits.iter().any(Option::is_some));
    for (ray, hit) in rays.iter().zip(&hits) {
        let of_all = expected.nearest_hit_of_all(ray);
        assert_eq!((*hit, tracer.nearest_hit(ray)), (of_all, of_all), "{ray:?}");
        tracer.crossings(ray, &mut crossings);
        expected.crossings(ray, &mut all);
        assert_eq!(crossings, all);
    }
    for point in &origins {
        let [found, of_all]: [Option<ClosestPoint<T>>; 2] =
            [&tracer, &expected].map(|tracer| tracer.closest_point(point, T::INFINITY));
        assert_eq!(found, of_all);
    }
}

fn assert_follows<T: Scalar>() {
    let (mut mesh, mut judge) = (torus_at::<T>(SIDES, 1), torus_at::<T>(SIDES, 1));
    let mut octree = Octree::new(&mesh);
    let mut tiles = Vec::new();
    for step in 0..9 {
        let moved: Vec<[T; 3]> = mesh.reference_positions().iter().map(|p| pose(step).moved(p).into()).collect();
        judge.set_positions(&moved).expect("finite");
        follow(&mut mesh, &mut octree, &pose(step));
        assert_eq!(placed_count(&mesh), 0, "nobody has asked");
        // Far away, then about a vertex, then about another at the same pose.
        let corner = judge.positions()[100 * step as usize];
        let regions =
            [cube_about(Vector3::repeat(T::of(99.0)), 1.0), cube_about(corner, 0.1), cube_about(-corner, 0.2)];
        let mut before = 0;
        for (number, region) in regions.iter().enumerate() {
            let updated = octree.update_in(&mut mesh, &regions[number..=number], usize::MAX, true, &mut tiles);
            updated.expect("its own");
            let placed = placed_count(&mesh);
            assert!(placed >= before && placed < mesh.positions().len() / 3, "{placed}");
            assert_eq!(placed > 0, number > 0);
            let inside: Vec<_> = (0..).zip(judge.positions()).filter(|(_, p)| region.contains(p)).collect();
            assert!(inside.iter().all(|&(vertex, p)| mesh.placed_positions()[vertex as usize] == *p));
            assert_same(&mesh, &octree, &judge);
            assert_eq!(placed_count(&mesh), placed, "rays place nothing");
            before = placed;
        }
        match step % 4 {
            // By positions in between, which the tree follows in part or as a whole.
            1 => {
                judge
                    .set_positions(&moved.iter().map(|p| p.map(|x| x * T::of(1.5))).collect::<Vec<_>>())
                    .expect("finite");
                mesh.set_positions(&judge.positions().iter().map(|&p| p.into()).collect::<Vec<_>>()).expect("finite");
                octree.update_in(&mut mesh, &regions[1..], usize::MAX, true, &mut tiles).expect("its own");
                assert_same(&mesh, &octree, &judge);
            }
            2 => {
                octree.update(&mesh).expect("its own");
                assert_same(&mesh, &octree, &judge);
            }
            3 => {
                mesh.settle();
                octree.update(&mesh).expect("its own");
                assert_eq!(octree.validate(&mesh), Ok(()));
                assert_same(&mesh, &octree, &judge);
            }
            _ => {}
        }
    }
}

#[test]
fn a_tree_follows_poses_where_it_is_asked_to() {
    assert_follows::<f64>();
    assert_follows::<f32>();
}

/// Rotations by right angles, whose faces reach equally far at many vertices, and ones that are almost such.
#[test]
fn the_box_of_a_moved_body_is_the_smallest() {
    let mut mesh = torus_at::<f32>(SIDES, 1);
    let flat: Vec<_> = mesh.positions().iter().map(|p| p.map(|x| x.clamp(-0.9, 0.7)).into()).collect();
    mesh = Mesh::new(&flat, mesh.topology().triangles()).unwrap_or(mesh);
    let mut octree = Octree::new(&mesh);
    let turns = [0.0, 1.0, 0.0, -1.0];
    for quarter in 0..4 {
        for tilt in [0.0, 1e-17, 1e-9, -1e-7] {
            let (cos, sin) = (turns[(quarter + 1) % 4], turns[quarter]);
            let rotation = [[cos, -sin, tilt], [sin, cos, 0.0], [-tilt * cos, tilt * sin, 1.0]];
            let pose = Pose { position: [0.1, -7.0, 1e3], rotation };
            assert_eq!(pose.check(), Ok(()));
            let mut expected = Aabb::empty();
            let surface = mesh.topology().surface_vertices().iter();
            surface.for_each(|&vertex| expected.include(&pose.moved(&mesh.reference_positions()[vertex as usize])));
            assert_eq!(octree.moved_box(&mesh, &pose), Some(expected), "{pose:?}");
        }
    }
}
