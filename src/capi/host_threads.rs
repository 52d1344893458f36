use super::float_mode::DefaultMode;
use crate::memory;
use crate::threads::ParallelFor;
use libc::c_void;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Mutex, PoisonError};

/// A piece of work that the library hands to a rayc_parallel_for, which calls it with the library's own `data`.
pub type rayc_task = unsafe extern "C" fn(data: *mut c_void, index: usize);

/// The host's threads: calls task(data, index) once for each index below `count`, on any threads and in any order, and
/// returns when all these calls have returned. `context` is the host's own, from rayc_scene_options.
///
/// The library calls it only from the thread that called rayc_scene_query(), and never from within a task, so a pool
/// that cannot nest is enough. It must not call the scene or use the contacts of the query: both return
/// RAYC_STATUS_BUSY. An exception that leaves it ends the process; lend_threads() of raycontact.hpp carries
/// exceptions past the library instead. Indices that it leaves out or calls twice do no harm. It is called in the
/// default floating-point mode; its threads may be in any.
// "C-unwind": so that the exception meets guard(), which ends the process, and no undefined behaviour on the way.
pub type rayc_parallel_for =
    Option<unsafe extern "C-unwind" fn(context: *mut c_void, count: usize, task: rayc_task, data: *mut c_void)>;

/// The threads of a host in C.
pub(super) struct HostThreads {
    pub(super) parallel_for: unsafe extern "C-unwind" fn(*mut c_void, usize, rayc_task, *mut c_void),
    pub(super) context: *mut c_void,
}

// SAFETY: context is only handed to the host's function, which the host lets be called from any thread that uses the scene.
unsafe impl Send for HostThreads {}
// SAFETY: as above; a scene is used by one thread at a time.
unsafe impl Sync for HostThreads {}

/// What `data` of a task points to.
struct Call<'a> {
    task: &'a (dyn Fn(usize) + Sync),
    panic: Mutex<Option<Box<dyn Any + Send>>>,
}

impl ParallelFor for HostThreads {
    fn run(&self, count: usize, task: &(dyn Fn(usize) + Sync)) {
        let call = Call { task, panic: Mutex::new(None) };
        // SAFETY: the host's function, called as documented; `call` stays until it returns, when all tasks have.
        unsafe { (self.parallel_for)(self.context, count, run_task, (&raw const call).cast_mut().cast()) };
        if let Some(panic) = call.panic.into_inner().unwrap_or_else(PoisonError::into_inner) {
            resume_unwind(panic);
        }
    }
}

/// No panic passes into the host's threads; it goes on where the library was called. What comes after it is left out.
unsafe extern "C" fn run_task(data: *mut c_void, index: usize) {
    let _mode = DefaultMode::enter();
    // SAFETY: `data` is what `run` handed over.
    let call = unsafe { &*data.cast_const().cast::<Call>() };
    let panic = || call.panic.lock().unwrap_or_else(PoisonError::into_inner);
    if panic().is_some() {
        return;
    }
    let outcome = match memory::keep_reserve() {
        Ok(()) => catch_unwind(AssertUnwindSafe(|| (call.task)(index))),
        Err(out_of_memory) => Err(Box::new(out_of_memory) as _),
    };
    if let Err(found) = outcome {
        *panic() = Some(found);
    }
}
