//! What a Rust crate has to do for `cpp/ray_step.cpp`, and the way there from C++.

use crate::{obvhs, parry, tinybvh};
use std::ffi::{CStr, c_char};
use std::slice::{from_raw_parts, from_raw_parts_mut};

/// As `BodyView` in `cpp/peer.hpp`.
#[repr(C)]
pub struct BodyView {
    positions: *const f32,
    double_positions: *const f64,
    triangles: *const u32,
    vertex_count: u32,
    triangle_count: u32,
    rows: u32,
    columns: u32,
}

/// As `RayHit` in `cpp/ray_step.hpp`.
#[repr(C, align(16))]
pub struct RayHit {
    pub origin: [f32; 3],
    pub t_min: f32,
    pub direction: [f32; 3],
    pub time: f32,
    pub t_max: f32,
    pub mask: u32,
    pub vertex: u32,
    pub flags: u32,
    pub normal: [f32; 3],
    pub u: f32,
    pub v: f32,
    pub triangle: u32,
    pub geometry: u32,
    pub instance: u32,
    pub part_of_instance: u32,
}

pub trait Structure {
    /// Follows the body to its new positions.
    fn update(&mut self, positions: &[[f32; 3]]);
    /// Writes the nearest hit into the ray, if there is one before its end.
    fn nearest(&self, ray: &mut RayHit);
    /// Whether the ray meets a triangle before its end that does not touch its vertex.
    fn is_occluded(&self, ray: &RayHit) -> bool;
}

/// A structure, and how many positions its body has.
pub struct Handle {
    structure: Box<dyn Structure>,
    vertex_count: usize,
}

/// Null where there is no such method.
///
/// # Safety
/// A terminated string and a good view.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bench_structure_new(method: *const c_char, body: &BodyView) -> *mut Handle {
    let vertex_count = body.vertex_count as usize;
    // SAFETY: the caller's promise.
    let (method, positions, triangles) = unsafe {
        (
            CStr::from_ptr(method),
            from_raw_parts(body.positions.cast(), vertex_count),
            from_raw_parts(body.triangles.cast(), body.triangle_count as usize),
        )
    };
    let structure: Box<dyn Structure> = match method.to_bytes() {
        b"parry3d-refit" => Box::new(parry::Refitted::new(positions, triangles)),
        b"obvhs-refit" => Box::new(obvhs::Refitted::new(positions, triangles)),
        b"tinybvh-refit" => Box::new(tinybvh::Refitted::new(positions, triangles)),
        _ => return std::ptr::null_mut(),
    };
    Box::into_raw(Box::new(Handle { structure, vertex_count }))
}

/// # Safety
/// The positions of the structure's body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bench_structure_update(handle: &mut Handle, positions: *const [f32; 3]) {
    // SAFETY: the caller's promise.
    let positions = unsafe { from_raw_parts(positions, handle.vertex_count) };
    handle.structure.update(positions);
}

/// # Safety
/// As many rays as `count` says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bench_structure_nearest(handle: &Handle, rays: *mut RayHit, count: usize) {
    // SAFETY: the caller's promise.
    for ray in unsafe { from_raw_parts_mut(rays, count) } {
        handle.structure.nearest(ray);
    }
}

/// # Safety
/// As many rays as `count` says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bench_structure_occluded(handle: &Handle, rays: *mut RayHit, count: usize) {
    // SAFETY: the caller's promise.
    for ray in unsafe { from_raw_parts_mut(rays, count) } {
        if handle.structure.is_occluded(ray) {
            ray.t_max = -1.0;
        }
    }
}

/// # Safety
/// A structure from [`bench_structure_new`], not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bench_structure_free(handle: *mut Handle) {
    // SAFETY: the caller's promise.
    drop(unsafe { Box::from_raw(handle) });
}
