//! A mesh from bytes: what is accepted is what it says, whatever else is refused.

use crate::Bytes;
use crate::cuboid::CUBOID_FACES;
use raycontact::mesh::{Mesh, MeshError};
use raycontact::query::{Layout, Octree};

pub fn cube_corner(i: usize) -> [f64; 3] {
    [i & 1, i >> 1 & 1, i >> 2 & 1].map(|x| x as f64)
}

/// Closed surfaces to start from, since random triangles are hardly ever one: one or two cubes with some corners and triangles changed.
pub fn surface(bytes: &mut Bytes) -> (Vec<[f64; 3]>, Vec<[u32; 3]>, bool) {
    let (is_open, cubes) = (bytes.below(4) == 0, 1 + bytes.below(2));
    let mut positions: Vec<[f64; 3]> = (0..8 * cubes).map(|i| cube_corner(i % 8)).collect();
    let shift = bytes.point();
    positions.iter_mut().skip(8).for_each(|p| *p = std::array::from_fn(|axis| p[axis] + shift[axis]));
    let corners = |cube: u32| CUBOID_FACES.map(|corners| corners.map(|corner| corner + 8 * cube));
    let mut triangles: Vec<[u32; 3]> = (0..cubes as u32).flat_map(corners).collect();
    for _ in 0..bytes.below(8) {
        let vertex = bytes.below(positions.len());
        positions[vertex] = bytes.point();
    }
    for _ in 0..bytes.below(16).saturating_sub(12) {
        let triangle = bytes.below(triangles.len());
        match bytes.below(3) {
            0 => drop(triangles.remove(triangle)),
            1 => triangles.push([0; 3].map(|_| bytes.below(20) as u32)),
            _ => triangles[triangle][bytes.below(3)] = bytes.below(20) as u32,
        }
    }
    (positions, triangles, is_open)
}

pub fn mesh(bytes: &mut Bytes) -> Result<Mesh<f64>, MeshError> {
    let (positions, triangles, is_open) = surface(bytes);
    if is_open { Mesh::open(&positions, &triangles) } else { Mesh::new(&positions, &triangles) }
}

pub fn run(bytes: &mut Bytes) {
    let mesh = match mesh(bytes) {
        Ok(mesh) => mesh,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    assert!(mesh.positions().iter().all(|p| p.iter().all(|x| x.is_finite())));
    assert!(mesh.is_open() || mesh.topology().edges().count() * 2 == mesh.topology().triangles().len() * 3);
    for vertex in 0..mesh.positions().len() as u32 {
        let around = mesh.topology().triangles_around(vertex);
        assert!(around.iter().all(|&t| mesh.topology().triangles()[t as usize].contains(&vertex)));
    }
    for layout in [Layout::Bvh, Layout::PaperOctree] {
        Octree::with_layout(&mesh, layout).validate(&mesh).expect("the octree is whole");
    }
}
