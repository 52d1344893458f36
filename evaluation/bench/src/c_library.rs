//! The C library, loaded as a host loads it: the functions of the shared library, with the structs of its header.

use crate::host::{Host, HostBody};
use crate::method::{Key, Method, Push, Stages};
use crate::shared_library::shared_library;
use crate::workload::{Body, Workload};
use nalgebra::Vector3;
use raycontact::capi::*;
use std::ffi::{CStr, c_char};
use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};
use std::sync::Arc;

shared_library! {
    /// The library as C sees it.
    Library, "'cargo build --release' makes it";
    rayc_last_error_message: fn() -> *const c_char;
    rayc_default_mesh_options: fn(usize, *mut rayc_mesh_options) -> i32;
    rayc_default_scene_options: fn(usize, *mut rayc_scene_options) -> i32;
    rayc_default_detection_options: fn(usize, *mut rayc_detection_options) -> i32;
    rayc_mesh_create: fn(*const rayc_mesh_options, *const rayc_vectors, *const u32, usize, *mut *mut rayc_mesh) -> i32;
    rayc_mesh_destroy: fn(*mut rayc_mesh) -> i32;
    rayc_octree_create: fn(*const rayc_octree_options, *const rayc_mesh, *mut *mut rayc_octree) -> i32;
    rayc_octree_destroy: fn(*mut rayc_octree) -> i32;
    rayc_octree_trace_ray: fn(*const rayc_octree, *const rayc_mesh, *const rayc_ray, *mut rayc_hit) -> i32;
    rayc_octree_trace_rays: fn(*const rayc_octree, *const rayc_mesh, *const rayc_ray, usize, *mut rayc_hit) -> i32;
    rayc_scene_create: fn(*const rayc_scene_options, *mut *mut rayc_scene) -> i32;
    rayc_scene_destroy: fn(*mut rayc_scene) -> i32;
    rayc_scene_set_detection_options: fn(*mut rayc_scene, *const rayc_detection_options) -> i32;
    rayc_scene_add_mesh: fn(*mut rayc_scene, *const rayc_mesh, *mut u32) -> i32;
    rayc_scene_set_positions: fn(*mut rayc_scene, u32, *const rayc_vectors) -> i32;
    rayc_scene_query: fn(*mut rayc_scene, *mut rayc_contacts) -> i32;
    rayc_contacts_create: fn(*mut *mut rayc_contacts) -> i32;
    rayc_contacts_destroy: fn(*mut rayc_contacts) -> i32;
    rayc_contacts_count: fn(*const rayc_contacts, *mut usize) -> i32;
    rayc_contacts_copy: fn(*const rayc_contacts, usize, usize, *mut rayc_contact) -> i32;
}

impl Library {
    /// What the library says of a status that is not 0.
    fn check(&self, status: i32) -> Result<(), String> {
        if status == 0 {
            return Ok(());
        }
        // SAFETY: the text is terminated, and stays until the next call.
        let message = unsafe { CStr::from_ptr((self.rayc_last_error_message)()) };
        Err(format!("the C library: {}", message.to_string_lossy()))
    }

    /// Options as one of the library's functions for them fills them.
    fn defaults<O>(&self, fill: unsafe extern "C" fn(usize, *mut O) -> i32) -> Result<O, String> {
        let mut options = MaybeUninit::uninit();
        // SAFETY: there is room for the struct, all of which the library writes.
        unsafe {
            self.check(fill(size_of::<O>(), options.as_mut_ptr()))?;
            Ok(options.assume_init())
        }
    }
}

fn vectors<N>(positions: &[[N; 3]], scalar: rayc_scalar) -> rayc_vectors {
    rayc_vectors { data: positions.as_ptr().cast(), count: positions.len(), stride: 0, scalar: scalar as u32 }
}

fn doubles(body: &HostBody) -> rayc_vectors {
    vectors(body.double(), rayc_scalar::RAYC_SCALAR_F64)
}

/// A mesh, which ends with this.
struct Mesh {
    library: Arc<Library>,
    mesh: *mut rayc_mesh,
}

impl Mesh {
    fn new(
        library: &Arc<Library>,
        options: &rayc_mesh_options,
        at: &rayc_vectors,
        body: &Body,
    ) -> Result<Self, String> {
        let (corners, count) = (body.triangles.as_ptr().cast(), body.triangles.len());
        let mut mesh = null_mut();
        // SAFETY: all arrays are as long as is said.
        library.check(unsafe { (library.rayc_mesh_create)(options, at, corners, count, &mut mesh) })?;
        Ok(Self { library: Arc::clone(library), mesh })
    }
}

impl Drop for Mesh {
    fn drop(&mut self) {
        // SAFETY: it is not used again.
        unsafe { (self.library.rayc_mesh_destroy)(self.mesh) };
    }
}

/// A mesh and its octree, to trace rays in.
pub struct Surface {
    mesh: Mesh,
    octree: *mut rayc_octree,
}

impl Surface {
    pub fn new(
        library: &Arc<Library>,
        positions: &[[f32; 3]],
        body: &Body,
        precision: rayc_scalar,
    ) -> Result<Self, String> {
        let defaults = library.defaults(library.rayc_default_mesh_options)?;
        let options = rayc_mesh_options { precision: precision as u32, ..defaults };
        let mesh = Mesh::new(library, &options, &vectors(positions, rayc_scalar::RAYC_SCALAR_F32), body)?;
        let mut octree = null_mut();
        // SAFETY: the mesh lives.
        library.check(unsafe { (library.rayc_octree_create)(null(), mesh.mesh, &mut octree) })?;
        Ok(Self { mesh, octree })
    }

    pub fn trace_one_by_one(&self, rays: &[rayc_ray], hits: &mut [rayc_hit]) {
        let trace = self.mesh.library.rayc_octree_trace_ray;
        for (ray, hit) in rays.iter().zip(hits) {
            // SAFETY: the handles live.
            let status = unsafe { trace(self.octree, self.mesh.mesh, ray, hit) };
            assert_eq!(status, 0, "the ray is good");
        }
    }

    pub fn trace_together(&self, rays: &[rayc_ray], hits: &mut [rayc_hit]) {
        assert_eq!(rays.len(), hits.len());
        let trace = self.mesh.library.rayc_octree_trace_rays;
        // SAFETY: the handles live, and there is a hit for each ray.
        let status = unsafe { trace(self.octree, self.mesh.mesh, rays.as_ptr(), rays.len(), hits.as_mut_ptr()) };
        assert_eq!(status, 0, "the rays are good");
    }
}

impl Drop for Surface {
    fn drop(&mut self) {
        // SAFETY: it is not used again.
        unsafe { (self.mesh.library.rayc_octree_destroy)(self.octree) };
    }
}

/// All bodies in a scene, as a C program has them that changes no option: double precision, an accuracy of 0.01, the pressure
/// law, one thread.
pub struct Defaults {
    library: Arc<Library>,
    scene: *mut rayc_scene,
    contacts: *mut rayc_contacts,
}

impl Defaults {
    pub fn new(library: &Arc<Library>, workload: &Workload, host: &Host) -> Result<Self, String> {
        let mesh_options = library.defaults(library.rayc_default_mesh_options)?;
        let scene_options = library.defaults(library.rayc_default_scene_options)?;
        let detection_options = library.defaults(library.rayc_default_detection_options)?;
        let mut made = Self { library: Arc::clone(library), scene: null_mut(), contacts: null_mut() };
        // SAFETY: the options are good, the handles live, and each gets a place.
        unsafe {
            library.check((library.rayc_scene_create)(&scene_options, &mut made.scene))?;
            library.check((library.rayc_contacts_create)(&mut made.contacts))?;
            library.check((library.rayc_scene_set_detection_options)(made.scene, &detection_options))?;
            for (expected, (body, host)) in workload.bodies.iter().zip(&host.bodies).enumerate() {
                let mesh = Mesh::new(library, &mesh_options, &doubles(host), body)?;
                let mut number = 0;
                library.check((library.rayc_scene_add_mesh)(made.scene, mesh.mesh, &mut number))?;
                assert_eq!(number as usize, expected, "bodies are numbered from 0");
            }
        }
        Ok(made)
    }

    fn found(&self) -> Vec<rayc_contact> {
        let mut count = 0;
        // SAFETY: the handle lives, and there is room for as many contacts as it has.
        unsafe {
            assert_eq!((self.library.rayc_contacts_count)(self.contacts, &mut count), 0);
            let mut found = Vec::with_capacity(count);
            assert_eq!((self.library.rayc_contacts_copy)(self.contacts, 0, count, found.as_mut_ptr()), 0);
            found.set_len(count);
            found
        }
    }
}

impl Method for Defaults {
    fn step(&mut self, host: &Host) -> Option<Stages> {
        for (number, body) in (0..).zip(&host.bodies) {
            // SAFETY: the scene lives, and the array is as long as is said.
            let status = unsafe { (self.library.rayc_scene_set_positions)(self.scene, number, &doubles(body)) };
            assert_eq!(status, 0, "positions are finite");
        }
        // SAFETY: the handles live.
        let status = unsafe { (self.library.rayc_scene_query)(self.scene, self.contacts) };
        assert_eq!(status, 0, "the bodies are good");
        None
    }

    fn contacts(&self) -> Vec<Key> {
        let key = |contact: &rayc_contact| Key {
            colliding: contact.colliding,
            collided: contact.collided,
            vertex: contact.p1.vertices[0],
            triangle: contact.p2.triangle,
        };
        self.found().iter().map(key).collect()
    }

    fn pushes(&self) -> Vec<Push> {
        let push = |contact: &rayc_contact| {
            let touched = contact.p1.vertices.iter().zip(contact.p1.weights).filter(|(_, weight)| *weight != 0.0);
            Push {
                bodies: [contact.colliding, contact.collided],
                point: Vector3::from(contact.p1.position),
                force: Vector3::from(contact.direction) * (contact.depth * contact.cos_alpha),
                area: Some(contact.area),
                vertices: touched.map(|(&vertex, _)| [contact.colliding, vertex]).collect(),
            }
        };
        self.found().iter().map(push).collect()
    }
}

impl Drop for Defaults {
    fn drop(&mut self) {
        // SAFETY: they are not used again; null does nothing.
        unsafe {
            (self.library.rayc_contacts_destroy)(self.contacts);
            (self.library.rayc_scene_destroy)(self.scene);
        }
    }
}
