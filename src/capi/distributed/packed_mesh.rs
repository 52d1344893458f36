use crate::capi::base::rayc_status;
use crate::capi::ffi::{Output, give, guard, reading, slice, with_precision};
use crate::capi::mesh::{AnyMesh, rayc_mesh};
use crate::distributed::{PackedMeshError, pack_mesh, packed_mesh_length, packed_number_size, unpack_mesh};

/// How many bytes rayc_mesh_pack() writes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_mesh_packed_length(mesh: *const rayc_mesh, length: *mut usize) -> rayc_status {
    guard(|| {
        let mesh = reading(mesh, "mesh")?;
        Output::new(length, "length")?.write(with_precision!(&mesh.mesh, |mesh| packed_mesh_length(mesh)))
    })
}

/// Writes the mesh as it was created to `bytes`: its triangles, the positions at creation instead of the present ones, and the
/// clusters of triangles that are the leaves of its octree, which need not be found again. length must be that of
/// rayc_mesh_packed_length(). The bytes carry their version and a checksum, and are the same on every machine.
///
/// The positions at creation decide patches, tiles and the order of contacts. So a mesh that rayc_mesh_unpack() makes
/// of the bytes in another process has, at the same positions, the same contacts in the same order, to the bit. A
/// mesh created anew from the present positions does not.
///
/// Errors: RAYC_STATUS_WRONG_COUNT.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_mesh_pack(mesh: *const rayc_mesh, length: usize, bytes: *mut u8) -> rayc_status {
    guard(|| {
        let mut packed = Vec::new();
        with_precision!(&reading(mesh, "mesh")?.mesh, |mesh| pack_mesh(mesh, &mut packed));
        Output::exactly(bytes, length, packed.len(), "bytes")?.write_all(packed.into_iter())
    })
}

/// Makes a mesh from packed bytes, with the same precision and at the positions of its creation. *mesh: the new
/// handle.
///
/// Errors: RAYC_STATUS_SAVED_STATE_BROKEN where the bytes are not what was packed, RAYC_STATUS_SAVED_STATE_OTHER_VERSION,
/// and those of rayc_mesh_create() where the bytes fit their checksum but are no mesh.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_mesh_unpack(length: usize, bytes: *const u8, mesh: *mut *mut rayc_mesh) -> rayc_status {
    guard(|| {
        let bytes = slice(bytes, length, "bytes")?;
        let place = Output::new(mesh, "mesh")?;
        let (number_size, _) = packed_number_size(bytes).map_err(PackedMeshError::from)?;
        let mesh = if number_size as usize == size_of::<f32>() {
            AnyMesh::F32(unpack_mesh(bytes)?)
        } else {
            AnyMesh::F64(unpack_mesh(bytes)?)
        };
        give(place, rayc_mesh { mesh })
    })
}
