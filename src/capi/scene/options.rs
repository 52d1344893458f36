use crate::capi::base::{rayc_scalar, rayc_status};
use crate::capi::ffi::{Options, growing, guard, write_defaults};
use libc::c_void;

/// A piece of work that the library hands to a rayc_parallel_for, which calls it with the library's own `data`.
pub type rayc_task = unsafe extern "C" fn(data: *mut c_void, index: usize);

/// The host's threads: calls task(data, index) once for each index below `count`, on any threads and in any order, and
/// returns when all these calls have returned. `context` is the host's own, from rayc_scene_options.
///
/// It is called only from the thread that asked for a query, or for a step or a product of a contact system, and never from
/// within a task, so a pool that cannot nest is enough. A scene and its contact system used from two threads at once call it
/// from both. It must not call the scene or use the contacts of the query: both return RAYC_STATUS_BUSY. An exception that leaves it ends the process; lend_threads() of raycontact.hpp carries
/// exceptions past the library instead. Indices that it leaves out or calls twice do no harm. It is called in the
/// default floating-point mode; its threads may be in any.
// "C-unwind": so that the exception meets guard(), which ends the process, and no undefined behaviour on the way.
pub type rayc_parallel_for =
    Option<unsafe extern "C-unwind" fn(context: *mut c_void, count: usize, task: rayc_task, data: *mut c_void)>;

/// How a scene works. Fill with rayc_default_scene_options(), then change what you need.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_scene_options {
    /// sizeof(rayc_scene_options).
    pub struct_size: usize,
    /// Arithmetic of detection, a rayc_scalar; all meshes added must have the same. Default RAYC_SCALAR_F64.
    pub precision: u32,
    /// 1: only the calling thread works. n: the scene owns a pool of n threads, which have ended when the scene
    /// is destroyed. 0: such a pool with one thread for each core. At most 1024. Results do not depend on it. The
    /// calling thread does a step of fewer than about 1000 rays alone, and larger ones where that has proved faster, which
    /// is tried now and then.
    ///
    /// After fork() the child may use and destroy a scene too, through its copies of the handles. The pool's
    /// threads are started again with the first query that needs them; where the system gives none, the calling
    /// thread works alone. What the old threads held, a few KiB each, is not freed. Nothing is promised for a
    /// scene or contacts that a call of another thread was using at the fork: they stay RAYC_STATUS_BUSY in the
    /// child. Nor can the library promise what the system's own libraries do not: a child of a process with
    /// several threads may have to call exec() first. The host looks after the threads of its parallel_for
    /// itself. Default 1.
    pub threads: u32,
    /// The host's threads, to be used instead; `threads` must then be 1. Results do not depend on it either. Default NULL.
    pub parallel_for: rayc_parallel_for,
    /// What parallel_for is called with; it stays the host's. Default NULL.
    pub parallel_context: *mut c_void,
}

growing!(rayc_scene_options, threads: u32);

impl Options for rayc_scene_options {
    fn defaults() -> Self {
        Self {
            struct_size: size_of::<Self>(),
            precision: rayc_scalar::RAYC_SCALAR_F64 as u32,
            threads: 1,
            parallel_for: None,
            parallel_context: std::ptr::null_mut(),
        }
    }
}

/// Fills `options` with the defaults. struct_size: sizeof(rayc_scene_options).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_default_scene_options(
    struct_size: usize,
    options: *mut rayc_scene_options,
) -> rayc_status {
    guard(|| write_defaults(struct_size, options))
}
