//! The other libraries, compiled for this very processor, behind one small C interface: `cpp/peer.hpp`.
//!
//! A shared library shows only symbols that Rust defines, hence the functions here that pass on.

mod obvhs;
mod parry;
mod structure;
mod tinybvh;

use std::ffi::{c_char, c_void};

mod cpp {
    use super::*;
    unsafe extern "C" {
        pub fn bench_peer_new(method: *const c_char, threads: u32, bodies: *const c_void, count: usize) -> *mut c_void;
        pub fn bench_peer_step(peer: *mut c_void, stages: *mut f64) -> bool;
        pub fn bench_peer_contacts(peer: *const c_void, count: *mut usize) -> *const c_void;
        pub fn bench_peer_free(peer: *mut c_void);
        pub fn bench_rays_new(
            is_embree_4: bool,
            instructions: *const c_char,
            refits: bool,
            body: *const c_void,
        ) -> *mut c_void;
        pub fn bench_rays_trace(rays: *const c_void, hits: *mut c_void, count: usize, way: u32);
        pub fn bench_rays_free(rays: *mut c_void);
    }
}

/// A peer for these bodies; null where there is no such method.
///
/// # Safety
/// A terminated string, and `count` bodies whose arrays outlive the peer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn peer_new(
    method: *const c_char,
    threads: u32,
    bodies: *const c_void,
    count: usize,
) -> *mut c_void {
    // SAFETY: the caller's promise.
    unsafe { cpp::bench_peer_new(method, threads, bodies, count) }
}

/// Does one step; false where the method does not separate its stages.
///
/// # Safety
/// A living peer, and room for four stages.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn peer_step(peer: *mut c_void, stages: *mut f64) -> bool {
    // SAFETY: the caller's promise.
    unsafe { cpp::bench_peer_step(peer, stages) }
}

/// The contacts of the last step, good until the next.
///
/// # Safety
/// A living peer, and room for the count.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn peer_contacts(peer: *const c_void, count: *mut usize) -> *const c_void {
    // SAFETY: the caller's promise.
    unsafe { cpp::bench_peer_contacts(peer, count) }
}

/// Ends a peer.
///
/// # Safety
/// A living peer, not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn peer_free(peer: *mut c_void) {
    // SAFETY: the caller's promise.
    unsafe { cpp::bench_peer_free(peer) }
}

/// What traces rays in one body with Embree 3.13 or Embree 4: with no better instructions than `instructions` says, in
/// Embree's words, and with a tree built once, or one that is made to be refitted.
///
/// # Safety
/// A terminated string, and a body whose arrays outlive this.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rays_new(
    is_embree_4: bool,
    instructions: *const c_char,
    refits: bool,
    body: *const c_void,
) -> *mut c_void {
    // SAFETY: the caller's promise.
    unsafe { cpp::bench_rays_new(is_embree_4, instructions, refits, body) }
}

/// Traces rays, which are written over by their hits: one by one (0), or in a coherent (1) or incoherent (2) stream,
/// which Embree 4 does not have.
///
/// # Safety
/// What [`rays_new`] gave, and so many rays, laid out as Embree's.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rays_trace(rays: *const c_void, hits: *mut c_void, count: usize, way: u32) {
    // SAFETY: the caller's promise.
    unsafe { cpp::bench_rays_trace(rays, hits, count, way) }
}

/// Ends what [`rays_new`] gave.
///
/// # Safety
/// It is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rays_free(rays: *mut c_void) {
    // SAFETY: the caller's promise.
    unsafe { cpp::bench_rays_free(rays) }
}
