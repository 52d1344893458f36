//! Prints a failure so that it can become a test: every number as its bits.

use super::cases::{Case, Target};
use raycontact::math::{Scalar, Vector3};
use raycontact::mesh::Mesh;
use raycontact::triangle::{Hit, Ray};
use std::fmt::Write;

/// Where a ray comes from.
pub struct Origin {
    pub case: Case,
    pub seed: u64,
    pub batch: u64,
    pub place: usize,
}

pub fn describe<T: Scalar>(
    target: &Target<T>,
    origin: &Origin,
    ray: &Ray<T>,
    what: &str,
    answers: &[(&str, Option<Hit<T>>)],
) -> String {
    let Origin { case, seed, batch, place } = origin;
    let mut text = format!("{what}\ncase {}, seed {seed}, batch {batch}, ray {place}\n", case.name());
    // Writing to a string cannot fail.
    let _ = writeln!(text, "origin    {} {:?}", bits(&ray.origin), ray.origin.as_slice());
    let _ = writeln!(text, "direction {} {:?}", bits(&ray.direction), ray.direction.as_slice());
    let _ = writeln!(text, "t_max     {} {:?}", bit(ray.t_max), ray.t_max);
    for (name, answer) in answers {
        let _ = writeln!(text, "{name}: {answer:?}");
    }
    text + &mesh_text(&target.mesh)
}

/// All triangles and vertices.
pub fn mesh_text<T: Scalar>(mesh: &Mesh<T>) -> String {
    let mut text = format!("triangles {:?}\n", mesh.topology().triangles());
    for (vertex, position) in mesh.positions().iter().enumerate() {
        let _ = writeln!(text, "vertex {vertex:2} {} {:?}", bits(position), position.as_slice());
    }
    text
}

fn bits<T: Scalar>(vector: &Vector3<T>) -> String {
    format!("[{}, {}, {}]", bit(vector.x), bit(vector.y), bit(vector.z))
}

fn bit<T: Scalar>(number: T) -> String {
    let exact = number.to_f64();
    if size_of::<T>() == 4 {
        // Exact: the number was an f32.
        format!("f32::from_bits({:#010x})", (exact as f32).to_bits())
    } else {
        format!("f64::from_bits({:#018x})", exact.to_bits())
    }
}
