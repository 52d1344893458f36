//! Whether there is memory for a call before it begins: a failing allocation within it would end the process.

use super::failure::{Failure, rayc_status};
use crate::mesh::Topology;
use std::hint::black_box;
use std::path::Path;

/// What small things take beside the parts below.
const SMALL: usize = 1 << 16;

/// No less than creation takes at its peak. A test measures that.
pub(super) fn of_mesh(vertices: usize, triangles: usize) -> usize {
    sum(&[(vertices, 192), (triangles, 192)])
}

/// As [`of_mesh`], for an octree.
pub(super) fn of_octree(mesh: &Topology) -> usize {
    sum(&[(mesh.vertex_count(), 64), (mesh.triangles().len(), 256)])
}

/// As [`of_mesh`], for a copy of a mesh in a scene, with its octree.
pub(super) fn of_body(mesh: &Topology) -> usize {
    sum(&[(mesh.vertex_count(), 128), (mesh.triangles().len(), 256)])
}

/// As [`of_mesh`], for reading a file, whose shortest line is four bytes long; what cannot be read says so later.
pub(super) fn of_file(path: &Path) -> usize {
    let length = std::fs::metadata(path).map_or(0, |file| file.len());
    sum(&[(usize::try_from(length).unwrap_or(usize::MAX), 64)])
}

fn sum(parts: &[(usize, usize)]) -> usize {
    parts.iter().fold(SMALL, |sum, &(count, bytes)| sum.saturating_add(count.saturating_mul(bytes)))
}

/// Takes so many bytes and gives them back; others may of course take them before the call does.
pub(super) fn check(bytes: usize, what: &str) -> Result<(), Failure> {
    let mut room = Vec::<u8>::new();
    if room.try_reserve_exact(bytes).is_ok() {
        // Seen from outside, so that the compiler does not leave it out.
        black_box(room.as_ptr());
        return Ok(());
    }
    let message = format!("making {what} may take {bytes} bytes, which the system does not give; free some first");
    Err(Failure::new(rayc_status::RAYC_STATUS_OUT_OF_MEMORY, message))
}
