//! A body moved by a pose is where it would be by its positions: contacts, forces and all that is counted are the same, to
//! the bit.

use crate::common::assert_every_ray_is_counted;
use crate::common::random::Random;
use crate::common::shapes::{self, Shape};
use raycontact::contact::{ContactLaw, ContactList, DetectionOptions, Sampling};
use raycontact::math::{Pose, PoseError, Scalar};
use raycontact::scene::{Scene, SceneError};

/// A rotation by a random unit quaternion.
fn rotation(random: &mut Random) -> [[f64; 3]; 3] {
    let q: [f64; 4] = [0; 4].map(|_| random.signed());
    let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [w, x, y, z] = q.map(|x| x / length);
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

/// The judge: the shape's positions in the precision, moved one by one as the documentation says.
fn moved<T: Scalar>(shape: &Shape, pose: &Pose) -> Vec<[T; 3]> {
    let place = |point: &[T; 3]| {
        let [x, y, z] = point.map(T::to_f64);
        [0, 1, 2].map(|axis| {
            let [a, b, c] = pose.rotation[axis];
            T::of(((a * x + b * y) + c * z) + pose.position[axis])
        })
    };
    shape.rounded::<T>().iter().map(place).collect()
}

fn scene<T: Scalar>(shapes: &[&Shape], options: DetectionOptions<T>, threads: usize) -> Scene<T> {
    let mut scene = Scene::new(threads).expect("the threads start");
    scene.set_options(options);
    shapes.iter().for_each(|shape| _ = scene.add(shape.mesh()));
    scene
}

fn place<T: Scalar>(scene: &mut Scene<T>, body: u32, shape: &Shape, pose: &Pose) {
    scene.mesh_mut(body).expect("it is there").set_positions(&moved(shape, pose)).expect("finite");
}

fn query<T: Scalar>(scene: &mut Scene<T>) -> ContactList<T> {
    let mut list = ContactList::default();
    scene.query(&mut list);
    assert_every_ray_is_counted(&list);
    list
}

fn bodies() -> [Shape; 4] {
    let bumpy = shapes::torus(48, 24, 0.45).map(|p| p.map(|x| x * (1.0 + 0.1 * (5.0 * x).sin())));
    let cube = shapes::cube(6);
    [bumpy, cube, shapes::torus(96, 48, 0.4), shapes::octahedron()]
}

fn all_options<T: Scalar>() -> Vec<DetectionOptions<T>> {
    let with = |sampling| DetectionOptions { sampling, ..DetectionOptions::default() };
    let ray_length = DetectionOptions { law: ContactLaw::RayLength, ..DetectionOptions::default() };
    let folds = DetectionOptions { past_folds: true, ..DetectionOptions::default() };
    vec![
        DetectionOptions::default(),
        DetectionOptions::paper(),
        DetectionOptions { edges: true, ..DetectionOptions::paper() },
        with(Sampling::Vertices),
        with(Sampling::Spacing(T::of(0.15))),
        with(Sampling::Accuracy(T::of(0.02))),
        ray_length,
        folds,
    ]
}

fn assert_same_by_pose_and_by_positions<T: Scalar>(seed: u64) {
    let shapes = bodies();
    let shapes: Vec<&Shape> = shapes.iter().collect();
    let mut found = 0;
    for (number, options) in all_options::<T>().into_iter().enumerate() {
        let mut random = Random::new(seed + number as u64);
        let mut by_pose = scene(&shapes, options, 1);
        let mut on_threads = scene(&shapes, options, 3);
        let mut by_positions = scene(&shapes, options, 1);
        for step in 0..14 {
            for (body, shape) in (0..).zip(&shapes) {
                // Some stay where they are, one is moved by positions between poses, and one is sometimes far away.
                if (step + body) % 4 == 3 {
                    continue;
                }
                let reach = if step % 5 == 4 && body == 2 { 20.0 } else { 0.8 };
                let pose = Pose { position: random.point(reach), rotation: rotation(&mut random) };
                place(&mut by_positions, body, shape, &pose);
                for scene in [&mut by_pose, &mut on_threads] {
                    if body == 1 && step % 3 == 1 {
                        place(scene, body, shape, &pose);
                    } else {
                        scene.set_pose(body, &pose).expect("it is a pose");
                    }
                    let [moved, expected] =
                        [&*scene, &by_positions].map(|scene| scene.mesh(body).expect("it is there"));
                    assert_eq!(moved.aabb(), expected.aabb());
                }
            }
            let expected = query(&mut by_positions);
            for scene in [&mut by_pose, &mut on_threads] {
                let list = query(scene);
                assert_eq!(list, expected, "{options:?}, step {step}");
                assert_eq!(query(scene), expected, "again");
                assert_eq!(scene.pair_memories(), by_positions.pair_memories());
            }
            found += expected.len();
            for body in 0..shapes.len() as u32 {
                let [moved, expected] = [&by_pose, &by_positions].map(|scene| scene.mesh(body).expect("it is there"));
                if step % 4 == 0 {
                    assert_eq!(moved.positions(), expected.positions());
                }
            }
        }
    }
    assert!(found > 10_000, "{found}");
}

#[test]
fn contacts_by_pose_are_those_by_positions_in_double_precision() {
    assert_same_by_pose_and_by_positions::<f64>(1);
}

#[test]
fn contacts_by_pose_are_those_by_positions_in_single_precision() {
    assert_same_by_pose_and_by_positions::<f32>(100);
}

/// Bodies that overlap without a ray that tells, are swallowed, or escape from one another for many steps.
#[test]
fn edges_and_escapes_are_the_same() {
    let (plate, ball) =
        (shapes::block([40, 40, 1]).map(|[x, y, z]| [x - 20.0, y - 20.0, 0.1 * z]), shapes::icosahedron());
    let shapes = [&plate, &ball, &shapes::torus(64, 32, 0.4)];
    let options = DetectionOptions { edges: true, sampling: Sampling::Vertices, ..DetectionOptions::default() };
    let mut random = Random::new(3);
    let (mut by_pose, mut by_positions) = (scene::<f64>(&shapes, options, 1), scene(&shapes, options, 1));
    let (mut edges, mut escapes) = (0, 0);
    for step in 0..60 {
        let turn = rotation(&mut random);
        for (body, shape) in (0..).zip(shapes) {
            // Shallow, then deep, then twice in the same place.
            let far = [2.0, 0.4, 0.0][step / 20] * f64::from(body);
            let position = [far + 1e-3 * random.signed(), 0.1 * random.signed(), 0.6 * far];
            let rotation = if body == 0 { Pose::IDENTITY.rotation } else { turn };
            let pose = Pose { position, rotation };
            by_pose.set_pose(body, &pose).expect("it is a pose");
            place(&mut by_positions, body, shape, &pose);
        }
        let (list, expected) = (query(&mut by_pose), query(&mut by_positions));
        assert_eq!(list, expected, "step {step}");
        assert_eq!(list.pushes(), expected.pushes());
        edges += list.statistics.edge_contacts;
        escapes += list.statistics.escape_contacts;
    }
    assert!(escapes > 0);
    // Bars that cross, with no vertex of one in the other.
    let bar = |half: [f64; 3]| shapes::cube(1).map(|point| [0, 1, 2].map(|axis| half[axis] * point[axis]));
    let bars = [&bar([1.0, 0.1, 0.1]), &bar([0.11, 1.0, 0.12])];
    let (mut by_pose, mut by_positions) = (scene::<f64>(&bars, options, 1), scene(&bars, options, 1));
    for step in 0..10 {
        let pose = Pose { position: [0.02 + 1e-3 * f64::from(step), 0.0, 0.15], ..Pose::IDENTITY };
        by_pose.set_pose(1, &pose).expect("it is a pose");
        place(&mut by_positions, 1, bars[1], &pose);
        let (list, expected) = (query(&mut by_pose), query(&mut by_positions));
        assert_eq!(list, expected, "bars, step {step}");
        edges += list.statistics.edge_contacts;
    }
    assert!(edges > 0);
}

/// A body with contacts with itself turns with them, and one that is switched on or off between poses.
#[test]
fn self_collision_is_the_same() {
    // A part of it lies across another.
    let band = shapes::torus(32, 16, 0.4).joined(&shapes::sphere(1).moved([1.0, 0.9, 0.0]));
    let shapes = [&band, &shapes::cube(4)];
    let options = DetectionOptions::default;
    let (mut by_pose, mut by_positions) = (scene::<f64>(&shapes, options(), 1), scene(&shapes, options(), 1));
    let mut random = Random::new(11);
    let mut own = 0;
    for step in 0..12 {
        let pose = Pose { position: random.point(0.5), rotation: rotation(&mut random) };
        by_pose.set_pose(0, &pose).expect("it is a pose");
        place(&mut by_positions, 0, &band, &pose);
        for scene in [&mut by_pose, &mut by_positions] {
            scene.set_self_collision(0, step % 4 != 0).expect("it is there");
        }
        let (list, expected) = (query(&mut by_pose), query(&mut by_positions));
        assert_eq!(list, expected, "step {step}");
        assert_eq!(query(&mut by_pose), expected, "again, step {step}");
        own += list.contacts.iter().filter(|contact| contact.colliding == contact.collided).count();
    }
    assert!(own > 0);
}

/// What is left when a body is given its shape back, and what a scene gives back.
#[test]
fn a_pose_is_from_the_first_positions_and_poses_do_not_add_up() {
    let shape = shapes::torus(48, 24, 0.4);
    let mut scene = scene::<f64>(&[&shape], DetectionOptions::default(), 1);
    let mut random = Random::new(5);
    let squeezed = shape.map(|[x, y, z]| [x, y, 0.5 * z]).positions;
    for _ in 0..5 {
        scene.mesh_mut(0).expect("it is there").set_positions(&squeezed).expect("finite");
        for _ in 0..2 {
            let pose = Pose { position: random.point(3.0), rotation: rotation(&mut random) };
            scene.set_pose(0, &pose).expect("it is a pose");
            let (mesh, expected) = (scene.mesh(0).expect("it is there"), moved::<f64>(&shape, &pose));
            assert_eq!(mesh.clone().positions(), mesh.positions());
            assert!(
                mesh.positions()
                    .iter()
                    .zip(expected)
                    .all(|(position, expected)| <[f64; 3]>::from(*position) == expected)
            );
        }
    }
    scene.set_pose(0, &Pose::IDENTITY).expect("it is a pose");
    let removed = scene.remove(0).expect("it is there");
    assert!(removed.positions().iter().zip(&shape.positions).all(|(a, b)| <[f64; 3]>::from(*a) == *b));
}

#[test]
fn what_is_no_pose_changes_nothing() {
    let shapes = [&shapes::torus(48, 24, 0.4), &shapes::cube(4)];
    let mut scene = scene::<f32>(&shapes, DetectionOptions::default(), 1);
    let good = Pose { position: [0.4, 0.2, 0.1], ..Pose::IDENTITY };
    scene.set_pose(0, &good).expect("it is a pose");
    let before = query(&mut scene);
    let rotated = |row: usize, column: usize, entry: f64| {
        let mut pose = good;
        pose.rotation[row][column] = entry;
        pose
    };
    let wrong = [
        (Pose { position: [0.0, f64::NAN, 0.0], ..good }, "coordinate 1 of the pose's position is not finite"),
        (rotated(2, 1, f64::INFINITY), "row 2 and column 1 is not finite"),
        (rotated(0, 0, 1.1), "no rotation matrix"),
        (rotated(0, 1, 1e-3), "no rotation matrix"),
        (rotated(0, 0, -1.0), "mirrors"),
        (Pose { position: [0.0, 0.0, 1e39], ..good }, "beyond the largest number"),
        (Pose { position: [-1e308; 3], ..good }, "beyond the largest number"),
    ];
    for (pose, said) in wrong {
        let error = scene.set_pose(0, &pose).expect_err(said);
        assert!(error.to_string().contains(said) && error.to_string().starts_with("body 0"), "{error}");
        assert_eq!(query(&mut scene), before);
    }
    assert!(matches!(scene.set_pose(7, &good), Err(SceneError::UnknownBody { body: 7 })));
    let nan = Pose { position: [f64::NAN; 3], ..good };
    assert!(matches!(
        scene.set_pose(0, &nan),
        Err(SceneError::Pose { body: 0, source: PoseError::Position { axis: 0 } })
    ));
}

/// Next to the largest numbers; those beyond are refused in the test above, in single precision.
#[test]
fn huge_coordinates_move_as_far_as_the_precision_reaches() {
    let shape = shapes::torus(48, 24, 0.4).scaled(2f64.powi(505));
    let mut scene = scene::<f64>(&[&shape], DetectionOptions::default(), 1);
    let mut random = Random::new(9);
    for _ in 0..20 {
        let pose = Pose { position: random.point(2f64.powi(1022)), rotation: rotation(&mut random) };
        scene.set_pose(0, &pose).expect("it is in range");
        let mesh = scene.mesh(0).expect("it is there");
        let mut judge = shape.mesh::<f64>();
        judge.set_positions(&moved(&shape, &pose)).expect("finite");
        assert_eq!((mesh.aabb(), mesh.positions()), (judge.aabb(), judge.positions()));
    }
}

/// The same pose again counts as positions given again: it ends a step, and its contacts are the same.
#[test]
fn the_same_pose_again_ends_a_step() {
    let shapes = [&shapes::cube(3), &shapes::cube(2).scaled(0.4)];
    let (mut by_pose, mut by_positions) =
        (scene::<f64>(&shapes, DetectionOptions::default(), 1), scene(&shapes, DetectionOptions::default(), 1));
    let pose = Pose { position: [0.1, 0.0, 0.05], ..Pose::IDENTITY };
    for _ in 0..40 {
        by_pose.set_pose(1, &pose).expect("it is a pose");
        place(&mut by_positions, 1, shapes[1], &pose);
        assert_eq!(query(&mut by_pose), query(&mut by_positions));
        assert_eq!(by_pose.pair_memories(), by_positions.pair_memories());
    }
}
