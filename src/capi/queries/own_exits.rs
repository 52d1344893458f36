use super::closest::{closest_point, rayc_closest_point};
use super::octree::rayc_octree;
use crate::capi::base::rayc_status;
use crate::capi::ffi::{Failure, Output, changing, guard, reading, with_precision};
use crate::capi::mesh::rayc_mesh;
use crate::math::Scalar;
use crate::memory::text;
use crate::mesh::Mesh;
use crate::own_exits::{OwnExit, OwnExits, OwnExitsError};
use crate::query::Octree;

/// A vertex inside another part of its own body, and where its shortest way out of that part ends.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_own_exit {
    /// The vertex.
    pub vertex: u32,
    /// The triangle that the end lies on, of several as near the one with the smallest number; or RAYC_NO_TRIANGLE where all
    /// triangles belong to the vertex' own part, and the fields below are zero.
    pub triangle: u32,
    /// How long the way is; ≥ 0.
    pub distance: f64,
    /// Barycentric weights of the end at the triangle's three corners: none is negative, and those of corners that are not
    /// on its edge or vertex are exactly zero.
    pub weights: [f64; 3],
    /// The end: the weighted sum of the corners.
    pub position: [f64; 3],
}

/// Finds the vertices of a closed surface that lie inside another part of their own body, and for each the shortest way
/// out: where a body overlaps itself, and by how much.
///
/// A vertex lies inside another part if the surface winds around the point just under it more than once; see
/// rayc_octree_winding_numbers(). Vertices without a normal, because the triangles around them have no area or cancel
/// out, are left out. The end of the way is the nearest point of the surface without the triangles that have a vertex
/// of the same part inside: those vertices inside that are connected with it along edges. Where that point also lies on
/// a triangle that was left out, the surface continues there into the part. Then the part takes in the vertices around
/// the point, and the nearest point is sought again. That is the end of the shortest path out of the other part, as in
/// Chen, Diaz and Yuksel 2023, "Shortest path to boundary for self-intersecting meshes", but without a volume mesh.
/// Where a body lies in itself all around, as a ring of two full turns, it may be a longer one. Distances are as right
/// as those of rayc_octree_closest_points().
///
/// octree: its working memory is used again, so that a steady step allocates nothing; nothing else of it changes.
/// exits: room for `capacity` structs, in ascending order of vertices; as many as the mesh has vertices always suffice.
/// *count: how many there are.
///
/// Errors: RAYC_STATUS_WRONG_COUNT where there are more than `capacity`, with a message that says how many;
/// RAYC_STATUS_MESH_OPEN, since an open surface has no inside; RAYC_STATUS_OCTREE_STALE, RAYC_STATUS_OCTREE_OF_OTHER_MESH,
/// RAYC_STATUS_PRECISION_MISMATCH.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_octree_own_exits(
    octree: *mut rayc_octree,
    mesh: *const rayc_mesh,
    capacity: usize,
    exits: *mut rayc_own_exit,
    count: *mut usize,
) -> rayc_status {
    /// # Safety
    /// There is room for `capacity` structs, and for the count.
    unsafe fn find<T: Scalar>(
        (octree, mesh, room): (&Octree<T>, &Mesh<T>, &mut OwnExits<T>),
        capacity: usize,
        exits: Output<rayc_own_exit>,
        count: Output<usize>,
    ) -> Result<(), Failure> {
        let found = room.find(mesh, octree)?;
        if found.len() > capacity {
            let message =
                text!("there are {} own exits and room for {capacity}; give room for one for each vertex", found.len());
            return Err(Failure::new(rayc_status::RAYC_STATUS_WRONG_COUNT, message));
        }
        exits.write_all(found.iter().map(exported))?;
        count.write(found.len())
    }
    guard(|| {
        let (mut octree, mesh) = (changing(octree, "octree")?, reading(mesh, "mesh")?);
        let (exits, count) = (Output::array(exits, capacity, "exits")?, Output::new(count, "count")?);
        let rayc_octree { octree, own_exits } = &mut *octree;
        with_precision!(octree, &mesh.mesh, own_exits, |octree, mesh, room| {
            find((octree, mesh, room), capacity, exits, count)
        })
    })
}

impl From<OwnExitsError> for Failure {
    fn from(error: OwnExitsError) -> Self {
        match error {
            OwnExitsError::Octree(error) => error.into(),
            OwnExitsError::Open => Self::new(rayc_status::RAYC_STATUS_MESH_OPEN, text!("{error}")),
        }
    }
}

fn exported<T: Scalar>(found: &OwnExit<T>) -> rayc_own_exit {
    let rayc_closest_point { triangle, distance, weights, position, .. } = closest_point(&found.exit);
    rayc_own_exit { vertex: found.vertex, triangle, distance, weights, position }
}
