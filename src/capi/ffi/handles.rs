//! Handles: values of the library that the host holds by pointers, marked so that misuse can be told. Marks are no locks: no call
//! waits for another. They cost next to nothing, and tell the host of its mistake without repairing it.

use super::failure::Failure;
use super::pointers::{Output, null};
use crate::capi::base::rayc_status;
use crate::memory::{self, text};
use std::marker::PhantomData;
use std::ops::{Deref, DerefMut};
use std::ptr::NonNull;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

/// What a handle points to.
#[repr(C)]
struct Marked<V> {
    /// That of its kind until it is destroyed; in the same place for every kind.
    mark: AtomicU64,
    /// How many calls are reading the value, or [`CHANGING`].
    users: AtomicU32,
    value: V,
}

/// In place of a number of readers: one call is changing the value.
const CHANGING: u32 = u32::MAX;

/// A type of handle: its name, and the mark of its values.
pub(in crate::capi) struct HandleKind {
    name: &'static str,
    mark: u64,
}

impl HandleKind {
    pub(in crate::capi) const MESH: Self = Self::new("rayc_mesh", b"raycmesh");
    pub(in crate::capi) const OCTREE: Self = Self::new("rayc_octree", b"raycoctr");
    pub(in crate::capi) const CONTACTS: Self = Self::new("rayc_contacts", b"rayccont");
    pub(in crate::capi) const SCENE: Self = Self::new("rayc_scene", b"raycscen");
    pub(in crate::capi) const CONTACT_SYSTEM: Self = Self::new("rayc_contact_system", b"raycsyst");
    const ALL: [Self; 5] = [Self::MESH, Self::OCTREE, Self::CONTACTS, Self::SCENE, Self::CONTACT_SYSTEM];

    const fn new(name: &'static str, mark: &[u8; 8]) -> Self {
        Self { name, mark: u64::from_le_bytes(*mark) }
    }
}

/// What handles point to.
pub(in crate::capi) trait Handle {
    const KIND: HandleKind;
}

/// The type of the handles with this mark.
fn marked_by(mark: u64) -> Option<&'static str> {
    HandleKind::ALL.into_iter().find(|kind| kind.mark == mark).map(|kind| kind.name)
}

/// A handle's value, while a call reads it.
pub(in crate::capi) struct Reading<'a, V> {
    handle: NonNull<Marked<V>>,
    value: PhantomData<&'a V>,
}

impl<V> Deref for Reading<'_, V> {
    type Target = V;

    fn deref(&self) -> &V {
        // SAFETY: no call changes it while this one counts as reading.
        unsafe { &(*self.handle.as_ptr()).value }
    }
}

impl<V> Drop for Reading<'_, V> {
    fn drop(&mut self) {
        // SAFETY: what is being read is not destroyed.
        unsafe { users(self.handle) }.fetch_sub(1, Ordering::Release);
    }
}

/// A handle's value, while a call changes it.
pub(in crate::capi) struct Changing<'a, V> {
    handle: NonNull<Marked<V>>,
    value: PhantomData<&'a mut V>,
}

impl<V> Deref for Changing<'_, V> {
    type Target = V;

    fn deref(&self) -> &V {
        // SAFETY: no other call uses it meanwhile.
        unsafe { &(*self.handle.as_ptr()).value }
    }
}

impl<V> DerefMut for Changing<'_, V> {
    fn deref_mut(&mut self) -> &mut V {
        // SAFETY: as above.
        unsafe { &mut (*self.handle.as_ptr()).value }
    }
}

impl<V> Drop for Changing<'_, V> {
    fn drop(&mut self) {
        // SAFETY: what is being changed is not destroyed.
        unsafe { users(self.handle) }.store(0, Ordering::Release);
    }
}

/// # Safety
/// The handle has not been destroyed.
unsafe fn users<'a, V>(handle: NonNull<Marked<V>>) -> &'a AtomicU32 {
    // SAFETY: by this function's contract; the value beside it is not touched.
    unsafe { &(*handle.as_ptr()).users }
}

/// # Safety
/// `pointer` is NULL, a handle, or points to at least eight bytes that can be read, if it is a multiple of eight. Of
/// memory that was given back and used again, nothing can be told.
unsafe fn found<V: Handle>(pointer: *const V, name: &str) -> Result<NonNull<Marked<V>>, Failure> {
    let handle = NonNull::new(pointer.cast_mut().cast::<Marked<V>>()).ok_or_else(|| null(name))?;
    // SAFETY: by this function's contract.
    let mark = handle.is_aligned().then(|| unsafe { &(*handle.as_ptr()).mark }.load(Ordering::Relaxed));
    if mark == Some(V::KIND.mark) { Ok(handle) } else { Err(no_handle::<V>(name, mark.and_then(marked_by))) }
}

#[cold]
fn no_handle<V: Handle>(name: &str, other: Option<&str>) -> Failure {
    let own = V::KIND.name;
    let message = match other {
        Some(other) => text!("{name} is a handle of an {other}, not of an {own}; pass one of the right type"),
        None => text!("{name} is no handle of an {own}, or has been destroyed; pass one that {own}'s functions gave"),
    };
    Failure::new(rayc_status::RAYC_STATUS_INVALID_HANDLE, message)
}

#[cold]
fn busy(name: &str) -> Failure {
    let message = text!(
        "{name} is in use by a call that has not returned, of another thread or around this one; wait for it, and call no \
         scene from its own parallel_for"
    );
    Failure::new(rayc_status::RAYC_STATUS_BUSY, message)
}

/// The value of a handle that a call only reads, as others may at the same time.
///
/// # Safety
/// As the text of each handle says: what [`found`] cannot tell is the caller's.
pub(in crate::capi) unsafe fn reading<'a, V: Handle>(pointer: *const V, name: &str) -> Result<Reading<'a, V>, Failure> {
    // SAFETY: by this function's contract.
    let handle = unsafe { found(pointer, name) }?;
    let one_more = |users: u32| if users < CHANGING - 1 { Some(users + 1) } else { None };
    // SAFETY: it has just been found.
    let counted = unsafe { users(handle) }.fetch_update(Ordering::Acquire, Ordering::Relaxed, one_more);
    counted.map(|_| Reading { handle, value: PhantomData }).map_err(|_| busy(name))
}

/// The same without counting as a reader, for short calls of many threads: the count would pass from core to core. Refused while
/// another call changes the value; but a call that changes it is not refused meanwhile.
///
/// # Safety
/// As [`reading`], and no call changes it during `'a`.
pub(in crate::capi) unsafe fn glancing<'a, V: Handle>(pointer: *const V, name: &str) -> Result<&'a V, Failure> {
    // SAFETY: by this function's contract.
    unsafe {
        let handle = found(pointer, name)?;
        if users(handle).load(Ordering::Acquire) == CHANGING {
            return Err(busy(name));
        }
        Ok(&(*handle.as_ptr()).value)
    }
}

/// The value of a handle that a call changes, while no other uses it.
///
/// # Safety
/// As [`reading`].
pub(in crate::capi) unsafe fn changing<'a, V: Handle>(pointer: *mut V, name: &str) -> Result<Changing<'a, V>, Failure> {
    // SAFETY: by this function's contract.
    let handle = unsafe { found(pointer.cast_const(), name) }?;
    // SAFETY: it has just been found.
    match unsafe { users(handle) }.compare_exchange(0, CHANGING, Ordering::Acquire, Ordering::Relaxed) {
        Ok(_) => Ok(Changing { handle, value: PhantomData }),
        Err(_) => Err(busy(name)),
    }
}

/// Gives a new handle to the caller.
///
/// # Safety
/// `place` is writable.
pub(in crate::capi) unsafe fn give<V: Handle>(place: Output<*mut V>, value: V) -> Result<(), Failure> {
    // A box of one value, which is laid out as the value itself.
    let boxed = memory::boxed(Marked { mark: AtomicU64::new(V::KIND.mark), users: AtomicU32::new(0), value });
    // SAFETY: by this function's contract.
    unsafe { place.write(Box::into_raw(boxed).cast()) }
}

/// Takes a handle back and drops its value; NULL does nothing.
///
/// # Safety
/// As [`reading`].
pub(in crate::capi) unsafe fn take_back<V: Handle>(pointer: *mut V, name: &str) -> Result<(), Failure> {
    if pointer.is_null() {
        return Ok(());
    }
    // SAFETY: by this function's contract.
    let last = unsafe { changing(pointer, name) }?;
    let handle = last.handle;
    // It stays marked as changing, so that calls that come meanwhile are refused.
    std::mem::forget(last);
    // SAFETY: `give` made it of a box, and nobody else has taken it back, as its mark still stands.
    unsafe {
        (*handle.as_ptr()).mark.store(0, Ordering::SeqCst);
        drop(Box::from_raw(handle.as_ptr()));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capi::{rayc_contacts_count, rayc_contacts_create, rayc_contacts_destroy};
    use rayc_status::*;
    use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
    use std::ptr::null_mut;

    #[test]
    fn many_read_a_handle_or_one_changes_it() {
        let (mut handle, mut count) = (null_mut(), 0);
        // SAFETY: the handle is valid to the end.
        unsafe {
            assert_eq!(rayc_contacts_create(&mut handle), RAYC_STATUS_OK);
            let status = |outcome: Option<Failure>| outcome.map(|failure| failure.status);
            let to_read = || status(reading(handle, "contacts").err());
            let to_glance = || status(glancing(handle, "contacts").err());
            let to_change = || status(changing(handle, "contacts").err());
            let busy = Some(RAYC_STATUS_BUSY);

            let first = reading(handle, "contacts");
            let second = reading(handle, "contacts");
            assert_eq!([to_read(), to_glance(), to_change()], [None, None, busy]);
            drop(first);
            assert_eq!(to_change(), busy, "one is left");
            assert_eq!(rayc_contacts_destroy(handle), RAYC_STATUS_BUSY);
            drop(second);
            assert_eq!(to_change(), None);

            let only = changing(handle, "contacts");
            assert_eq!([to_read(), to_glance(), to_change()], [busy; 3]);
            assert_eq!(rayc_contacts_count(handle, &mut count), RAYC_STATUS_BUSY);
            assert_eq!(rayc_contacts_destroy(handle), RAYC_STATUS_BUSY);
            drop(only);
            assert_eq!([to_read(), to_glance(), to_change()], [None; 3]);

            let panicking = catch_unwind(AssertUnwindSafe(|| {
                let _only = changing(handle, "contacts");
                resume_unwind(Box::new(()));
            }));
            assert!(panicking.is_err());
            assert_eq!([to_read(), to_glance(), to_change()], [None; 3], "a panic leaves nothing in use");
            assert_eq!(rayc_contacts_destroy(handle), RAYC_STATUS_OK);
        }
    }
}
