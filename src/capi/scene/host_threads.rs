use super::options::rayc_task;
use crate::capi::ffi::DefaultMode;
use crate::memory;
use crate::threads::ParallelFor;
use libc::c_void;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Mutex, PoisonError};

/// The threads of a host in C.
pub(in crate::capi) struct HostThreads {
    pub(in crate::capi) parallel_for: unsafe extern "C-unwind" fn(*mut c_void, usize, rayc_task, *mut c_void),
    pub(in crate::capi) context: *mut c_void,
}

// SAFETY: context is only handed to the host's function, which the host lets be called from any thread that uses the scene.
unsafe impl Send for HostThreads {}

// SAFETY: as above; a scene and its contact system may call it from two threads at once, as is documented.
unsafe impl Sync for HostThreads {}

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

/// What `data` of a task points to.
struct Call<'a> {
    task: &'a (dyn Fn(usize) + Sync),
    panic: Mutex<Option<Box<dyn Any + Send>>>,
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
