//! Whose threads work: the caller's own, a pool's, or the host's. Results do not depend on it, to the bit.

mod append;
mod awake;
#[cfg(test)]
pub(crate) mod faults;

use rayon::ThreadPoolBuildError;
use std::fmt;
use std::mem;
use std::num::NonZeroUsize;
use std::process;
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::thread::{Builder, JoinHandle, available_parallelism};

/// Threads that a host lends.
///
/// The library calls it only from the thread that made the call of the library, and never while one of its calls is under
/// way: so a pool that cannot nest will do. But a scene and its contact system that are used from two threads at once call it
/// from both.
pub trait ParallelFor: Send + Sync {
    /// Calls `task` once with each number below `count`, on any threads and in any order, and returns when all these calls
    /// have returned.
    fn run(&self, count: usize, task: &(dyn Fn(usize) + Sync));
}

/// This many items keep a host's threads busy, or one thread of a pool.
const MANY: usize = 8;

/// The threads that may help the calling thread with many items.
#[derive(Clone, Default)]
pub(crate) enum Helpers {
    /// None: the calling thread works alone.
    #[default]
    Nobody,
    /// The pool on which the call is run, which may also be asked from one of its own threads.
    Pool,
    /// The host's threads.
    Host(Arc<dyn ParallelFor>),
}

impl fmt::Debug for Helpers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Nobody => "Nobody",
            Self::Pool => "Pool",
            Self::Host(_) => "Host",
        })
    }
}

impl Helpers {
    /// Whether there are any.
    pub(crate) fn are_there(&self) -> bool {
        !matches!(self, Self::Nobody)
    }

    /// The host's threads, if it lends them, for as long as the scene is there.
    pub(crate) fn lent(&self) -> Option<Weak<dyn ParallelFor>> {
        if let Self::Host(host) = self { Some(Arc::downgrade(host)) } else { None }
    }

    /// Who helps with so many items, and who within each of them: nobody where items are enough. A host is never asked from
    /// one of its own calls, so it helps within items where these are few.
    pub(crate) fn outside_and_within(&self, items: usize) -> [Self; 2] {
        match self {
            Self::Host(_) if items < MANY => [Self::Nobody, self.clone()],
            Self::Pool if items < MANY * rayon::current_num_threads() => [Self::Pool, Self::Pool],
            _ => [self.clone(), Self::Nobody],
        }
    }

    /// Does the work for each item, with the item's place.
    pub(crate) fn for_each<I: Send>(&self, items: &mut [I], work: impl Fn(usize, &mut I) + Sync) {
        #[cfg(test)]
        let fault = faults::Fault::of_this_thread();
        let work = |place: usize, item: &mut I| {
            #[cfg(test)]
            let _taken_along = fault.strike();
            work(place, item);
        };
        match self {
            Self::Pool => awake::for_each(0, items, &work),
            Self::Nobody => items.iter_mut().enumerate().for_each(|(place, item)| work(place, item)),
            Self::Host(host) => share(&**host, items.iter_mut().enumerate(), |(place, item)| work(place, item)),
        }
    }

    /// Does the work for the items of two slices that stand at the same place, as far as the shorter reaches.
    pub(crate) fn for_each_two<I: Send, J: Send>(
        &self,
        first: &mut [I],
        second: &mut [J],
        work: impl Fn(&mut I, &mut J) + Sync,
    ) {
        #[cfg(test)]
        let fault = faults::Fault::of_this_thread();
        let both = |(i, j): (&mut I, &mut J)| {
            #[cfg(test)]
            let _taken_along = fault.strike();
            work(i, j);
        };
        match self {
            Self::Pool => awake::for_each_two(first, second, &|i, j| both((i, j))),
            Self::Nobody => first.iter_mut().zip(second).for_each(both),
            Self::Host(host) => share(&**host, first.iter_mut().zip(second), both),
        }
    }
}

/// Shares the items out to the host's threads: each call takes the next, whatever its number, so none is worked on twice.
fn share<I>(host: &dyn ParallelFor, items: impl ExactSizeIterator<Item = I> + Send, work: impl Fn(I) + Sync) {
    let count = items.len();
    let items = Mutex::new(items);
    let take = || items.lock().unwrap_or_else(PoisonError::into_inner).next();
    if count > 1 {
        host.run(count, &|_| take().into_iter().for_each(&work));
    }
    // A single item is not worth the call; and a host may have called too seldom.
    while let Some(item) = take() {
        work(item);
    }
}

/// The threads of a scene; by default, the caller's own.
#[derive(Default)]
pub(crate) struct Threads {
    pool: Option<Pool>,
    helpers: Helpers,
}

impl fmt::Debug for Threads {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.helpers.fmt(f)
    }
}

impl Threads {
    /// 1: the caller's own thread; n: a pool of n; 0: a pool of one for each core.
    pub(crate) fn new(count: usize) -> Result<Self, ThreadPoolBuildError> {
        Ok(match count {
            1 => Self::default(),
            _ => Self { pool: Some(Pool::new(count)?), helpers: Helpers::Pool },
        })
    }

    pub(crate) fn of_host(host: Arc<dyn ParallelFor>) -> Self {
        Self { pool: None, helpers: Helpers::Host(host) }
    }

    /// Starts the pool anew in a process that was forked since: its threads stayed behind. Where the system gives none, the
    /// caller's own thread works.
    pub(crate) fn follow_fork(&mut self) {
        if let Some(count) = self.pool.as_ref().filter(|pool| !pool.is_here()).map(|pool| pool.threads.len()) {
            self.pool = Pool::new(count).ok();
            self.helpers = if self.pool.is_some() { Helpers::Pool } else { Helpers::Nobody };
        }
    }

    pub(crate) fn helpers(&self) -> &Helpers {
        &self.helpers
    }

    /// Runs the work where the helpers can help.
    pub(crate) fn run(&self, work: impl FnOnce() + Send) {
        #[cfg(test)]
        let fault = faults::Fault::of_this_thread();
        #[cfg(test)]
        let work = || {
            let _taken_along = fault.take_along();
            work();
        };
        match &self.pool {
            Some(Pool { pool: Some(pool), others, .. }) => pool.install(|| awake::keep_awake(*others, work)),
            _ => work(),
        }
    }
}

/// A pool whose threads have ended when it is dropped, so that the library may then be unloaded.
struct Pool {
    /// The process that has the threads.
    process: u32,
    /// Taken on dropping.
    pool: Option<rayon::ThreadPool>,
    threads: Vec<JoinHandle<()>>,
    /// How many threads beside the first have a core of their own: more would only take turns.
    others: usize,
}

impl Pool {
    fn new(count: usize) -> Result<Self, ThreadPoolBuildError> {
        let cores = available_parallelism().map_or(1, NonZeroUsize::get);
        let count = if count == 0 { cores } else { count };
        let mut threads = Vec::with_capacity(count);
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(count)
            .spawn_handler(|thread| {
                let name = format!("raycontact-{}", thread.index());
                threads.push(Builder::new().name(name).spawn(|| thread.run())?);
                Ok(())
            })
            .build();
        match pool {
            Ok(pool) => Ok(Self { process: process::id(), pool: Some(pool), threads, others: count.min(cores) - 1 }),
            Err(error) => {
                // Those that had been started are told to end.
                join(threads);
                Err(error)
            }
        }
    }

    /// Not so in a process that was forked.
    fn is_here(&self) -> bool {
        self.process == process::id()
    }
}

impl Drop for Pool {
    fn drop(&mut self) {
        if !self.is_here() {
            // Threads that are not there would be waited for, and may have held what they share.
            mem::forget((self.pool.take(), mem::take(&mut self.threads)));
            return;
        }
        drop(self.pool.take());
        join(self.threads.drain(..));
    }
}

fn join(threads: impl IntoIterator<Item = JoinHandle<()>>) {
    for thread in threads {
        // A panic of a task has been passed on to whoever waited for the task.
        let _ = thread.join();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tests run side by side in one process: the fault of one is not to hit the work of another.
    #[test]
    fn a_fault_strikes_what_its_own_thread_asked_for_and_nothing_else() {
        let works = |threads: usize| {
            let threads = Threads::new(threads).expect("the threads start");
            let work = || threads.run(|| threads.helpers().for_each(&mut [0; 3], |place, item| *item = place));
            std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)).is_ok()
        };
        for threads in [1, 2] {
            faults::strike_after(0);
            let other = std::thread::spawn(move || works(threads)).join().expect("it is caught");
            let own = works(threads);
            faults::call_off();
            assert!(other, "{threads} threads: the other thread's work was hit");
            assert!(!own, "{threads} threads: the own work was not hit");
        }
    }
}
