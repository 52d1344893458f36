//! Keeps a pool's threads awake from the first phase of a step to its last: between phases they would fall asleep, and
//! waking one takes as long as a small phase.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

thread_local! {
    /// How many pieces of work are under way on this thread, one within another.
    static DEPTH: Cell<usize> = const { Cell::new(0) };
}

/// Runs the work on a thread of a pool while so many others look for parts of it.
pub(crate) fn keep_awake(others: usize, work: impl FnOnce() + Send) {
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

/// Does the work for each item, with the item's place; the first has this place.
pub(crate) fn for_each<I: Send>(first: usize, items: &mut [I], work: &(impl Fn(usize, &mut I) + Sync)) {
    match items {
        [] => {}
        [item] => work(first, item),
        items => {
            let middle = items.len() / 2;
            let (before, behind) = items.split_at_mut(middle);
            join(|| for_each(first, before, work), || for_each(first + middle, behind, work));
        }
    }
}

/// Does the work for the items of two slices that stand at the same place, as far as the shorter reaches.
pub(crate) fn for_each_two<I: Send, J: Send>(
    first: &mut [I],
    second: &mut [J],
    work: &(impl Fn(&mut I, &mut J) + Sync),
) {
    match first.len().min(second.len()) {
        0 => {}
        1 => work(&mut first[0], &mut second[0]),
        count => {
            let (first, first_behind) = first.split_at_mut(count / 2);
            let (second, second_behind) = second.split_at_mut(count / 2);
            join(|| for_each_two(first, second, work), || for_each_two(first_behind, second_behind, work));
        }
    }
}

/// Does both, the second on another thread if one comes for it. Waits for that thread without falling asleep: it might wake
/// up on the core of the thread that wakes it, and the two would take turns there.
fn join(first: impl FnOnce() + Send, second: impl FnOnce() + Send) {
    let [has_begun, is_done] = [AtomicBool::new(false), AtomicBool::new(false)];
    let first = || {
        first();
        if has_begun.load(Ordering::Acquire) {
            help_until(&is_done);
        }
    };
    let second = || {
        has_begun.store(true, Ordering::Release);
        let _done = SetAtEnd(&is_done);
        second();
    };
    rayon::join(|| at_work(first), || at_work(second));
}

/// Does one part of the work.
fn at_work(part: impl FnOnce()) {
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
    if DEPTH.get() == 0 {
        at_work(|| help_until(is_done));
    }
}

/// Does what there is to do until something is done.
fn help_until(is_done: &AtomicBool) {
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
