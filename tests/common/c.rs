//! The C interface as a host in C uses it, with owners that destroy their handles.
#![allow(unsafe_code)] // every call of it

use super::shapes::Point;
use raycontact::capi::*;
use std::ffi::{CStr, CString};
use std::ptr::{null, null_mut};

pub use rayc_status::*;

pub fn vectors(positions: &[Point]) -> rayc_vectors {
    let scalar = rayc_scalar::RAYC_SCALAR_F64 as u32;
    rayc_vectors { data: positions.as_ptr().cast(), count: positions.len(), stride: 0, scalar }
}

pub struct Mesh(pub *mut rayc_mesh);
pub struct Octree(pub *mut rayc_octree);
pub struct Contacts(pub *mut rayc_contacts);
pub struct Scene(pub *mut rayc_scene);

macro_rules! destroyed_by {
    ($($owner:ident $destroy:ident)*) => {$(
        impl Drop for $owner {
            fn drop(&mut self) {
                // SAFETY: the handle is its own, and not used again.
                assert_eq!(unsafe { $destroy(self.0) }, RAYC_STATUS_OK);
            }
        }
    )*};
}

destroyed_by! {
    Mesh rayc_mesh_destroy
    Octree rayc_octree_destroy
    Contacts rayc_contacts_destroy
    Scene rayc_scene_destroy
}

/// Of this thread's last call.
pub fn last_error() -> String {
    // SAFETY: it is never NULL, and ends in zero.
    unsafe { CStr::from_ptr(rayc_last_error_message()) }.to_str().expect("UTF-8").to_owned()
}

fn made<H, O>(status: rayc_status, handle: *mut H, owner: fn(*mut H) -> O) -> Result<O, rayc_status> {
    assert_eq!(status == RAYC_STATUS_OK, !handle.is_null(), "outputs are written on success only");
    if status == RAYC_STATUS_OK { Ok(owner(handle)) } else { Err(status) }
}

impl Mesh {
    /// precision: 32 or 64 bits.
    pub fn new(
        precision: u32,
        open: bool,
        positions: &rayc_vectors,
        triangles: &[[u32; 3]],
    ) -> Result<Self, rayc_status> {
        let mut handle = null_mut();
        // SAFETY: the arrays are as they say.
        let status = unsafe {
            let mut options = std::mem::zeroed();
            assert_eq!(rayc_default_mesh_options(size_of::<rayc_mesh_options>(), &mut options), RAYC_STATUS_OK);
            (options.precision, options.open) = (precision / 32, u32::from(open));
            rayc_mesh_create(&options, positions, triangles.as_ptr().cast(), triangles.len(), &mut handle)
        };
        made(status, handle, Self)
    }

    /// precision: 32 or 64 bits.
    pub fn from_obj(precision: u32, path: &str) -> Result<Self, rayc_status> {
        let path = CString::new(path).expect("no zero within");
        let mut handle = null_mut();
        // SAFETY: the path ends in zero, and the place is writable.
        let status = unsafe {
            let mut options = std::mem::zeroed();
            assert_eq!(rayc_default_mesh_options(size_of::<rayc_mesh_options>(), &mut options), RAYC_STATUS_OK);
            options.precision = precision / 32;
            rayc_mesh_create_from_obj(&options, path.as_ptr(), &mut handle)
        };
        made(status, handle, Self)
    }

    pub fn set_positions(&mut self, positions: &[Point]) -> rayc_status {
        // SAFETY: the array is as it says.
        unsafe { rayc_mesh_set_positions(self.0, &vectors(positions)) }
    }
}

impl Octree {
    pub fn new(mesh: &Mesh) -> Result<Self, rayc_status> {
        let mut handle = null_mut();
        // SAFETY: the place is writable.
        made(unsafe { rayc_octree_create(null(), mesh.0, &mut handle) }, handle, Self)
    }

    pub fn update(&mut self, mesh: &Mesh) -> rayc_status {
        // SAFETY: the handles are valid.
        unsafe { rayc_octree_update(self.0, mesh.0) }
    }
}

impl Contacts {
    pub fn new() -> Self {
        let mut handle = null_mut();
        // SAFETY: the place is writable.
        made(unsafe { rayc_contacts_create(&mut handle) }, handle, Self).expect("an empty list")
    }

    /// All of them, each as its bytes are.
    pub fn all(&self) -> Vec<rayc_contact> {
        let mut count = 0;
        // SAFETY: the array is as long as is said, and numbers alone may be anything.
        unsafe {
            assert_eq!(rayc_contacts_count(self.0, &mut count), RAYC_STATUS_OK);
            let mut all = vec![std::mem::zeroed(); count];
            assert_eq!(rayc_contacts_copy(self.0, 0, count, all.as_mut_ptr()), RAYC_STATUS_OK);
            all
        }
    }

    /// What tells two results apart: where each contact is, and how deep, to the bit.
    pub fn digest(&self) -> Vec<(u32, u32, u32, [u64; 2])> {
        let digest = |c: &rayc_contact| (c.colliding, c.collided, c.p1.triangle, [c.depth, c.area].map(f64::to_bits));
        self.all().iter().map(digest).collect()
    }

    pub fn query_pair(&mut self, a: (&Mesh, &Octree), b: (&Mesh, &Octree)) -> rayc_status {
        // SAFETY: the handles are valid.
        unsafe { rayc_query_pair(null(), a.0.0, a.1.0, b.0.0, b.1.0, self.0) }
    }
}

impl Scene {
    pub fn new(precision: u32, threads: u32) -> Result<Self, rayc_status> {
        let mut handle = null_mut();
        // SAFETY: the places are writable.
        let status = unsafe {
            let mut options = std::mem::zeroed();
            assert_eq!(rayc_default_scene_options(size_of::<rayc_scene_options>(), &mut options), RAYC_STATUS_OK);
            (options.precision, options.threads) = (precision / 32, threads);
            rayc_scene_create(&options, &mut handle)
        };
        made(status, handle, Self)
    }

    pub fn add(&mut self, mesh: &Mesh) -> Result<u32, rayc_status> {
        let mut body = u32::MAX;
        // SAFETY: the handles are valid.
        match unsafe { rayc_scene_add_mesh(self.0, mesh.0, &mut body) } {
            RAYC_STATUS_OK => Ok(body),
            status => {
                assert_eq!(body, u32::MAX, "outputs are written on success only");
                Err(status)
            }
        }
    }

    pub fn set_positions(&mut self, body: u32, positions: &[Point]) -> rayc_status {
        // SAFETY: the array is as it says.
        unsafe { rayc_scene_set_positions(self.0, body, &vectors(positions)) }
    }

    pub fn remove(&mut self, body: u32) {
        // SAFETY: the handle is valid.
        assert_eq!(unsafe { rayc_scene_remove_body(self.0, body) }, RAYC_STATUS_OK);
    }

    pub fn set_self_collision(&mut self, body: u32) {
        // SAFETY: the handle is valid.
        assert_eq!(unsafe { rayc_scene_set_self_collision(self.0, body, 1) }, RAYC_STATUS_OK);
    }

    pub fn query(&mut self, contacts: &mut Contacts) -> rayc_status {
        // SAFETY: the handles are valid.
        unsafe { rayc_scene_query(self.0, contacts.0) }
    }
}
