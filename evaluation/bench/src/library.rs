//! raycontact as its users call it.

use crate::host::{Host, HostBody};
use crate::method::{Key, Method, Push, Stages};
use crate::workload::Workload;
use raycontact::contact::{Contact, ContactList, DetectionOptions};
use raycontact::escape::query_pair;
use raycontact::math::Scalar;
use raycontact::mesh::Mesh;
use raycontact::query::{Layout, Octree};
use raycontact::scene::Scene;

pub trait HostScalar: Scalar {
    fn positions(body: &HostBody) -> &[[Self; 3]];
}

impl HostScalar for f32 {
    fn positions(body: &HostBody) -> &[[f32; 3]] {
        body.single()
    }
}

impl HostScalar for f64 {
    fn positions(body: &HostBody) -> &[[f64; 3]] {
        body.double()
    }
}

fn meshes<T: HostScalar>(workload: &Workload, host: &Host) -> Result<Vec<Mesh<T>>, String> {
    let bodies = workload.bodies.iter().zip(&host.bodies);
    bodies.map(|(body, host)| Mesh::new(T::positions(host), &body.triangles).map_err(|e| e.to_string())).collect()
}

fn key<T: Scalar>(contact: &Contact<T>) -> Key {
    Key {
        colliding: contact.colliding,
        collided: contact.collided,
        vertex: contact.p1.vertices[0],
        triangle: contact.p2.triangle,
    }
}

fn push<T: Scalar>(contact: &Contact<T>) -> Push {
    let touched = contact.p1.vertices.iter().zip(contact.p1.weights).filter(|(_, weight)| *weight != T::zero());
    Push {
        bodies: [contact.colliding, contact.collided],
        point: contact.p1.position.map(T::to_f64),
        force: contact.direction.map(T::to_f64) * (contact.depth * contact.cos_alpha).to_f64(),
        area: Some(contact.area.to_f64()),
        vertices: touched.map(|(&vertex, _)| [contact.colliding, vertex]).collect(),
    }
}

/// All bodies in a scene.
pub struct Whole<T: Scalar> {
    scene: Scene<T>,
    contacts: ContactList<T>,
}

impl<T: HostScalar> Whole<T> {
    pub fn new(workload: &Workload, host: &Host, threads: u32, options: DetectionOptions<T>) -> Result<Self, String> {
        let mut scene = Scene::new(threads as usize).map_err(|e| e.to_string())?;
        scene.set_options(options);
        for mesh in meshes(workload, host)? {
            scene.add(mesh);
        }
        Ok(Self { scene, contacts: ContactList::default() })
    }
}

impl<T: HostScalar> Method for Whole<T> {
    fn step(&mut self, host: &Host) -> Option<Stages> {
        for (index, body) in host.bodies.iter().enumerate() {
            let mesh = self.scene.mesh_mut(index as u32).expect("the body was added");
            mesh.set_positions(T::positions(body)).expect("positions are finite");
        }
        self.scene.query(&mut self.contacts);
        None
    }

    fn contacts(&self) -> Vec<Key> {
        self.contacts.contacts.iter().map(key).collect()
    }

    fn pushes(&self) -> Vec<Push> {
        self.contacts.contacts.iter().map(push).collect()
    }
}

/// The paper's octree, built anew each step, pair by pair.
pub struct Classic<T: Scalar> {
    bodies: Vec<(Mesh<T>, Octree<T>)>,
    options: DetectionOptions<T>,
    pair: ContactList<T>,
    contacts: Vec<Contact<T>>,
}

impl<T: HostScalar> Classic<T> {
    pub fn new(workload: &Workload, host: &Host, options: DetectionOptions<T>) -> Result<Self, String> {
        let with_octree = |mesh| {
            let octree = Octree::with_layout(&mesh, Layout::PaperOctree);
            (mesh, octree)
        };
        let bodies = meshes(workload, host)?.into_iter().map(with_octree).collect();
        Ok(Self { bodies, options, pair: ContactList::default(), contacts: Vec::new() })
    }
}

impl<T: HostScalar> Method for Classic<T> {
    fn step(&mut self, host: &Host) -> Option<Stages> {
        for ((mesh, _), body) in self.bodies.iter_mut().zip(&host.bodies) {
            mesh.set_positions(T::positions(body)).expect("positions are finite");
        }
        self.contacts.clear();
        for second in 1..self.bodies.len() {
            let (before, after) = self.bodies.split_at_mut(second);
            let (b, octree_b) = &mut after[0];
            for (first, (a, octree_a)) in before.iter_mut().enumerate() {
                if !a.aabb().overlaps(b.aabb()) {
                    continue;
                }
                octree_a.update(a).expect("a body keeps its own octree");
                octree_b.update(b).expect("a body keeps its own octree");
                query_pair(a, octree_a, b, octree_b, &self.options, &mut self.pair).expect("octrees are up to date");
                let number = |local| if local == 0 { first as u32 } else { second as u32 };
                self.contacts.extend(self.pair.contacts.iter().map(|contact| Contact {
                    colliding: number(contact.colliding),
                    collided: number(contact.collided),
                    ..*contact
                }));
            }
        }
        None
    }

    fn contacts(&self) -> Vec<Key> {
        self.contacts.iter().map(key).collect()
    }

    fn pushes(&self) -> Vec<Push> {
        self.contacts.iter().map(push).collect()
    }
}
