use super::rayc_scene;
use crate::capi::ffi::{Failure, changing, guard_each, slice, slice_mut, with_precision};
use crate::threads::Threads;

/// Pointers of the host's, one for each of many scenes.
pub(in crate::capi) struct Pointers<'a, V>(&'a [*mut V]);

// SAFETY: each pointer is used by one thread at a time, that of its scene; a handle that another call uses is refused.
unsafe impl<V> Sync for Pointers<'_, V> {}

impl<V> Pointers<'_, V> {
    /// # Safety
    /// That of [`slice()`].
    pub(in crate::capi) unsafe fn new(all: *const *mut V, count: usize, name: &str) -> Result<Self, Failure> {
        Ok(Self(slice(all, count, name)?))
    }

    pub(in crate::capi) fn of(&self, scene: usize) -> *mut V {
        self.0[scene]
    }
}

/// Makes a call for each scene on the threads of the first one; within the calls, each scene works alone.
///
/// # Safety
/// `statuses` is NULL or has room for a number for each scene; the scenes are as [`changing`] says.
pub(in crate::capi) unsafe fn for_each_scene(
    scenes: &Pointers<'_, rayc_scene>,
    statuses: *mut u32,
    call: impl Fn(usize, *mut rayc_scene) -> Result<(), Failure> + Sync,
) -> Result<(), Failure> {
    let statuses = slice_mut(statuses, scenes.0.len(), "statuses")?;
    let Some(&first) = scenes.0.first() else { return Ok(()) };
    let mut threads = Threads::default();
    exchange(first, &mut threads)?;
    threads.follow_fork();
    let found = guard_each(&threads, statuses, |place| {
        let (scene, mut own) = (scenes.of(place), Threads::default());
        exchange(scene, &mut own)?;
        let found = call(place, scene);
        exchange(scene, &mut own).and(found)
    });
    exchange(first, &mut threads).and(found)
}

/// Gives a scene these threads, and takes its own.
///
/// # Safety
/// That of [`changing`].
unsafe fn exchange(scene: *mut rayc_scene, threads: &mut Threads) -> Result<(), Failure> {
    let mut scene = changing(scene, "scene")?;
    with_precision!(&mut scene.scene, |scene| scene.exchange_threads(threads));
    Ok(())
}
