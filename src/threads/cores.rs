//! Has a pool's threads wake up on different cores.
//!
//! Linux puts a thread that wakes up on a core that is idle. But in a virtual machine it takes idle cores for busy ones where
//! the machine below has put them to rest (`available_idle_cpu` of its scheduler), and then chooses the core of the thread
//! that wakes it. The two would take turns there until the system moves one, which may take longer than a step. So the first
//! thread of a step restricts the others to the other cores before it wakes them; once awake they may run anywhere
//! again. Other systems are left to themselves.

#[cfg(target_os = "linux")]
pub(crate) use of_linux::Placement;
#[cfg(not(target_os = "linux"))]
pub(crate) use of_others::Placement;

#[cfg(target_os = "linux")]
mod of_linux {
    use rustix::thread::{self, CpuSet, Pid};
    use std::sync::OnceLock;
    use std::sync::atomic::{AtomicBool, Ordering};

    /// Where the threads of a pool are.
    pub(crate) struct Placement(Vec<PoolThread>);

    #[derive(Default)]
    struct PoolThread {
        thread: OnceLock<Pid>,
        /// Whether the thread is kept from some cores.
        is_restricted: AtomicBool,
    }

    impl Placement {
        pub(crate) fn new(count: usize) -> Self {
            Self((0..count).map(|_| PoolThread::default()).collect())
        }

        /// To be called by the thread of this number.
        pub(crate) fn register(&self, number: usize) {
            let _ = self.0[number].thread.set(thread::gettid());
        }

        /// Keeps the other threads from the core of this one, and from one another's, until they are released or what this
        /// gives is dropped. Threads that the host has bound to cores of their own stay there.
        pub(crate) fn keep_others_off_this_core(&self) -> Restricted<'_> {
            Restricted { placement: self, all: self.restrict_others() }
        }

        /// Restricts them; gives which cores they may use otherwise.
        fn restrict_others(&self) -> Option<CpuSet> {
            let all = thread::sched_getaffinity(None).ok()?;
            let here = thread::sched_getcpu();
            let own = rayon::current_thread_index();
            let others = || self.0.iter().enumerate().filter(|&(number, _)| Some(number) != own);
            let free = (all.count() as usize).saturating_sub(1);
            let parts = others().count().min(free);
            if parts == 0 || !all.is_set(here) {
                return None;
            }
            for (place, (_, pool_thread)) in others().enumerate() {
                let Some(&thread) = pool_thread.thread.get() else { continue };
                let mut part = CpuSet::new();
                let cores = (0..CpuSet::MAX_CPU).filter(|&core| core != here && all.is_set(core));
                cores.take(free).skip(place % parts).step_by(parts).for_each(|core| part.set(core));
                if thread::sched_getaffinity(Some(thread)).is_ok_and(|allowed| allowed == all) {
                    pool_thread
                        .is_restricted
                        .store(thread::sched_setaffinity(Some(thread), &part).is_ok(), Ordering::Release);
                }
            }
            Some(all)
        }
    }

    /// Threads that are kept off a core.
    pub(crate) struct Restricted<'a> {
        placement: &'a Placement,
        all: Option<CpuSet>,
    }

    impl Restricted<'_> {
        /// Lets the calling thread run anywhere again.
        pub(crate) fn release(&self) {
            if let Some(number) = rayon::current_thread_index() {
                self.placement.0[number].release(&self.all);
            }
        }
    }

    /// Releases the threads that were never woken, too.
    impl Drop for Restricted<'_> {
        fn drop(&mut self) {
            self.placement.0.iter().for_each(|pool_thread| pool_thread.release(&self.all));
        }
    }

    impl PoolThread {
        fn release(&self, all: &Option<CpuSet>) {
            if let (Some(all), Some(&thread), true) =
                (all, self.thread.get(), self.is_restricted.swap(false, Ordering::AcqRel))
            {
                // It may only fail where restricting it should have failed too.
                let _ = thread::sched_setaffinity(Some(thread), all);
            }
        }
    }
}

#[cfg(not(target_os = "linux"))]
mod of_others {
    /// Where the threads of a pool are: only the system knows.
    pub(crate) struct Placement;

    impl Placement {
        pub(crate) fn new(_: usize) -> Self {
            Self
        }

        pub(crate) fn register(&self, _: usize) {}

        pub(crate) fn keep_others_off_this_core(&self) -> Restricted {
            Restricted
        }
    }

    /// No thread is restricted.
    pub(crate) struct Restricted;

    impl Restricted {
        pub(crate) fn release(&self) {}
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::Placement;
    use rustix::thread::{CpuSet, gettid, sched_getaffinity, sched_getcpu, sched_setaffinity};
    use std::sync::mpsc::channel;
    use std::thread;

    fn cores(set: &CpuSet) -> Vec<usize> {
        (0..CpuSet::MAX_CPU).filter(|&core| set.is_set(core)).collect()
    }

    /// Three threads, of which the host has bound the last to one core.
    #[test]
    fn threads_are_restricted_until_released_and_bound_ones_stay_bound() {
        let all = sched_getaffinity(None).expect("Linux tells");
        let mut bound = CpuSet::new();
        bound.set(cores(&all)[0]);
        let placement = Placement::new(3);
        thread::scope(|scope| {
            let (told, ids) = channel();
            let mut wakes = Vec::new();
            for number in 0..3 {
                let (wake, woken) = channel::<()>();
                let (told, placement, bound) = (told.clone(), &placement, &bound);
                scope.spawn(move || {
                    placement.register(number);
                    if number == 2 {
                        sched_setaffinity(None, bound).expect("it is one of the thread's own cores");
                    }
                    told.send((number, gettid())).expect("it is listened to");
                    let _ = woken.recv();
                });
                wakes.push(wake);
            }
            let mut threads = [None; 3];
            for (number, thread) in ids.iter().take(3) {
                threads[number] = Some(thread);
            }
            let allowed = || threads.map(|thread| sched_getaffinity(thread).expect("it lives"));

            let here = sched_getcpu();
            let restricted = placement.keep_others_off_this_core();
            let [first, second, last] = allowed();
            // This thread may have moved in between.
            let stayed = sched_getcpu() == here;
            assert_eq!(last, if all.count() == 1 { all } else { bound });
            if all.count() > 1 {
                for set in [first, second] {
                    assert!(set.count() > 0 && set != all && cores(&set).iter().all(|&core| all.is_set(core)));
                    assert!(!stayed || !set.is_set(here));
                }
                let shared = cores(&first).into_iter().filter(|&core| second.is_set(core)).count();
                assert_eq!(shared, if all.count() == 2 { 1 } else { 0 });
            } else {
                assert_eq!([first, second], [all; 2]);
            }
            drop(restricted);
            assert_eq!(allowed(), [all, all, bound]);
            drop(wakes);
        });
    }
}
