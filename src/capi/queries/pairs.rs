use super::octree::rayc_octree;
use crate::capi::base::rayc_status;
use crate::capi::contacts::{rayc_contacts, rayc_detection_options};
use crate::capi::ffi::{changing, guard, read_options, reading, with_precision};
use crate::capi::mesh::rayc_mesh;
use crate::contact::query_self;
use crate::escape::query_pair;

/// Finds the contacts between two meshes, rays both ways: Algorithm 1 of Hermann, Faure, Raffin 2008. Body 0 is `a`,
/// body 1 is `b`. Replaces what `contacts` held. options: NULL for the defaults.
///
/// Errors: RAYC_STATUS_OCTREE_STALE, RAYC_STATUS_OCTREE_OF_OTHER_MESH, RAYC_STATUS_PRECISION_MISMATCH,
/// RAYC_STATUS_INVALID_OPTION; `contacts` is then as before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_query_pair(
    options: *const rayc_detection_options,
    a: *const rayc_mesh,
    octree_a: *const rayc_octree,
    b: *const rayc_mesh,
    octree_b: *const rayc_octree,
    contacts: *mut rayc_contacts,
) -> rayc_status {
    guard(|| {
        let options = read_options(options)?;
        let (a, octree_a) = (reading(a, "a")?, reading(octree_a, "octree_a")?);
        let (b, octree_b) = (reading(b, "b")?, reading(octree_b, "octree_b")?);
        let mut contacts = changing(contacts, "contacts")?;
        let list = &mut contacts.list;
        with_precision!(&a.mesh, &octree_a.octree, &b.mesh, &octree_b.octree, |a, octree_a, b, octree_b| {
            octree_a.tracer(a).and(octree_b.tracer(b))?;
            Ok(query_pair(a, octree_a, b, octree_b, &options.detection()?, list.as_mut())?)
        })
    })
}

/// Finds the contacts between parts of one mesh, body 0: points of its surface that lie inside another part of the body,
/// where the surface winds around more than once, and the points through which they leave that part. Replaces what
/// `contacts` held; each contact has colliding = collided = 0, and stands for half its surface, as both parts cast rays.
/// options: NULL for the defaults; of them only the sampling counts, an accuracy being one ray for each triangle.
///
/// Where the surface touches nothing of itself, no ray is traced; a scene also remembers that from step to step. An open
/// mesh has no inside, and so no contacts with itself; it is counted in open_bodies.
///
/// Errors: RAYC_STATUS_OCTREE_STALE, RAYC_STATUS_OCTREE_OF_OTHER_MESH, RAYC_STATUS_PRECISION_MISMATCH,
/// RAYC_STATUS_INVALID_OPTION; `contacts` is then as before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_query_self(
    options: *const rayc_detection_options,
    mesh: *const rayc_mesh,
    octree: *const rayc_octree,
    contacts: *mut rayc_contacts,
) -> rayc_status {
    guard(|| {
        let options = read_options(options)?;
        let (mesh, octree) = (reading(mesh, "mesh")?, reading(octree, "octree")?);
        let mut contacts = changing(contacts, "contacts")?;
        let list = &mut contacts.list;
        with_precision!(&mesh.mesh, &octree.octree, |mesh, octree| {
            octree.tracer(mesh)?;
            Ok(query_self(mesh, octree, &options.detection()?, list.as_mut())?)
        })
    })
}
