//! A panic on purpose on whichever thread takes the n-th item of a thread's work, for tests of this crate alone.

use std::cell::RefCell;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

thread_local! {
    static FAULT: RefCell<Fault> = const { RefCell::new(Fault(None)) };
}

/// How many items are done before; usize::MAX: it has struck. It belongs to the thread that asked for it and to those that
/// work for that thread, so that tests beside it notice nothing.
#[derive(Clone)]
pub(crate) struct Fault(Option<Arc<AtomicUsize>>);

/// Strikes the work that this thread asks for from here on.
pub(crate) fn strike_after(items: usize) {
    FAULT.set(Fault(Some(Arc::new(AtomicUsize::new(items)))));
}

/// Whether the panic is still to come; it does not come any more.
pub(crate) fn call_off() -> bool {
    FAULT.replace(Fault(None)).0.is_some_and(|items| items.load(Ordering::SeqCst) != usize::MAX)
}

impl Fault {
    pub(crate) fn of_this_thread() -> Self {
        FAULT.with_borrow(Self::clone)
    }

    /// Makes it the fault of the thread that calls this, until the result is dropped.
    pub(crate) fn take_along(&self) -> TakenAlong {
        TakenAlong { before: FAULT.replace(self.clone()) }
    }

    /// Called by whoever takes an item of the work.
    pub(crate) fn strike(&self) -> TakenAlong {
        let count_down = |items: usize| (items != usize::MAX).then(|| items.wrapping_sub(1));
        if let Some(items) = &self.0
            && items.fetch_update(Ordering::SeqCst, Ordering::SeqCst, count_down) == Ok(0)
        {
            panic!("an item on purpose");
        }
        self.take_along()
    }
}

/// What the thread had before comes back at the end, also of a panic.
pub(crate) struct TakenAlong {
    before: Fault,
}

impl Drop for TakenAlong {
    fn drop(&mut self) {
        FAULT.set(Fault(self.before.0.take()));
    }
}
