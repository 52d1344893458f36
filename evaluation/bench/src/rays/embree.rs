//! Embree's rays, out of the shared library with the peers.

use super::kinds::Ray;
use crate::peer::{BodyView, Library};
use std::ffi::{CString, c_void};

pub const NO_TRIANGLE: u32 = u32::MAX;

/// As `RayHit` in `peers/cpp/ray_step.hpp`.
#[repr(C, align(16))]
#[derive(Clone, Copy)]
pub struct RayHit {
    origin: [f32; 3],
    t_min: f32,
    direction: [f32; 3],
    time: f32,
    /// Where it ends; after tracing where it hits.
    pub t_max: f32,
    mask: u32,
    id: u32,
    flags: u32,
    normal: [f32; 3],
    weights: [f32; 2],
    pub triangle: u32,
    geometry: u32,
    instance: u32,
    part_of_instance: u32,
}

impl From<&Ray> for RayHit {
    fn from(ray: &Ray) -> Self {
        Self {
            origin: ray.origin,
            t_min: 0.0,
            direction: ray.direction,
            time: 0.0,
            t_max: f32::INFINITY,
            mask: u32::MAX,
            id: 0,
            flags: 0,
            normal: [0.0; 3],
            weights: [0.0; 2],
            triangle: NO_TRIANGLE,
            geometry: NO_TRIANGLE,
            instance: NO_TRIANGLE,
            part_of_instance: NO_TRIANGLE,
        }
    }
}

/// As `Way` in `peers/cpp/embree.hpp`.
#[derive(Clone, Copy)]
pub enum Way {
    Single,
    CoherentStream,
    IncoherentStream,
}

pub struct Surface<'a> {
    library: &'a Library,
    scene: *mut c_void,
}

impl<'a> Surface<'a> {
    /// The view must stay good.
    pub fn new(library: &'a Library, is_embree_4: bool, instructions: &str, refits: bool, view: &BodyView) -> Self {
        let terminated = CString::new(instructions).expect("names hold no zero");
        // SAFETY: the view is good.
        Self { library, scene: unsafe { (library.rays_new)(is_embree_4, terminated.as_ptr(), refits, view) } }
    }

    pub fn trace(&self, rays: &mut [RayHit], way: Way) {
        // SAFETY: the scene lives.
        unsafe { (self.library.rays_trace)(self.scene, rays.as_mut_ptr().cast(), rays.len(), way as u32) }
    }
}

impl Drop for Surface<'_> {
    fn drop(&mut self) {
        // SAFETY: the scene lives, and ends here.
        unsafe { (self.library.rays_free)(self.scene) }
    }
}
