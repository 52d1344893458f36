use crate::math::{Aabb, Scalar, Vector3};
use crate::mesh::CLUSTER_SIZE;
use crate::simd::Mask;

/// A tile has at most this many triangles, and as many vertices: those of a cluster.
pub(crate) const TILE_SIZE: usize = CLUSTER_SIZE;

/// Up to 16 neighbouring triangles and their up to 16 vertices.
#[derive(Clone, Debug)]
// Whole rows of sixteen lie on lines of the cache.
#[repr(C, align(64))]
pub(crate) struct Tile<T: Scalar> {
    /// Coordinates of the vertices, axis by axis, where the tile is loaded; places beyond the last vertex repeat it.
    pub(crate) positions: [[T; TILE_SIZE]; 3],
    /// The places of the triangles' first, second and third corners.
    pub(crate) corners: [[u8; TILE_SIZE]; 3],
    /// Which places hold a triangle.
    pub(crate) present: Mask,
    /// Which vertices this tile owns; each vertex has one owner.
    pub(crate) owned: Mask,
    /// When positions were loaded last: see [`Bvh::is_loaded`](crate::bvh::Bvh::is_loaded).
    pub(crate) loaded_at: u64,
    pub(crate) triangles: [u32; TILE_SIZE],
}

/// What a refit reads and writes of a tile that is not loaded; stored separately, so that a refit touches little memory.
#[derive(Clone, Debug)]
pub(crate) struct Outline<T: Scalar> {
    /// Places beyond the last vertex repeat it.
    pub(crate) vertices: [u32; TILE_SIZE],
    /// The box around the vertices; endless where it is not known.
    pub(crate) aabb: Aabb<T>,
}

impl<T: Scalar> Outline<T> {
    /// Whether the box is known.
    pub(crate) fn is_known(&self) -> bool {
        self.aabb.upper.x.is_finite()
    }

    /// Marks the box as out of date.
    pub(crate) fn forget(&mut self) {
        let endless = Vector3::repeat(T::INFINITY);
        self.aabb = Aabb { lower: -endless, upper: endless };
    }
}

impl<T: Scalar> Tile<T> {
    /// The tile of some triangles; positions and box are yet to be loaded.
    pub(crate) fn new(all_triangles: &[[u32; 3]], triangles: &[u32]) -> (Self, Outline<T>) {
        let mut outline = Outline { vertices: [u32::MAX; TILE_SIZE], aabb: Aabb::empty() };
        let mut tile = Self {
            positions: [[T::zero(); TILE_SIZE]; 3],
            corners: [[0; TILE_SIZE]; 3],
            present: ((1u32 << triangles.len()) - 1) as Mask,
            owned: 0,
            loaded_at: 0,
            triangles: [u32::MAX; TILE_SIZE],
        };
        let vertices = &mut outline.vertices;
        let mut vertex_count = 0;
        for (place, &triangle) in triangles.iter().enumerate() {
            tile.triangles[place] = triangle;
            for (corner, &vertex) in all_triangles[triangle as usize].iter().enumerate() {
                let known = vertices[..vertex_count].iter().position(|&v| v == vertex);
                let vertex_place = known.unwrap_or_else(|| {
                    vertices[vertex_count] = vertex;
                    vertex_count += 1;
                    vertex_count - 1
                });
                tile.corners[corner][place] = vertex_place as u8;
            }
        }
        let last = vertices[vertex_count - 1];
        vertices[vertex_count..].fill(last);
        (tile, outline)
    }

    /// Takes over the vertices that no other tile owns yet.
    pub(crate) fn own_vertices(&mut self, vertices: &[u32; TILE_SIZE], is_owned: &mut [bool]) {
        for (place, &vertex) in vertices.iter().enumerate() {
            if !std::mem::replace(&mut is_owned[vertex as usize], true) {
                self.owned |= 1 << place;
            }
        }
    }

    /// The places of the corners in ascending order of the vertices' numbers.
    pub(crate) fn ascending(&self, outline: &Outline<T>) -> [[u8; TILE_SIZE]; 3] {
        let mut ascending = [[0; TILE_SIZE]; 3];
        for triangle in 0..self.triangles().len() {
            let mut places = self.corners.map(|corner| corner[triangle]);
            places.sort_unstable_by_key(|&place| outline.vertices[usize::from(place)]);
            (0..3).for_each(|corner| ascending[corner][triangle] = places[corner]);
        }
        ascending
    }

    pub(crate) fn triangles(&self) -> &[u32] {
        &self.triangles[..self.present.count_ones() as usize]
    }
}
