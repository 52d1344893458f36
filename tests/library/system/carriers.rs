//! What carries a surface decides how many samples its contacts need.

use crate::common::shapes::{self, Shape};
use nalgebra::Vector3;
use raycontact::contact::ContactList;
use raycontact::scene::Scene;
use raycontact::system::{Carriers, ContactSystem, Material, RigidUnknowns};

/// A surface in a lattice of so many nodes along each axis, which fills its box.
struct Caged {
    surface: Shape,
    nodes: [usize; 3],
}

impl Caged {
    fn corner(&self, largest: bool) -> [f64; 3] {
        let choose = |a: f64, b: f64| if largest { a.max(b) } else { a.min(b) };
        let start = self.surface.positions[0];
        self.surface.positions.iter().fold(start, |corner, point| std::array::from_fn(|k| choose(corner[k], point[k])))
    }

    fn places(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        let [x, y, z] = self.nodes;
        (0..x * y * z).map(move |node| [node % x, node / x % y, node / (x * y)])
    }

    fn node_positions(&self) -> Vec<f64> {
        let [lower, upper] = [false, true].map(|largest| self.corner(largest));
        let along = |place: [usize; 3], k: usize| place[k] as f64 / (self.nodes[k] - 1) as f64;
        self.places()
            .flat_map(|place| (0..3).map(move |k| lower[k] + along(place, k) * (upper[k] - lower[k])))
            .collect()
    }

    /// Trilinear weights: offsets, nodes, weights.
    fn weights(&self) -> (Vec<u32>, Vec<u32>, Vec<f64>) {
        let [lower, upper] = [false, true].map(|largest| self.corner(largest));
        let (mut offsets, mut nodes, mut weights) = (vec![0], vec![], vec![]);
        for point in &self.surface.positions {
            let cells = |k: usize| (self.nodes[k] - 1) as f64;
            let at: [f64; 3] = std::array::from_fn(|k| (point[k] - lower[k]) / (upper[k] - lower[k]) * cells(k));
            for (node, place) in self.places().enumerate() {
                let weight: f64 = (0..3).map(|k| (1.0 - (at[k] - place[k] as f64).abs()).max(0.0)).product();
                if weight > 0.0 {
                    nodes.push(node as u32);
                    weights.push(weight);
                }
            }
            offsets.push(nodes.len() as u32);
        }
        (offsets, nodes, weights)
    }
}

struct World {
    scene: Scene<f64>,
    system: ContactSystem<f64>,
    positions: Vec<f64>,
}

impl World {
    /// Caged bodies, and one that stands still.
    fn new(caged: &[Caged], still: Option<Shape>) -> Self {
        let mut scene = Scene::new(1).expect("one thread");
        let mut system = ContactSystem::new(RigidUnknowns::Eliminated);
        let positions: Vec<f64> = caged.iter().flat_map(Caged::node_positions).collect();
        system.set_node_masses(&vec![1.0; positions.len() / 3]).expect("they are positive");
        let material = Material::bearing(1e5, 0.1).expect("both are positive");
        let mut first = 0;
        for body in caged {
            let (offsets, nodes, weights) = body.weights();
            let number = scene.add(body.surface.mesh());
            let carriers = Carriers::Weights { offsets: &offsets, nodes: &nodes, weights: &weights };
            let end = first + body.nodes.iter().product::<usize>() as u32;
            system.add_deformable(&scene, number, first..end, carriers, material).expect("a body");
            first = end;
        }
        if let Some(shape) = still {
            let number = scene.add(shape.mesh());
            system.add_moved(&scene, number, material).expect("a body");
        }
        Self { scene, system, positions }
    }

    /// How many contacts a step has, and the force and torque about the origin on the first so many nodes.
    fn step(&mut self, nodes: usize) -> (usize, [Vector3<f64>; 2]) {
        let rest = vec![0.0; self.positions.len()];
        self.system.begin(&mut self.scene, 0.01, &self.positions, &rest, &rest).expect("a step");
        let mut forces = rest.clone();
        self.system.add_forces(&rest, &mut forces).expect("a step is under way");
        self.system.cancel();
        let mut sums = [Vector3::zeros(); 2];
        for (force, position) in forces.chunks_exact(3).zip(self.positions.chunks_exact(3)).take(nodes) {
            let [force, position] = [force, position].map(Vector3::from_column_slice);
            sums[0] += force;
            sums[1] += position.cross(&force);
        }
        (self.system.contacts().len(), sums)
    }

    /// Has the accuracy alone decide.
    fn forget_carriers(&mut self) {
        let bodies: Vec<u32> = self.scene.body_numbers().collect();
        for body in bodies {
            self.scene.mesh_mut(body).expect("it is there").set_carrier_spacing(0.0).expect("not negative");
        }
    }
}

/// A few samples; the force is what many give, but for a few per cent. As many as ever where the host says so.
#[test]
fn coarse_cages_take_few_samples() {
    let ball = |middle| shapes::sphere(4).scaled(0.5).moved(middle);
    let caged = |middle| Caged { surface: ball(middle), nodes: [3; 3] };
    let aside = [0.7, 0.1, 0.2];
    for mut world in
        [World::new(&[caged([0.0; 3]), caged(aside)], None), World::new(&[caged([0.0; 3])], Some(ball(aside)))]
    {
        let (few, [force, _]) = world.step(27);
        world.forget_carriers();
        let (many, [exact, _]) = world.step(27);
        let off = (force - exact).norm() / exact.norm();
        println!("{few} and {many} contacts, off by {off}");
        assert!((8..=40).contains(&few) && many > 150, "{few} and {many}");
        assert!(off < 0.1, "{off}");
        let mut plain = ContactList::default();
        world.scene.query(&mut plain);
        assert_eq!(plain.len(), many, "the plain scene knows what the host said");
    }
}

/// A tall box in a single cell, whose nodes are farther apart than its base is wide, leans over one edge: the pressure's middle is
/// as near to that edge as with many samples, but for a tenth of the base.
#[test]
fn what_stands_in_a_coarse_cage_does_not_tip_over() {
    for lean in [0.0, 0.01, 0.04, -0.04] {
        let tower =
            shapes::cube(1).map(|[x, y, z]| [0.5 * x, 0.5 * y, 4.0 * (z + 1.0) - 0.02 + lean * x * (1.0 - z) / 2.0]);
        let floor = shapes::cube(1).scaled(3.0).moved([0.0, 0.0, -3.0]);
        let mut world = World::new(&[Caged { surface: tower, nodes: [2; 3] }], Some(floor));
        // The cell is as skew as the box.
        for node in world.positions.chunks_exact_mut(3).filter(|node| node[2] < 4.0) {
            node[2] = -0.02 + lean * node[0] / 0.5;
        }
        let (few, [force, torque]) = world.step(8);
        world.forget_carriers();
        let (many, [exact, exact_torque]) = world.step(8);
        let [middle, exact_middle] = [-torque.y / force.z, -exact_torque.y / exact.z];
        println!("{lean}: {few} and {many} contacts, {force} and {exact}, the middle at {middle} and {exact_middle}");
        assert!(few < many / 3, "{few} and {many}");
        assert!((middle - exact_middle).abs() < 0.1, "{middle}, not {exact_middle}");
        assert!((force.z / exact.z - 1.0).abs() < 0.1, "{force}, not {exact}");
    }
}

/// Two explicit steps of a caged box that has sunk into a floor and lies aside by the second: each part of its lower side is
/// pulled back by a spring as stiff as the floor, whoever carries it.
#[test]
fn friction_of_an_explicit_host_holds_a_caged_body_on_a_half_space() {
    let caged = Caged { surface: shapes::cube(8).scaled(0.2), nodes: [2; 3] };
    let (sunk, aside, stiffness) = (0.002, 1e-4, 1e5);
    let material = Material { stiffness, damping_time: 0.0, friction: 0.5, depth_cap: f64::INFINITY, restitution: 0.0 };
    let mut scene = Scene::<f64>::new(1).expect("no thread is started");
    let body = scene.add(caged.surface.mesh());
    let mut system = ContactSystem::new(RigidUnknowns::Eliminated);
    system.set_node_masses(&[1.0; 8]).expect("masses");
    let (offsets, nodes, weights) = caged.weights();
    let carriers = Carriers::Weights { offsets: &offsets, nodes: &nodes, weights: &weights };
    system.add_deformable(&scene, body, 0..8, carriers, material).expect("a body");
    let floor = caged.corner(false)[2] + sunk;
    system.add_half_space([0.0, 0.0, 1.0], floor, material).expect("a floor");
    let (mut x, still) = (caged.node_positions(), [0.0; 24]);
    for step in 0..2 {
        let mut forces = [0.0; 24];
        system.explicit_step(&mut scene, 1e-3, &x, &still, &mut forces).expect("a step");
        let [along, up] = [0, 2].map(|axis| forces.iter().skip(axis).step_by(3).sum::<f64>());
        // Both surfaces in series; the box's lower side has 0.16 m².
        let spring = 0.5 * stiffness * 0.16;
        assert!((up / (spring * sunk) - 1.0).abs() < 0.1, "{step}: {up} N up");
        assert!((along + spring * aside * f64::from(step)).abs() < 0.1 * spring * aside, "{step}: {along} N along");
        x.iter_mut().step_by(3).for_each(|x| *x += aside);
    }
}
