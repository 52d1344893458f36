//! A contact that stands for many triangles bears on all their vertices, and its opposite on as much of the other surface.

use crate::common::shapes;
use raycontact::contact::{ContactList, DetectionOptions, Sampling, SpreadNumber};
use raycontact::escape::query_pair;
use raycontact::force::{PenaltyLaw, Weighting, add_differential, add_forces};
use raycontact::math::Vector3;
use raycontact::mesh::Mesh;
use raycontact::query::Octree;
use raycontact::scene::Scene;

type Field = [Vec<Vector3<f64>>; 2];

fn found(meshes: [&Mesh<f64>; 2], sampling: Sampling<f64>) -> ContactList<f64> {
    let octrees = meshes.map(Octree::new);
    let mut list = ContactList::default();
    let options = DetectionOptions { sampling, ..DetectionOptions::default() };
    query_pair(meshes[0], &octrees[0], meshes[1], &octrees[1], &options, &mut list).expect("octrees are new");
    list
}

fn law() -> PenaltyLaw {
    PenaltyLaw::new(1.0, 0.0, Weighting::Area).expect("a valid law")
}

fn zero(meshes: [&Mesh<f64>; 2]) -> Field {
    meshes.map(|mesh| vec![Vector3::zeros(); mesh.positions().len()])
}

/// The same bodies, whose vertices are said to be nodes.
fn nodes(meshes: [&Mesh<f64>; 2]) -> [Mesh<f64>; 2] {
    meshes.map(|mesh| {
        let mut mesh = mesh.clone();
        mesh.set_carrier_spacing(0.0).expect("0 is allowed");
        mesh
    })
}

/// A third of the area around each vertex.
fn areas(mesh: &Mesh<f64>) -> Vec<f64> {
    let mut areas = vec![0.0; mesh.positions().len()];
    for (triangle, vertices) in (0..).zip(mesh.topology().triangles()) {
        let part = mesh.scaled_normal(triangle).norm() / 6.0;
        vertices.iter().for_each(|&vertex| areas[vertex as usize] += part);
    }
    areas
}

/// The largest stiffness over mass of any motion, by power iteration; a vertex's mass is its area.
fn largest_eigenvalue(meshes: [&Mesh<f64>; 2], list: &ContactList<f64>) -> f64 {
    let masses = meshes.map(areas);
    let mut count = 0.0;
    let mut motion = zero(meshes);
    motion.iter_mut().flatten().for_each(|vector| {
        count += 1.0;
        *vector = Vector3::from_fn(|axis, _| (count * 12.9898 + f64::from(axis as u32) * 78.233).sin());
    });
    let mut eigenvalue = 0.0;
    for _ in 0..200 {
        let mut forces = zero(meshes);
        add_differential(list, &law(), 1.0, 0.0, &motion, &mut forces);
        for body in 0..2 {
            forces[body].iter_mut().zip(&masses[body]).for_each(|(force, mass)| *force /= -mass);
        }
        eigenvalue = forces.iter().flatten().map(|force| force.norm_squared()).sum::<f64>().sqrt();
        motion = forces.map(|body| body.into_iter().map(|force| force / eigenvalue).collect());
    }
    eigenvalue
}

/// A plate of 1 × 1 × 0.25 with its top at z = 0, moved; each face cut into squares, `cells` along its longer sides.
fn plate(cells: usize, by: [f64; 3]) -> Mesh<f64> {
    let edge = 1.0 / cells as f64;
    shapes::block([cells, cells, cells / 4]).map(|[x, y, z]| [x * edge, y * edge, z * edge - 0.25]).moved(by).mesh()
}

/// Of two plates pressed together: how much each vertex within the rims of the faces carries, as a part of what an even pressure
/// gives it; the most and the least.
fn evenness(meshes: [&Mesh<f64>; 2], list: &ContactList<f64>, depth: f64) -> [f64; 2] {
    let mut forces = zero(meshes);
    add_forces(list, &law(), None::<&[Vec<Vector3<f64>>]>, None, &mut forces);
    let overlap = meshes[0].aabb().intersection(meshes[1].aabb());
    let rim = 0.15;
    let mut range = [f64::MAX, f64::MIN];
    for body in 0..2 {
        let face = if body == 0 { overlap.upper.z } else { overlap.lower.z };
        for ((position, force), area) in meshes[body].positions().iter().zip(&forces[body]).zip(areas(meshes[body])) {
            let is_within =
                |axis: usize| overlap.lower[axis] + rim < position[axis] && position[axis] < overlap.upper[axis] - rim;
            if position.z == face && is_within(0) && is_within(1) {
                let part = force.norm() / (depth * area);
                range = [range[0].min(part), range[1].max(part)];
            }
        }
    }
    range
}

/// The pressure between two plates pressed together is the same all over, but near their rims.
#[test]
fn no_vertex_carries_more_than_twice_what_an_even_pressure_gives_it() {
    let depth = 0.01;
    for cells in [[40, 40], [40, 24], [24, 40], [16, 60], [60, 16], [8, 60]] {
        for shift in [[0.0; 2], [0.013, -0.021], [0.11, 0.07]] {
            // A tenth of the samples, at 0.1, is less even.
            for (tolerance, limit) in [(0.1, 2.0), (0.01, 1.5)] {
                let meshes = [plate(cells[0], [0.0; 3]), plate(cells[1], [shift[0], shift[1], 0.25 - depth])];
                let meshes = meshes.each_ref();
                let list = found(meshes, Sampling::Accuracy(tolerance));
                let [least, most] = evenness(meshes, &list, depth);
                println!("{cells:?}, {shift:?}, {tolerance}: {} contacts, {least:.2} to {most:.2}", list.len());
                assert!(0.4 < least && most < limit, "{cells:?}, {shift:?}, {tolerance}: {least} to {most}");
            }
        }
    }
}

/// The contact patch test: where vertices are said to be nodes, two flush faces load each vertex as an even pressure does, at
/// rims and corners too, however their meshes differ.
#[test]
fn nodes_of_flush_faces_carry_what_an_even_pressure_gives_them() {
    let depth = 0.01;
    for cells in [[4, 8], [8, 4], [12, 20], [20, 28], [40, 24], [16, 60]] {
        for tolerance in [0.1, 0.01] {
            let meshes = [plate(cells[0], [0.0; 3]), plate(cells[1], [0.0, 0.0, 0.25 - depth])];
            let meshes = nodes(meshes.each_ref());
            let meshes = meshes.each_ref();
            let list = found(meshes, Sampling::Accuracy(tolerance));
            let mut forces = zero(meshes);
            add_forces(&list, &law(), None::<&[Vec<Vector3<f64>>]>, None, &mut forces);
            for (mesh, (forces, face)) in meshes.into_iter().zip(forces.iter().zip([0.0, -depth])) {
                let mut expected = vec![0.0; forces.len()];
                for (triangle, vertices) in (0..).zip(mesh.topology().triangles()) {
                    if mesh.corners(triangle).iter().all(|corner| (corner.z - face).abs() < 1e-12) {
                        let part = depth * mesh.scaled_normal(triangle).norm() / 6.0;
                        vertices.iter().for_each(|&vertex| expected[vertex as usize] += part);
                    }
                }
                for (force, expected) in forces.iter().zip(&expected).filter(|(_, expected)| **expected > 0.0) {
                    let off = (force.z.abs() / expected - 1.0).abs();
                    assert!(off < 1e-9, "{cells:?}, {tolerance}: off by {off}");
                }
            }
        }
    }
}

/// An explicit host may take as long a step as with contacts from each triangle. Those from each vertex have shares of their own,
/// by which steps differ more.
#[test]
fn stable_steps_are_as_long_as_with_a_sample_for_each_triangle() {
    let torus = |detail: usize, by| {
        let torus = shapes::torus(2 * detail, detail, 0.4);
        [torus.turned(0.3, 0.8).moved(by), torus]
    };
    let ball = shapes::sphere(4);
    let spike = ball.map(|[x, y, z]| [0.15 * (1.0 + z) * x, 0.15 * (1.0 + z) * y, z]).turned(0.3, 0.4);
    let pairs = [
        ("coarse tori", torus(20, [0.7, 0.1, 0.2])),
        ("tori", torus(40, [0.7, 0.1, 0.2])),
        ("tori, shallow", torus(40, [1.1, 0.2, 0.1])),
        ("fine tori, deep", torus(60, [0.3, 0.2, 0.5])),
        ("a ball in a coarse cube", [ball.moved([0.9, 0.8, 0.7]), shapes::cube(2)]),
        ("a ball in a fine cube", [shapes::sphere(2).moved([0.9, 0.8, 0.7]), shapes::cube(16)]),
        ("a spike in a ball", [spike.moved([0.1, 0.05, 1.3]), ball]),
    ];
    for (name, shapes) in pairs {
        let meshes = shapes.each_ref().map(|shape| shape.mesh());
        let meshes = meshes.each_ref();
        let said = nodes(meshes);
        let of_vertices = largest_eigenvalue(meshes, &found(meshes, Sampling::Vertices));
        // Here the ball carries all of the load, of which vertices give it a half.
        let least = if name == "a ball in a fine cube" { 0.65 } else { 0.8 };
        for tolerance in [0.1, 0.01] {
            let list = found(meshes, Sampling::Accuracy(tolerance));
            let step = (of_vertices / largest_eigenvalue(meshes, &list)).sqrt();
            // Each contact on its triangle alone.
            let mut alone = list.clone();
            alone.contacts.iter_mut().for_each(|contact| contact.spread = SpreadNumber::default());
            let alone = (of_vertices / largest_eigenvalue(meshes, &alone)).sqrt();
            // Where vertices are said to be nodes.
            let list = found(said.each_ref(), Sampling::Accuracy(tolerance));
            let exact = (of_vertices / largest_eigenvalue(said.each_ref(), &list)).sqrt();
            println!("{name}, {tolerance}: {} contacts, step {step:.2}, {exact:.2}, alone {alone:.2}", list.len());
            assert!(step > least && exact > least, "{name}, {tolerance}: {step} {exact}");
        }
    }
}

/// What contacts bear on goes with them, however many threads find them.
#[test]
fn any_number_of_threads_spreads_the_same_loads() {
    let body = |number: u8| {
        shapes::torus(80, 40, 0.4).turned(0.4 * f64::from(number), 0.2).moved([0.0, 0.0, 0.5 * f64::from(number)])
    };
    let with_threads = |count: usize| {
        let mut scene = Scene::new(count).expect("the threads start");
        scene.set_options(DetectionOptions { sampling: Sampling::Accuracy(0.02), ..DetectionOptions::default() });
        let positions = [0, 1, 2, 3].map(|number| {
            let mesh: Mesh<f64> = body(number).mesh();
            let positions = mesh.positions().to_vec();
            let body = scene.add(mesh);
            if number > 1 {
                scene.mesh_mut(body).expect("it is there").set_carrier_spacing(0.0).expect("0 is allowed");
            }
            positions
        });
        let mut list = ContactList::default();
        scene.query(&mut list);
        let mut forces = positions.map(|positions| vec![Vector3::zeros(); positions.len()]);
        add_forces(&list, &law(), None::<&[Vec<Vector3<f64>>]>, None, &mut forces);
        (list, forces)
    };
    let (list, forces) = with_threads(1);
    let loaded = forces.iter().flatten().filter(|force| force.norm() > 0.0).count();
    assert!(loaded > 5 * list.len(), "{loaded} vertices, {} contacts", list.len());
    for count in [2, 3] {
        assert_eq!(with_threads(count), (list.clone(), forces.clone()));
    }
}
