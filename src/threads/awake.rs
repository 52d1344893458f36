//! Keeps a pool's threads spinning from the first phase of a step to its last: between phases they would fall asleep, and
//! waking one takes as long as a small phase.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

thread_local! {
    /// How many items of work are under way on this thread, one within another.
    static DEPTH: Cell<usize> = const { Cell::new(0) };
}

/// Runs the work on a thread of a pool while so many others look for parts of it.
pub(super) fn keep_awake(others: usize, work: impl FnOnce() + Send) {
    let is_done = AtomicBool::new(false);
    let work = || {
        let _done = SetAtEnd(&is_done);
        at_work(work);
    };
    if others > 0 {
        rayon::join(work, || look_for_work(others, &is_done));
    } else {
        work();
    }
}

/// Does one part of the work.
pub(super) fn at_work(part: impl FnOnce()) {
    /// Counts down even where the part panics.
    struct Below;

    impl Drop for Below {
        fn drop(&mut self) {
            DEPTH.set(DEPTH.get() - 1);
        }
    }

    DEPTH.set(DEPTH.get() + 1);
    let _below = Below;
    part();
}

fn look_for_work(threads: usize, is_done: &AtomicBool) {
    if threads > 1 {
        rayon::join(|| look_until(is_done), || look_for_work(threads - 1, is_done));
    } else {
        look_until(is_done);
    }
}

fn look_until(is_done: &AtomicBool) {
    // A thread that waits within a part for another may take this up: what it waits for might wait for that part in turn.
    if DEPTH.get() > 0 {
        return;
    }
    while !is_done.load(Ordering::Acquire) {
        if rayon::yield_now() != Some(rayon::Yield::Executed) {
            // Lets other threads have the core.
            thread::yield_now();
        }
    }
}

struct SetAtEnd<'a>(&'a AtomicBool);

impl Drop for SetAtEnd<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}
