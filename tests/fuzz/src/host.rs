//! A host that calls the C interface in any order its rules allow, with arguments good and bad: every call gives a status
//! that is no panic, writes outputs on success only, and leaves handles that go on.
#![allow(unsafe_code)] // every call of it

use crate::Bytes;
use crate::surface;
use raycontact::capi::rayc_status::RAYC_STATUS_OK as OK;
use raycontact::capi::*;
use std::ptr::{null, null_mut};

/// All handles of one run.
#[derive(Default)]
struct Host {
    meshes: Vec<*mut rayc_mesh>,
    octrees: Vec<*mut rayc_octree>,
    contacts: Vec<*mut rayc_contacts>,
    scenes: Vec<*mut rayc_scene>,
    /// The numbers that scenes gave to bodies, in that order, and whether the body is still there.
    bodies: Vec<(*mut rayc_scene, u32, bool)>,
    /// The largest coordinate so far: spacings much below it are honoured, but take their time.
    largest: f64,
}

/// One of the handles, or NULL.
fn any<H>(handles: &[*mut H], bytes: &mut Bytes) -> *mut H {
    handles.get(bytes.below(handles.len() + 1)).copied().unwrap_or(null_mut())
}

/// One of the handles, taken out; or NULL.
fn taken<H>(handles: &mut Vec<*mut H>, bytes: &mut Bytes) -> *mut H {
    let place = bytes.below(handles.len() + 1);
    if place < handles.len() { handles.swap_remove(place) } else { null_mut() }
}

fn vectors(points: &[[f64; 3]], bytes: &mut Bytes) -> rayc_vectors {
    let scalar = if bytes.below(16) == 0 { u32::from(bytes.byte()) } else { rayc_scalar::RAYC_SCALAR_F64 as u32 };
    // Reading them as floats, or more closely, stays within the array.
    rayc_vectors { data: points.as_ptr().cast(), count: points.len(), stride: [0, 24, 12, 8][bytes.below(4)], scalar }
}

impl Host {
    fn reach(&mut self, points: &[[f64; 3]]) {
        let finite = points.as_flattened().iter().filter(|x| x.is_finite());
        self.largest = finite.fold(self.largest, |largest, x| largest.max(x.abs()));
    }

    fn note(&self, status: rayc_status) -> bool {
        assert_ne!(status, rayc_status::RAYC_STATUS_PANIC);
        status == rayc_status::RAYC_STATUS_OK
    }

    fn keep<H>(&mut self, status: rayc_status, handle: *mut H, list: fn(&mut Self) -> &mut Vec<*mut H>) {
        assert_eq!(self.note(status), !handle.is_null());
        if !handle.is_null() {
            list(self).push(handle);
        }
    }

    fn create(&mut self, bytes: &mut Bytes) {
        // SAFETY: handles are valid or NULL, arrays are as they say.
        unsafe {
            match bytes.below(4) {
                0 => {
                    let (points, triangles, is_open) = surface::surface(bytes);
                    self.reach(&points);
                    let mut options: rayc_mesh_options = std::mem::zeroed();
                    rayc_default_mesh_options(size_of::<rayc_mesh_options>(), &mut options);
                    (options.open, options.precision) = (is_open.into(), 1 + bytes.below(3) as u32);
                    let (positions, mut mesh) = (vectors(&points, bytes), null_mut());
                    let indices = triangles.as_ptr().cast();
                    let status = rayc_mesh_create(&options, &positions, indices, triangles.len(), &mut mesh);
                    self.keep(status, mesh, |host| &mut host.meshes);
                }
                1 => {
                    let mut octree = null_mut();
                    let status = rayc_octree_create(null(), any(&self.meshes, bytes), &mut octree);
                    self.keep(status, octree, |host| &mut host.octrees);
                }
                2 => {
                    let mut contacts = null_mut();
                    let status = rayc_contacts_create(&mut contacts);
                    self.keep(status, contacts, |host| &mut host.contacts);
                }
                _ => {
                    let mut options: rayc_scene_options = std::mem::zeroed();
                    rayc_default_scene_options(size_of::<rayc_scene_options>(), &mut options);
                    options.precision = 1 + bytes.below(3) as u32;
                    let mut scene = null_mut();
                    let status = rayc_scene_create(&options, &mut scene);
                    self.keep(status, scene, |host| &mut host.scenes);
                }
            }
        }
    }

    fn destroy(&mut self, bytes: &mut Bytes) {
        // SAFETY: handles are valid or NULL, and forgotten.
        let status = unsafe {
            match bytes.below(4) {
                0 => rayc_mesh_destroy(taken(&mut self.meshes, bytes)),
                1 => rayc_octree_destroy(taken(&mut self.octrees, bytes)),
                2 => rayc_contacts_destroy(taken(&mut self.contacts, bytes)),
                _ => {
                    let scene = taken(&mut self.scenes, bytes);
                    self.bodies.retain(|of| of.0 != scene);
                    rayc_scene_destroy(scene)
                }
            }
        };
        assert!(self.note(status));
    }

    /// One of the numbers that the scene gave, of a removed body too, or the one after them.
    fn body(&self, scene: *mut rayc_scene, bytes: &mut Bytes) -> u32 {
        let numbers: Vec<u32> = self.bodies.iter().filter(|of| of.0 == scene).map(|of| of.1).collect();
        let next = numbers.iter().max().map_or(0, |last| last + 1);
        numbers.get(bytes.below(numbers.len() + 1)).copied().unwrap_or(next)
    }

    /// A number is given once, unless it was released.
    fn note_added(&mut self, scene: *mut rayc_scene, body: u32) {
        assert!(!self.bodies.iter().any(|of| (of.0, of.1) == (scene, body)), "{body} is another body's");
        self.bodies.push((scene, body, true));
    }

    /// What is said of a body is that it is there, or that it is not, as it is.
    fn note_of_body(&mut self, status: rayc_status, scene: *mut rayc_scene, body: u32, is_removed: bool) {
        let found = self.bodies.iter_mut().find(|of| (of.0, of.1, of.2) == (scene, body, true));
        assert!(found.is_some() || status != OK, "there is no body {body}");
        assert!(found.is_none() || status != rayc_status::RAYC_STATUS_UNKNOWN_BODY, "there is a body {body}");
        if let Some((.., is_there)) = found {
            *is_there = status != OK || !is_removed;
        }
    }

    fn step(&mut self, bytes: &mut Bytes) {
        let points: Vec<[f64; 3]> = (0..8 + 8 * bytes.below(2))
            .map(|i| if bytes.flag() { surface::cube_corner(i) } else { bytes.point() })
            .collect();
        self.reach(&points);
        let positions = vectors(&points, bytes);
        let (scene, mesh, octree) = (any(&self.scenes, bytes), any(&self.meshes, bytes), any(&self.octrees, bytes));
        let (a, b) = (self.body(scene, bytes), self.body(scene, bytes));
        let (call, mut body) = (bytes.below(9), 0);
        // SAFETY: handles are valid or NULL, arrays are as they say.
        let status = unsafe {
            match call {
                0 => rayc_mesh_set_positions(mesh, &positions),
                1 => rayc_octree_update(octree, mesh),
                2 => rayc_scene_set_positions(scene, a, &positions),
                3 | 4 => rayc_scene_add_mesh(scene, mesh, &mut body),
                5 => rayc_scene_remove_body(scene, a),
                6 => rayc_scene_set_self_collision(scene, a, bytes.below(3) as u32),
                7 => rayc_scene_release_body_numbers(scene),
                _ => rayc_scene_set_pair_collision(scene, a, b, bytes.below(3) as u32),
            }
        };
        if self.note(status) && (call == 3 || call == 4) {
            self.note_added(scene, body);
        }
        if status == OK && call == 7 {
            self.bodies.retain(|of| of.0 != scene || of.2);
        }
        if matches!(call, 2 | 5 | 6) {
            self.note_of_body(status, scene, a, call == 5);
        }
    }

    fn ask(&self, bytes: &mut Bytes) {
        let (a, b) = (any(&self.meshes, bytes), any(&self.meshes, bytes));
        let (octree_a, octree_b) = (any(&self.octrees, bytes), any(&self.octrees, bytes));
        let (scene, contacts) = (any(&self.scenes, bytes), any(&self.contacts, bytes));
        // SAFETY: handles are valid or NULL, places are writable.
        let status = unsafe {
            let mut options: rayc_detection_options = std::mem::zeroed();
            rayc_default_detection_options(size_of::<rayc_detection_options>(), &mut options);
            options.sampling = bytes.below(4) as u32;
            options.sampling_value = [0.0, 0.1, self.largest / 8.0, f64::NAN, 2.0][bytes.below(5)];
            (options.escape, options.past_folds) = (bytes.flag().into(), bytes.flag().into());
            match bytes.below(5) {
                0 => rayc_query_pair(&options, a, octree_a, b, octree_b, contacts),
                1 => rayc_query_self(&options, a, octree_a, contacts),
                2 => rayc_scene_set_detection_options(scene, &options),
                3 => {
                    let ray = rayc_ray { origin: bytes.point(), direction: bytes.point(), t_max: bytes.number() };
                    let mut hit: rayc_hit = std::mem::zeroed();
                    rayc_octree_trace_ray(octree_a, a, &ray, &mut hit)
                }
                _ => rayc_scene_query(scene, contacts),
            }
        };
        if self.note(status) {
            self.read(contacts);
        }
    }

    /// What the list holds is so many contacts of numbers in their range.
    fn read(&self, contacts: *mut rayc_contacts) {
        let mut count = 0;
        // SAFETY: the handle is valid or NULL, the array is as long as it says.
        unsafe {
            if !self.note(rayc_contacts_count(contacts, &mut count)) {
                return;
            }
            let mut all: Vec<rayc_contact> = vec![std::mem::zeroed(); count];
            assert!(self.note(rayc_contacts_copy(contacts, 0, count, all.as_mut_ptr())));
            assert!(all.iter().all(|contact| contact.depth >= 0.0 && contact.area >= 0.0));
            let mut joules = 0.0;
            self.note(rayc_contacts_energy(contacts, null(), 0, null(), &mut joules));
        }
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        // SAFETY: the handles are valid, and gone with the host.
        unsafe {
            self.meshes.drain(..).for_each(|mesh| assert_eq!(rayc_mesh_destroy(mesh), OK));
            self.octrees.drain(..).for_each(|octree| assert_eq!(rayc_octree_destroy(octree), OK));
            self.contacts.drain(..).for_each(|contacts| assert_eq!(rayc_contacts_destroy(contacts), OK));
            self.scenes.drain(..).for_each(|scene| assert_eq!(rayc_scene_destroy(scene), OK));
        }
    }
}

pub fn run(bytes: &mut Bytes) {
    let mut host = Host::default();
    while bytes.are_left() {
        match bytes.below(8) {
            0..=2 => host.create(bytes),
            3 | 4 => host.step(bytes),
            5 | 6 => host.ask(bytes),
            _ => host.destroy(bytes),
        }
    }
}
