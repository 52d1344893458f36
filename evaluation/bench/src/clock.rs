//! The time of a step, without the time in which the system gave the core to others.

use std::time::Instant;

/// How long `work` takes, in microseconds: on the wall's clock, or, where the system took the core away meanwhile, on
/// the thread's own. The latter knows only this thread, so it is left alone for work on several.
pub fn time<T>(threads: u32, work: impl FnOnce() -> T) -> (f64, T) {
    let before = (switches(), thread_time());
    let start = Instant::now();
    let result = work();
    let wall = start.elapsed().as_secs_f64() * 1e6;
    let after = (thread_time(), switches());
    let was_interrupted = threads == 1 && after.1 != before.0;
    (if was_interrupted { wall.min(after.0 - before.1) } else { wall }, result)
}

/// Microseconds for which this thread has had a core.
fn thread_time() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the time is written where it belongs.
    unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &mut time) };
    time.tv_sec as f64 * 1e6 + time.tv_nsec as f64 * 1e-3
}

/// How often this thread has lost its core against its will.
fn switches() -> i64 {
    // SAFETY: all fields are numbers, for which zero is a value.
    let mut usage: libc::rusage = unsafe { std::mem::zeroed() };
    // SAFETY: the usage is written where it belongs.
    unsafe { libc::getrusage(libc::RUSAGE_THREAD, &mut usage) };
    usage.ru_nivcsw
}
