//! Two octahedra of masses and springs start deep in one another, and contact forces push them apart. The tutorial
//! (docs/tutorial.md) has the same program in C++, C and Python.

use raycontact::contact::ContactList;
use raycontact::force::{PenaltyLaw, Weighting, add_forces};
use raycontact::math::Vector3;
use raycontact::mesh::Mesh;
use raycontact::scene::Scene;
use std::error::Error;

const OCTAHEDRON: [[f64; 3]; 6] =
    [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
const FACES: [[u32; 3]; 8] = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
const TIME_STEP: f64 = 0.002; // s
const MASS: f64 = 0.1; // kg for each vertex

struct Body {
    number: u32, // in the scene
    positions: Vec<Vector3<f64>>,
    velocities: Vec<Vector3<f64>>,
}

impl Body {
    fn add_to(scene: &mut Scene<f64>, aside: f64) -> Result<Self, Box<dyn Error>> {
        let positions = OCTAHEDRON.map(|[x, y, z]| [x + aside, y, z]);
        let number = scene.add(Mesh::new(&positions, &FACES)?);
        Ok(Self { number, positions: positions.map(Vector3::from).to_vec(), velocities: vec![Vector3::zeros(); 6] })
    }

    /// Springs of 50 N/m between all vertices.
    fn add_springs(&self, forces: &mut [Vector3<f64>]) {
        for i in 0..6 {
            for j in 0..i {
                let rest = (Vector3::from(OCTAHEDRON[j]) - Vector3::from(OCTAHEDRON[i])).norm();
                let between = self.positions[j] - self.positions[i];
                let tension = 50.0 * (1.0 - rest / between.norm()) * between;
                forces[i] += tension;
                forces[j] -= tension;
            }
        }
    }
}

/// What the program prints, line by line.
pub fn run() -> Result<Vec<String>, Box<dyn Error>> {
    let mut scene = Scene::new(1)?; // one thread
    let mut bodies = [Body::add_to(&mut scene, 0.0)?, Body::add_to(&mut scene, 0.5)?];
    let mut contacts = ContactList::default();
    // N/m³: pressure for each metre below the surface; and s.
    let law = PenaltyLaw::new(100.0, 0.05, Weighting::default())?;
    let mut lines = Vec::new();
    for step in 0..500 {
        for body in &bodies {
            let positions = &body.positions;
            scene.mesh_mut(body.number)?.set_positions_with(positions.len(), |vertex| positions[vertex])?;
        }
        scene.query(&mut contacts);
        let mut forces = [vec![Vector3::zeros(); 6], vec![Vector3::zeros(); 6]];
        let velocities = bodies.each_ref().map(|body| body.velocities.clone());
        add_forces(&contacts, &law, None, Some(&velocities), &mut forces);
        scene.advance(TIME_STEP)?;
        for (body, forces) in bodies.iter_mut().zip(&mut forces) {
            body.add_springs(forces);
            for (vertex, force) in forces.iter().enumerate() {
                body.velocities[vertex] += *force * (TIME_STEP / MASS);
                body.positions[vertex] += body.velocities[vertex] * TIME_STEP;
            }
        }
        if step % 100 == 0 {
            lines.push(format!("step {step:3}: {} contacts", contacts.len()));
        }
    }
    let momentum: f64 = bodies.iter().flat_map(|body| &body.velocities).map(|velocity| MASS * velocity.x).sum();
    let outcome = if momentum.abs() < 1e-12 { "kept" } else { "lost" };
    lines.push(format!("{} contacts left, momentum {outcome}", contacts.len()));
    Ok(lines)
}

#[allow(dead_code)] // a test calls `run`
fn main() -> Result<(), Box<dyn Error>> {
    run()?.iter().for_each(|line| println!("{line}"));
    Ok(())
}
