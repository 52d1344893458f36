//! The other libraries, compiled for this very processor, behind one small C interface: `cpp/peer.hpp`.
//!
//! A shared library shows only symbols that Rust defines, hence the functions here that pass on.

mod obvhs;
mod parry;
mod structure;

use std::ffi::{c_char, c_void};

mod cpp {
    use super::*;
    unsafe extern "C" {
        pub fn bench_peer_new(method: *const c_char, threads: u32, bodies: *const c_void, count: usize) -> *mut c_void;
        pub fn bench_peer_step(peer: *mut c_void, stages: *mut f64) -> bool;
        pub fn bench_peer_contacts(peer: *const c_void, count: *mut usize) -> *const c_void;
        pub fn bench_peer_free(peer: *mut c_void);
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
