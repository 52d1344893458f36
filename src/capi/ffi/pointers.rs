use super::failure::Failure;
use crate::capi::base::rayc_status;
use crate::memory::text;
use std::ops::Range;

pub(in crate::capi) fn null(name: &str) -> Failure {
    Failure::new(rayc_status::RAYC_STATUS_NULL_POINTER, text!("{name} is NULL; pass a valid pointer"))
}

/// # Safety
/// `pointer` is NULL or points to a `V` that nobody changes during `'a`.
pub(in crate::capi) unsafe fn reference<'a, V>(pointer: *const V, name: &str) -> Result<&'a V, Failure> {
    // SAFETY: by this function's contract.
    unsafe { pointer.as_ref() }.ok_or_else(|| null(name))
}

/// # Safety
/// `pointer` is NULL, or `count` is 0, or it points to `count` values that nobody changes during `'a`.
pub(in crate::capi) unsafe fn slice<'a, V>(pointer: *const V, count: usize, name: &str) -> Result<&'a [V], Failure> {
    match (count, pointer.is_null()) {
        (0, _) => Ok(&[]),
        (_, true) => Err(null(name)),
        // SAFETY: by this function's contract.
        _ => Ok(unsafe { std::slice::from_raw_parts(pointer, count) }),
    }
}

/// # Safety
/// `pointer` is NULL, or `count` is 0, or it points to `count` values that nobody else uses during `'a`.
pub(in crate::capi) unsafe fn slice_mut<'a, V>(
    pointer: *mut V,
    count: usize,
    name: &str,
) -> Result<&'a mut [V], Failure> {
    match (count, pointer.is_null()) {
        (0, _) => Ok(&mut []),
        (_, true) => Err(null(name)),
        // SAFETY: by this function's contract.
        _ => Ok(unsafe { std::slice::from_raw_parts_mut(pointer, count) }),
    }
}

/// An array to be read and one to be written, refused where they overlap.
///
/// # Safety
/// Those of [`slice()`] and [`slice_mut`].
pub(in crate::capi) unsafe fn apart<'a, N>(
    (read, count, read_name): (*const N, usize, &str),
    (written, length, written_name): (*mut N, usize, &str),
) -> Result<(&'a [N], &'a mut [N]), Failure> {
    check_apart(read, count, written, length)?;
    // SAFETY: by this function's contract.
    unsafe { Ok((slice(read, count, read_name)?, slice_mut(written, length, written_name)?)) }
}

/// Refuses to write to what is read.
pub(in crate::capi) fn check_apart<N>(
    read: *const N,
    count: usize,
    written: *mut N,
    length: usize,
) -> Result<(), Failure> {
    let bytes = |count: usize| count.saturating_mul(size_of::<N>());
    let (a, b) = (read.addr(), written.addr());
    if a < b.saturating_add(bytes(length)) && b < a.saturating_add(bytes(count)) {
        let message = text!("the array to be written overlaps one that is read; give arrays of their own");
        return Err(Failure::new(rayc_status::RAYC_STATUS_INVALID_OPTION, message));
    }
    Ok(())
}

/// Refuses an array that has not the length of what is to be written to it.
pub(in crate::capi) fn check_length(name: &str, given: usize, needed: usize) -> Result<(), Failure> {
    if given == needed {
        return Ok(());
    }
    let message = text!("{name} has room for {given}, but takes {needed}; ask for their number, and give that many");
    Err(Failure::new(rayc_status::RAYC_STATUS_WRONG_COUNT, message))
}

/// The range of `count` elements from `first` on, where as many are present.
pub(in crate::capi) fn range_of(
    what: &str,
    first: usize,
    count: usize,
    present: usize,
) -> Result<Range<usize>, Failure> {
    match first.checked_add(count) {
        Some(end) if end <= present => Ok(first..end),
        _ => {
            let message =
                text!("{what} {first} to {first} + {count} were asked for, but there are {present}; ask for fewer");
            Err(Failure::new(rayc_status::RAYC_STATUS_WRONG_COUNT, message))
        }
    }
}

/// A place for an output: known not to be NULL before any work is done, written on success only.
pub(in crate::capi) struct Output<V>(*mut V);

impl<V> Output<V> {
    pub(in crate::capi) fn new(pointer: *mut V, name: &str) -> Result<Self, Failure> {
        if pointer.is_null() { Err(null(name)) } else { Ok(Self(pointer)) }
    }

    /// Like [`new`](Self::new), for an array: NULL is fine where it has no elements.
    pub(in crate::capi) fn array(pointer: *mut V, count: usize, name: &str) -> Result<Self, Failure> {
        if count == 0 { Ok(Self(pointer)) } else { Self::new(pointer, name) }
    }

    /// Like [`array`](Self::array), where the array must have `needed` elements.
    pub(in crate::capi) fn exactly(pointer: *mut V, count: usize, needed: usize, name: &str) -> Result<Self, Failure> {
        check_length(name, count, needed)?;
        Self::array(pointer, count, name)
    }

    /// Gives `Ok`, as a call does that ends with this.
    ///
    /// # Safety
    /// The pointer is writable for one `V`.
    pub(in crate::capi) unsafe fn write(self, value: V) -> Result<(), Failure> {
        // SAFETY: by this function's contract.
        unsafe { self.0.write(value) };
        Ok(())
    }

    /// # Safety
    /// The pointer is writable for as many values as `values` yields.
    pub(in crate::capi) unsafe fn write_all(self, values: impl Iterator<Item = V>) -> Result<(), Failure> {
        // SAFETY: by this function's contract.
        unsafe { self.write_from(0, values) };
        Ok(())
    }

    /// The same from a place on.
    ///
    /// # Safety
    /// The pointer is writable for `first` values and as many more as `values` yields.
    pub(in crate::capi) unsafe fn write_from(&self, first: usize, values: impl Iterator<Item = V>) {
        for (index, value) in values.enumerate() {
            // SAFETY: by this function's contract.
            unsafe { self.0.add(first + index).write(value) }
        }
    }
}
