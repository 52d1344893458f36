use super::failure::{Failure, rayc_status};
use libc::c_char;
use std::any::Any;
use std::cell::RefCell;
use std::ffi::CString;
use std::panic::{AssertUnwindSafe, catch_unwind};

thread_local! {
    static LAST_ERROR: RefCell<CString> = RefCell::default();
}

/// The one door through which every export that can fail goes: no panic passes, and the outcome is recorded for
/// rayc_last_error_message().
pub(super) fn guard(call: impl FnOnce() -> Result<(), Failure>) -> rayc_status {
    let call = || {
        #[cfg(test)]
        super::faults::strike();
        call()
    };
    let outcome = catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|panic| Err(caught(&*panic)));
    let (status, message) = match outcome {
        Ok(()) => (rayc_status::RAYC_STATUS_OK, String::new()),
        Err(failure) => (failure.status, failure.message),
    };
    // A thread that is ending has no place for the message; the status still arrives.
    let _ = LAST_ERROR.try_with(|last| {
        if !(message.is_empty() && last.borrow().is_empty()) {
            *last.borrow_mut() = CString::new(message.replace('\0', "?")).unwrap_or_default();
        }
    });
    status
}

/// The door for exports that return a plain value: `otherwise` stands in for it after a panic.
pub(super) fn guard_value<V>(otherwise: V, call: impl FnOnce() -> V) -> V {
    let call = || {
        #[cfg(test)]
        super::faults::strike();
        call()
    };
    catch_unwind(AssertUnwindSafe(call)).unwrap_or(otherwise)
}

fn caught(panic: &(dyn Any + Send)) -> Failure {
    let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
    let text = text.unwrap_or("no description");
    Failure::new(
        rayc_status::RAYC_STATUS_PANIC,
        format!(
            "a fault inside the library was caught: {text}; destroy the handles of this call, and please report it"
        ),
    )
}

/// What was wrong with this thread's last call, where, and what to do; "" after a success. UTF-8.
///
/// The text belongs to the library and stays until this thread's next call. Never NULL.
#[unsafe(no_mangle)]
pub extern "C" fn rayc_last_error_message() -> *const c_char {
    guard_value(c"".as_ptr(), || LAST_ERROR.try_with(|last| last.borrow().as_ptr()).unwrap_or(c"".as_ptr()))
}
