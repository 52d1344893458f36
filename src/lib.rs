//! Contact between deformable bodies, found by tracing rays.
//!
//! Each body is a closed triangle surface. Rays start where it lies inside another body: from the middles of patches of
//! triangles, of triangles, or of parts of them, by default as many as it takes for the net force of a pair to be right to
//! about a hundredth. They run along the inward normal and end where they leave that body. Each such ray
//! is a contact between its two ends (Hermann, Faure, Raffin 2008, "Ray-traced collision detection for deformable bodies").
//! Its force is a pressure that grows with the distance from the ray's start to the other body's surface, times the area
//! that the ray stands for. A [`Scene`](scene::Scene) also lets pairs *escape* that contacts cannot part: it pushes them
//! along one direction until they are apart. Nothing is precomputed that deformation would spoil, however deep bodies
//! overlap.
//!
//! [`DetectionOptions::paper`](contact::DetectionOptions::paper) does just what the paper does: rays from the vertices, its
//! law of forces, and no escapes.
//!
//! Threads must be in the default floating-point mode, as Rust demands of all its code; the C interface sees to that itself.
//!
//! The modules are layers, each of which uses only those below it: `docs/architecture.md` lists them.
//!
//! # Example
//! Two unit cubes, one shifted by (0.8, 0.1, 0.2). With rays from the vertices, as in the paper, each has one contact: at the
//! corner that lies inside the other. By default there are hundreds, so that forces hardly depend on the triangulation.
//! ```
//! use raycontact::contact::{ContactList, DetectionOptions};
//! use raycontact::escape::query_pair;
//! use raycontact::mesh::Mesh;
//! use raycontact::query::Octree;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let corner = |i: usize| [(i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64];
//! let cube: Vec<[f64; 3]> = (0..8).map(corner).collect();
//! let moved: Vec<[f64; 3]> = cube.iter().map(|p| [p[0] + 0.8, p[1] + 0.1, p[2] + 0.2]).collect();
//! let faces = [
//!     [0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4],
//!     [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5],
//! ];
//! let a = Mesh::new(&cube, &faces)?;
//! let b = Mesh::new(&moved, &faces)?;
//! let (octree_a, octree_b) = (Octree::new(&a), Octree::new(&b));
//! let mut contacts = ContactList::default();
//! query_pair(&a, &octree_a, &b, &octree_b, &DetectionOptions::paper(), &mut contacts)?;
//! assert_eq!(contacts.len(), 2);
//! query_pair(&a, &octree_a, &b, &octree_b, &DetectionOptions::default(), &mut contacts)?;
//! assert!(contacts.len() > 200);
//! # Ok(())
//! # }
//! ```

mod bvh;
mod bytes;
pub mod capi;
pub mod contact;
pub mod distributed;
pub mod escape;
pub mod force;
pub mod math;
pub mod memory;
pub mod mesh;
pub mod own_exits;
mod paper_octree;
pub mod query;
pub mod scene;
mod self_contact;
mod simd;
pub mod system;
pub mod threads;
pub mod triangle;

// What unit tests share with the integration tests.
#[cfg(test)]
#[path = "../tests/common/cuboid.rs"]
mod cuboid;
#[cfg(test)]
#[path = "../tests/common/random.rs"]
mod random;
#[cfg(test)]
extern crate self as raycontact;
#[cfg(test)]
#[allow(dead_code)] // unit tests use a part of them
#[path = "../tests/common/shapes.rs"]
mod shapes;
