use super::failure::Failure;
use super::float_mode::DefaultMode;
use crate::capi::base::rayc_status;
use crate::memory::{self, OutOfMemory, text};
use crate::threads::Threads;
use libc::c_char;
use std::any::Any;
use std::borrow::Cow;
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, PoisonError};
use std::thread;

thread_local! {
    /// Its only zero byte is the last.
    static LAST_ERROR: RefCell<Cow<'static, [u8]>> = const { RefCell::new(Cow::Borrowed(b"\0")) };
}

/// Stays until this thread's next call.
pub(in crate::capi) fn last_error_message() -> *const c_char {
    LAST_ERROR.try_with(|last| last.borrow().as_ptr().cast()).unwrap_or(c"".as_ptr())
}

/// A status and its message.
type Outcome = (rayc_status, Cow<'static, [u8]>);

/// The one door through which every export that can fail goes: no panic passes, and the outcome is recorded for
/// rayc_last_error_message().
pub(in crate::capi) fn guard(call: impl FnOnce() -> Result<(), Failure>) -> rayc_status {
    record(with_reserve(call))
}

fn with_reserve(call: impl FnOnce() -> Result<(), Failure>) -> Outcome {
    if memory::keep_reserve().is_ok() { outcome(call) } else { out_of_memory() }
}

/// Makes the call for each of many scenes, on threads, even where others fail. Writes the status of each call, and fails as the
/// first that does.
pub(in crate::capi) fn guard_each(
    threads: &Threads,
    statuses: &mut [u32],
    call: impl Fn(usize) -> Result<(), Failure> + Sync,
) -> Result<(), Failure> {
    let first = Mutex::new((usize::MAX, OK));
    let one = |place: usize, status: &mut u32| {
        let found = with_reserve(|| call(place));
        *status = found.0 as u32;
        if found.0 != rayc_status::RAYC_STATUS_OK {
            let mut first = first.lock().unwrap_or_else(PoisonError::into_inner);
            if place < first.0 {
                *first = (place, found);
            }
        }
    };
    threads.run(|| threads.helpers().for_each(statuses, one));
    let (place, (status, message)) = first.into_inner().unwrap_or_else(PoisonError::into_inner);
    let message = String::from_utf8_lossy(&message[..message.len() - 1]);
    if place == usize::MAX { Ok(()) } else { Err(Failure::new(status, text!("scene {place}: {message}"))) }
}

/// [`guard`] for calls that free something: they run even where there is no memory to report that it has run out.
pub(in crate::capi) fn guard_end(call: impl FnOnce() -> Result<(), Failure>) -> rayc_status {
    record(outcome(call))
}

fn record((status, message): Outcome) -> rayc_status {
    // A thread that is ending has no place for the message; the status still arrives.
    let _ = LAST_ERROR.try_with(|last| *last.borrow_mut() = message);
    status
}

const OK: Outcome = (rayc_status::RAYC_STATUS_OK, Cow::Borrowed(b"\0"));

fn outcome(call: impl FnOnce() -> Result<(), Failure>) -> Outcome {
    let outcome = caught(call);
    if matches!(outcome, Ok(Ok(()))) {
        return OK;
    }
    // The message too takes memory.
    let told = catch_unwind(AssertUnwindSafe(|| match outcome {
        Ok(Ok(())) => OK,
        Ok(Err(failure)) => (failure.status, ended(&failure.message)),
        Err(panic) if panic.is::<OutOfMemory>() => out_of_memory(),
        Err(panic) => (rayc_status::RAYC_STATUS_PANIC, ended(&description(&*panic))),
    }));
    told.unwrap_or_else(|_| out_of_memory())
}

/// Its message takes no memory.
fn out_of_memory() -> Outcome {
    let message = b"there is no memory for what the call makes; nothing has changed: free some and call again\0";
    (rayc_status::RAYC_STATUS_OUT_OF_MEMORY, Cow::Borrowed(message))
}

/// A message as C reads it.
fn ended(message: &str) -> Cow<'static, [u8]> {
    let mut text = memory::with_room(message.len() + 1);
    memory::append(&mut text, message.bytes().map(|byte| if byte == 0 { b'?' } else { byte }));
    text.push(0);
    Cow::Owned(text)
}

/// The door for exports that return a plain value: `otherwise` stands in for it after a panic.
pub(in crate::capi) fn guard_value<V>(otherwise: V, call: impl FnOnce() -> V) -> V {
    caught(call).unwrap_or(otherwise)
}

/// Makes the call in the default floating-point mode, and gives the caller its own back even after a panic.
fn caught<V>(call: impl FnOnce() -> V) -> thread::Result<V> {
    let _mode = DefaultMode::enter();
    catch_unwind(AssertUnwindSafe(|| {
        #[cfg(test)]
        crate::capi::faults::strike();
        call()
    }))
}

fn description(panic: &(dyn Any + Send)) -> String {
    let what = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
    let what = what.unwrap_or("no description");
    text!("a fault inside the library was caught: {what}; destroy the handles of this call, and please report it")
}
