//! What carries a surface decides how many samples its contacts need.

use crate::common::shapes;
use nalgebra::Vector3;
use raycontact::contact::ContactList;
use raycontact::scene::Scene;
use raycontact::system::{Carriers, ContactSystem, Material, RigidUnknowns};

const SIDE: usize = 3;
const NODES: usize = SIDE * SIDE * SIDE;

/// Two balls of 1 m, 5120 triangles and 27 nodes each, 30 cm deep in one another; or the second one still.
struct World {
    scene: Scene<f64>,
    system: ContactSystem<f64>,
    positions: Vec<f64>,
}

impl World {
    fn new(is_still: bool) -> Self {
        let mut scene = Scene::new(1).expect("one thread");
        let mut system = ContactSystem::new(RigidUnknowns::Eliminated);
        system.set_node_masses(&[1.0; 2 * NODES]).expect("they are positive");
        let material = Material::bearing(1e5, 0.1).expect("both are positive");
        let mut positions = Vec::new();
        for (body, middle) in [[0.0; 3], [0.7, 0.1, 0.2]].into_iter().enumerate() {
            let ball = shapes::sphere(4).scaled(0.5);
            let (mut offsets, mut nodes, mut weights) = (vec![0], vec![], vec![]);
            for point in &ball.positions {
                // In units of cells, from the lattice's first node.
                let at = point.map(|x| (x + 0.5).clamp(0.0, 1.0) * (SIDE - 1) as f64);
                for node in 0..NODES {
                    let place = [node % SIDE, node / SIDE % SIDE, node / (SIDE * SIDE)];
                    let weight: f64 = (0..3).map(|k| (1.0 - (at[k] - place[k] as f64).abs()).max(0.0)).product();
                    if weight > 0.0 {
                        nodes.push(node as u32);
                        weights.push(weight);
                    }
                }
                offsets.push(nodes.len() as u32);
            }
            for node in 0..NODES {
                let place = [node % SIDE, node / SIDE % SIDE, node / (SIDE * SIDE)];
                positions.extend((0..3).map(|k| middle[k] + place[k] as f64 / (SIDE - 1) as f64 - 0.5));
            }
            let number = scene.add(ball.moved(middle).mesh());
            if body == 1 && is_still {
                system.add_moved(&scene, number, material).expect("a body");
                continue;
            }
            let carriers = Carriers::Weights { offsets: &offsets, nodes: &nodes, weights: &weights };
            let range = (body * NODES) as u32..((body + 1) * NODES) as u32;
            system.add_deformable(&scene, number, range, carriers, material).expect("a body");
        }
        Self { scene, system, positions }
    }

    /// How many contacts a step has, and the force on the first body.
    fn step(&mut self) -> (usize, Vector3<f64>) {
        let rest = vec![0.0; 6 * NODES];
        self.system.begin(&mut self.scene, 0.01, &self.positions, &rest, &rest).expect("a step");
        let mut forces = rest.clone();
        self.system.add_forces(&rest, &mut forces).expect("a step is under way");
        self.system.cancel();
        let nodes = forces[..3 * NODES].chunks_exact(3);
        (self.system.contacts().len(), nodes.map(Vector3::from_column_slice).sum())
    }
}

/// No more samples than nodes; the force is what many give, but for a few per cent. As many as ever where the host says so.
#[test]
fn samples_are_as_far_apart_as_the_nodes_of_cages() {
    for is_still in [false, true] {
        let mut world = World::new(is_still);
        let (few, force) = world.step();
        for body in 0..2 {
            world.scene.mesh_mut(body).expect("it is there").set_carrier_spacing(0.0).expect("not negative");
        }
        let (many, exact) = world.step();
        let off = (force - exact).norm() / exact.norm();
        println!("{few} and {many} contacts, off by {off}");
        assert!((5..=NODES).contains(&few) && many > 150, "{few} and {many}");
        assert!(off < 0.1, "{off}");
        let mut plain = ContactList::default();
        world.scene.query(&mut plain);
        assert_eq!(plain.len(), many, "the plain scene knows what the host said");
    }
}
