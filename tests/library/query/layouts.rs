//! Both layouts, built and updated through every kind of motion: whole after every step, and with the same hits as an
//! octree built anew and as testing every triangle.

use crate::common::STRIDE;
use crate::common::shapes::{self, Point, Shape};
use raycontact::contact::{Contact, ContactList, DetectionOptions};
use raycontact::escape::query_pair;
use raycontact::math::{Scalar, Vector3};
use raycontact::mesh::Mesh;
use raycontact::query::{Layout, Octree, OctreeError};
use raycontact::scene::Scene;
use raycontact::triangle::Ray;

const LAYOUTS: [Layout; 2] = [Layout::Bvh, Layout::PaperOctree];

/// A step of a motion: where a point at rest goes.
type Step = fn(Point) -> Point;

/// Motions from rest to the extreme and back, mixed: each step follows the one before.
const MOTIONS: [(&str, &[Step]); 9] = [
    ("rigid", &[|p| turned(p, 0.3), |p| turned(p, 2.0), |[x, y, z]| [x + 5.0, y - 1.0, z + 100.0], |p| p]),
    ("large deformation", &[|p| p.map(|x| x * x * x), |[x, y, z]| [x + 2.0 * y * y, y - z, z * (1.5 + x)], |p| p]),
    ("to a plane", &[|[x, y, z]| [x, y, z * 1e-9], |[x, y, _]| [x, y, 0.25], |[x, _, z]| [x, -0.5, z], |p| p]),
    ("to an oblique plane", &[|[x, y, _]| [x, y, 0.3 * x + 0.7 * y], |p| p]),
    ("to a line", &[|[x, _, _]| [x, 0.0, 0.0], |[x, _, _]| [x, x / 3.0, -x], |p| p]),
    ("to a point", &[|_| [0.0; 3], |_| [0.1, 0.2, 0.3], |p| p]),
    ("to 1e30", &[|p| p.map(|x| x * 1e30), |[x, y, z]| [x * 1e30, y, z], |p| p.map(|x| x * 1e-30), |p| p]),
    ("inside out", &[|p| p.map(|x| -x), |[x, y, z]| [y, x, z], |p| p]),
    ("tiny and far", &[|p| p.map(|x| x * 1e-9), |[x, y, z]| [1e6 + x, y - 1e6, z], |p| p]),
];

fn turned([x, y, z]: Point, angle: f64) -> Point {
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y, z]
}

fn all_shapes() -> Vec<(&'static str, Shape)> {
    vec![
        ("tetrahedron", shapes::tetrahedron()),
        ("cube of 12 triangles", shapes::cube(1)),
        ("cube of 192 triangles", shapes::cube(4)),
        ("octahedron", shapes::octahedron()),
        ("sphere", shapes::sphere(1)),
        ("torus", shapes::torus(14, 8, 0.4)),
        ("star", shapes::star()),
        ("rod", shapes::block([12, 1, 1]).map(|[x, y, z]| [x - 6.0, y - 0.5, z - 0.5])),
    ]
}

/// Rays from inside, from outside and from vertices, to vertices and past them.
fn rays<T: Scalar>(mesh: &Mesh<T>) -> Vec<Ray<T>> {
    let positions = mesh.positions();
    let stride = (positions.len() / 24).max(1) * STRIDE;
    let mut rays = Vec::new();
    for (place, &towards) in positions.iter().enumerate().step_by(stride) {
        let other = positions[(7 * place + 3) % positions.len()];
        let middle = (towards + other) * T::of(0.5);
        let aside = Vector3::new(0.3, -0.2, 0.1).map(T::of);
        for origin in [Vector3::zeros(), other, middle, Vector3::new(3.0, 2.0, 1.0).map(T::of)] {
            rays.push(Ray::new(origin, towards - origin));
            rays.push(Ray::new(origin, towards - origin + aside));
        }
        rays.push(Ray::new(middle, Vector3::z()));
    }
    rays
}

fn assert_same_hits<T: Scalar>(mesh: &Mesh<T>, updated: &Octree<T>, fresh: &Octree<T>, name: &str) {
    let [updated, fresh] = [updated, fresh].map(|octree| octree.tracer(mesh).expect("the octree is fresh"));
    let rays = rays(mesh);
    let mut hits = Vec::new();
    updated.nearest_hits(&rays, &mut hits);
    for (ray, hit) in rays.iter().zip(&hits) {
        let expected = fresh.nearest_hit_of_all(ray);
        assert_eq!(*hit, expected, "{name}: {ray:?}");
        assert_eq!(updated.nearest_hit(ray), expected, "{name}: {ray:?}");
        assert_eq!(fresh.nearest_hit(ray), expected, "{name}, built anew: {ray:?}");
    }
}

fn check_grid<T: Scalar>() {
    for (shape_name, shape) in all_shapes() {
        let mut mesh = shape.mesh::<T>();
        let mut octrees = LAYOUTS.map(|layout| Octree::with_layout(&mesh, layout));
        for (motion_name, steps) in MOTIONS {
            for (number, step) in steps.iter().enumerate() {
                mesh.set_positions(&shape.map(step).rounded()).expect("positions are finite");
                for (octree, layout) in octrees.iter_mut().zip(LAYOUTS) {
                    let name = format!("{shape_name}, {motion_name}, step {number}, {layout:?}");
                    assert_eq!(octree.validate(&mesh), Err(OctreeError::Stale.to_string()), "{name}");
                    octree.update(&mesh).expect("the octree is the mesh's own");
                    octree.validate(&mesh).unwrap_or_else(|what| panic!("{name}: {what}"));
                    let fresh = Octree::with_layout(&mesh, layout);
                    fresh.validate(&mesh).unwrap_or_else(|what| panic!("{name}, built anew: {what}"));
                    assert_same_hits(&mesh, octree, &fresh, &name);
                }
            }
        }
    }
}

#[test]
fn updates_keep_octrees_whole_in_f64() {
    check_grid::<f64>();
}

#[test]
fn updates_keep_octrees_whole_in_f32() {
    check_grid::<f32>();
}

#[test]
fn updating_twice_changes_nothing() {
    let mesh = shapes::torus(20, 10, 0.4).mesh::<f64>();
    for layout in LAYOUTS {
        let mut octree = Octree::with_layout(&mesh, layout);
        octree.update(&mesh).expect("the octree is the mesh's own");
        octree.update(&mesh).expect("the octree is the mesh's own");
        octree.validate(&mesh).expect("the octree is whole");
    }
}

#[test]
fn an_octree_serves_its_own_mesh_alone() {
    let mesh = shapes::cube(1).mesh::<f64>();
    let other = shapes::cube(1).mesh::<f64>();
    for layout in LAYOUTS {
        let mut octree = Octree::with_layout(&mesh, layout);
        assert_eq!(octree.update(&other), Err(OctreeError::OtherMesh));
        let refused = octree.tracer(&other).expect_err("it is another mesh").to_string();
        assert!(refused.contains("was built for another mesh"), "{refused}");
        octree.validate(&mesh).expect("nothing was changed");
    }
}

/// A case the oracle found: cells must not be measured from the world's origin, where their planes are rounded.
#[test]
fn cells_hold_far_from_the_origin() {
    let sphere = shapes::sphere(1).map(|point| point.map(|x| (x * 1024.0).round() / 1024.0));
    for exponent in [10.0, 20.0, 30.0, 40.0f64] {
        let offset = exponent.exp2();
        let mesh = sphere.moved([offset, 0.5 * offset, -offset]).mesh::<f64>();
        for layout in LAYOUTS {
            let octree = Octree::with_layout(&mesh, layout);
            octree.validate(&mesh).expect("the octree is whole");
            let tracer = octree.tracer(&mesh).expect("the octree is fresh");
            for (place, &origin) in mesh.positions().iter().enumerate() {
                let towards = mesh.positions()[(5 * place + 1) % mesh.positions().len()];
                for direction in [towards - origin, Vector3::new(0.25, -0.5, 0.75)] {
                    let ray = Ray::new(origin, direction);
                    assert_eq!(tracer.nearest_hit(&ray), tracer.nearest_hit_of_all(&ray), "{layout:?}, {ray:?}");
                }
            }
        }
    }
}

/// A scene's octrees know exactly only what lies near other bodies: over steps in which bodies come near, leave, rest and
/// deform, its contacts are those of octrees updated whole.
fn check_regions<T: Scalar>(options: &DetectionOptions<T>) {
    let shapes = [shapes::torus(96, 24, 0.3), shapes::torus(80, 20, 0.4), shapes::sphere(4)];
    let mut meshes = shapes.each_ref().map(Shape::mesh::<T>);
    let mut octrees = meshes.each_ref().map(Octree::new);
    let mut scene = Scene::new(1).expect("no thread is started");
    scene.set_options(*options);
    let bodies = meshes.each_ref().map(|mesh| scene.add(mesh.clone()));
    let (mut found, mut touching) = (ContactList::default(), 0);
    for step in 0..40 {
        let time = 0.3 * f64::from(step);
        // The second body rests every other step, the third leaves for a while.
        let moves = [
            [0.0, 0.02 * time.sin(), 0.0],
            [2.55 * (time - time % 0.6).cos(), 2.55 * (time - time % 0.6).sin(), 0.2],
            [-1.9 * time.sin(), 1.9 * time.cos(), if step % 10 < 3 { 30.0 } else { 0.1 }],
        ];
        for number in 0..3 {
            if number == 1 && step % 2 == 1 {
                continue;
            }
            let [x, y, z] = moves[number];
            let ripple = |p: Point| 1.0 + 0.02 * (4.0 * p[0] - 3.0 * p[1] + time).sin();
            let moved = |p: &Point| [p[0] * ripple(*p) + x, p[1] + y, p[2] * ripple(*p) + z].map(T::of);
            let positions: Vec<_> = shapes[number].positions.iter().map(moved).collect();
            meshes[number].set_positions(&positions).expect("finite");
            scene.mesh_mut(bodies[number]).expect("it was added").set_positions(&positions).expect("finite");
            octrees[number].update(&meshes[number]).expect("its own");
        }
        scene.query(&mut found);
        let mut expected = ContactList::default();
        for (a, b) in [(0, 1), (0, 2), (1, 2)] {
            let mut pair = ContactList::default();
            query_pair(&meshes[a], &octrees[a], &meshes[b], &octrees[b], options, &mut pair).expect("up to date");
            let number = |body: u32| bodies[if body == 0 { a } else { b }];
            expected.contacts.extend(pair.contacts.into_iter().map(|contact| Contact {
                colliding: number(contact.colliding),
                collided: number(contact.collided),
                ..contact
            }));
        }
        // Where in its list a contact has what it bears on is another place in each.
        found.contacts.iter_mut().chain(&mut expected.contacts).for_each(|contact| contact.spread = Default::default());
        assert_eq!(found.contacts, expected.contacts, "step {step}");
        touching += usize::from(!found.is_empty());
    }
    assert!(touching > 20, "{touching}");
}

#[test]
fn scenes_look_closely_only_where_bodies_meet() {
    check_regions(&DetectionOptions::<f64>::paper());
    check_regions(&DetectionOptions::<f32>::default());
}
