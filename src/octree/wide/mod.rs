//! The fast octree: tiles of neighbouring triangles as leaves, and above them nodes with up to eight tight boxes side
//! by side, so that one step tests all of them. Which triangles share a tile, and which tiles a node, is settled once
//! for a mesh; new positions only renew boxes, from the tiles upward.

// Lanes side by side read best, and are best made into SIMD, as plain loops over their index.
#![allow(clippy::needless_range_loop)]

mod cluster;
mod dispatch;
mod group;
mod packet;
mod trace;
mod validate;

use crate::math::{Aabb, Scalar, Vector3};
use crate::mesh::Mesh;
use crate::ray::{PreparedRay, Ray};

pub(super) use packet::PACKET_SIZE;

/// At most so many triangles, and so many vertices, form a tile.
const TILE_SIZE: usize = 16;
/// At most so many children belong to a node.
const CHILD_COUNT: usize = 8;

/// Tiles and the nodes above them, in flat arrays.
#[derive(Clone, Debug)]
pub(super) struct Wide<T: Scalar> {
    tiles: Vec<Tile<T>>,
    /// Children come after their parent; the first is the root.
    nodes: Vec<Node<T>>,
}

/// Up to 16 neighbouring triangles and their up to 16 vertices, at the present positions.
#[derive(Clone, Debug)]
struct Tile<T: Scalar> {
    /// Coordinates of the vertices, axis by axis; places beyond the last vertex repeat it.
    positions: [[T; TILE_SIZE]; 3],
    /// The places of each triangle's corners.
    corners: [[u8; 3]; TILE_SIZE],
    /// Bit i: vertex i is a corner of the triangle. Zero beyond the last triangle, so that no ray finds it.
    vertex_masks: [u16; TILE_SIZE],
    triangle_count: u8,
    triangles: [u32; TILE_SIZE],
    vertices: [u32; TILE_SIZE],
}

/// Up to eight children's boxes, axis by axis; places beyond the last child hold boxes that no ray meets.
#[derive(Clone, Debug)]
struct Node<T: Scalar> {
    lower: [[T; CHILD_COUNT]; 3],
    upper: [[T; CHILD_COUNT]; 3],
    children: [Child; CHILD_COUNT],
}

/// What lies under one box of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Child {
    None,
    Node(u32),
    Tile(u32),
}

impl<T: Scalar> Wide<T> {
    pub(super) fn new(mesh: &Mesh<T>) -> Self {
        let tiles: Vec<Tile<T>> =
            cluster::cluster(mesh).iter().map(|triangles| Tile::new(mesh.topology().triangles(), triangles)).collect();
        let mut wide = Self { nodes: group::group(mesh, &tiles), tiles };
        wide.refit(mesh);
        wide
    }

    /// Follows the mesh to its present positions.
    pub(super) fn refit(&mut self, mesh: &Mesh<T>) {
        for tile in &mut self.tiles {
            tile.load(mesh.positions());
        }
        for index in (0..self.nodes.len()).rev() {
            for place in 0..CHILD_COUNT {
                let aabb = match self.nodes[index].children[place] {
                    Child::Tile(tile) => self.tiles[tile as usize].aabb(),
                    Child::Node(node) => self.nodes[node as usize].aabb(),
                    Child::None => continue,
                };
                self.nodes[index].set_box(place, &aabb);
            }
        }
    }
}

impl<T: Scalar> Wide<T> {
    /// Offers every triangle that the ray may meet up to the `t` that `visitor` last returned.
    pub(super) fn visit(
        &self,
        ray: &Ray<T>,
        prepared: &PreparedRay<T>,
        mesh_box: &Aabb<T>,
        visitor: &mut impl FnMut(u32) -> T,
    ) {
        dispatch::dispatch(trace::Walk::new(self, ray, prepared, mesh_box, visitor));
    }

    /// The same for up to 16 rays at once, which should be neighbours; `visitor` is told which ray it is.
    pub(super) fn visit_packet(
        &self,
        rays: &[Ray<T>],
        prepared: &[PreparedRay<T>],
        mesh_box: &Aabb<T>,
        visitor: &mut impl FnMut(usize, u32) -> T,
    ) {
        dispatch::dispatch(packet::PacketWalk::new(self, rays, prepared, mesh_box, visitor));
    }
}

impl<T: Scalar> Tile<T> {
    /// The tile of some triangles; positions are yet to be loaded.
    fn new(all_triangles: &[[u32; 3]], triangles: &[u32]) -> Self {
        let mut tile = Self {
            positions: [[T::zero(); TILE_SIZE]; 3],
            corners: [[0; 3]; TILE_SIZE],
            vertex_masks: [0; TILE_SIZE],
            triangle_count: triangles.len() as u8,
            triangles: [u32::MAX; TILE_SIZE],
            vertices: [u32::MAX; TILE_SIZE],
        };
        let mut vertex_count = 0;
        for (place, &triangle) in triangles.iter().enumerate() {
            tile.triangles[place] = triangle;
            for (corner, &vertex) in all_triangles[triangle as usize].iter().enumerate() {
                let known = tile.vertices[..vertex_count].iter().position(|&v| v == vertex);
                let vertex_place = known.unwrap_or_else(|| {
                    tile.vertices[vertex_count] = vertex;
                    vertex_count += 1;
                    vertex_count - 1
                });
                tile.corners[place][corner] = vertex_place as u8;
                tile.vertex_masks[place] |= 1 << vertex_place;
            }
        }
        let last = tile.vertices[vertex_count - 1];
        tile.vertices[vertex_count..].fill(last);
        tile
    }

    fn load(&mut self, positions: &[Vector3<T>]) {
        for (place, &vertex) in self.vertices.iter().enumerate() {
            let position = &positions[vertex as usize];
            for axis in 0..3 {
                self.positions[axis][place] = position[axis];
            }
        }
    }

    fn aabb(&self) -> Aabb<T> {
        bounds(&self.positions, &self.positions)
    }
}

impl<T: Scalar> Node<T> {
    fn new(children: &[Child]) -> Self {
        let mut node = Self {
            lower: [[T::INFINITY; CHILD_COUNT]; 3],
            upper: [[-T::INFINITY; CHILD_COUNT]; 3],
            children: [Child::None; CHILD_COUNT],
        };
        node.children[..children.len()].copy_from_slice(children);
        node
    }

    fn set_box(&mut self, place: usize, aabb: &Aabb<T>) {
        for axis in 0..3 {
            self.lower[axis][place] = aabb.lower[axis];
            self.upper[axis][place] = aabb.upper[axis];
        }
    }

    fn aabb(&self) -> Aabb<T> {
        bounds(&self.lower, &self.upper)
    }
}

fn bounds<T: Scalar, const N: usize>(lower: &[[T; N]; 3], upper: &[[T; N]; 3]) -> Aabb<T> {
    let smaller = |a: T, b: &T| if *b < a { *b } else { a };
    let larger = |a: T, b: &T| if *b > a { *b } else { a };
    Aabb {
        lower: Vector3::from_fn(|axis, _| lower[axis].iter().fold(T::INFINITY, smaller)),
        upper: Vector3::from_fn(|axis, _| upper[axis].iter().fold(-T::INFINITY, larger)),
    }
}
