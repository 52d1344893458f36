//! Structs that begin with their own size, or are given with it, so that they can grow without breaking programs built
//! earlier.

use super::failure::Failure;
use super::pointers::{Output, reference};
use crate::capi::base::rayc_status;
use crate::memory::text;

/// A struct that later versions may add fields to, at its end; callers say how much of it they know.
pub(in crate::capi) trait Growing: Copy {
    const NAME: &'static str;
    /// Where the last field of the first version ends; programs built then pass no less.
    const SMALLEST: usize;
}

/// Says that a struct may grow; and which field, of which type, was the last in its first version, if others have been added.
macro_rules! growing {
    ($name:ident) => {
        growing!($name => size_of::<$name>());
    };
    ($name:ident, $last:ident: $type:ty) => {
        growing!($name => std::mem::offset_of!($name, $last) + size_of::<$type>());
    };
    ($name:ident => $smallest:expr) => {
        impl $crate::capi::ffi::Growing for $name {
            const NAME: &'static str = stringify!($name);
            const SMALLEST: usize = $smallest;
        }
    };
}

pub(in crate::capi) use growing;

/// An options struct that starts with its own size.
pub(in crate::capi) trait Options: Growing {
    fn defaults() -> Self;
}

pub(in crate::capi) fn check_size<O: Growing>(struct_size: usize) -> Result<(), Failure> {
    let (name, largest) = (O::NAME, size_of::<O>());
    let smallest = O::SMALLEST.next_multiple_of(align_of::<O>());
    // A size that is no multiple of the alignment would cut a field.
    if (smallest..=largest).contains(&struct_size) && struct_size.is_multiple_of(align_of::<O>()) {
        return Ok(());
    }
    Err(Failure::new(
        rayc_status::RAYC_STATUS_INVALID_STRUCT_SIZE,
        text!(
            "struct_size of {name} is {struct_size}, not {smallest} to {largest}; fill the struct with its default \
             function first, pass sizeof, and link the library your header belongs to"
        ),
    ))
}

/// The caller's options, or the defaults for NULL and for fields the caller's header did not have yet.
///
/// # Safety
/// `options` is NULL or points to `struct_size` readable bytes.
pub(in crate::capi) unsafe fn read_options<O: Options>(options: *const O) -> Result<O, Failure> {
    let mut read = O::defaults();
    if !options.is_null() {
        // SAFETY: every options struct starts with its size.
        let struct_size = *unsafe { reference(options.cast::<usize>(), O::NAME) }?;
        check_size::<O>(struct_size)?;
        // SAFETY: struct_size bytes are readable by this function's contract, and no more than `read` holds.
        unsafe { std::ptr::copy_nonoverlapping(options.cast::<u8>(), (&raw mut read).cast::<u8>(), struct_size) };
    }
    Ok(read)
}

/// Writes as much of `value` as the caller knows.
///
/// # Safety
/// `place` is writable for `struct_size` bytes.
pub(in crate::capi) unsafe fn write_known<V: Growing>(
    struct_size: usize,
    place: *mut V,
    name: &str,
    value: V,
) -> Result<(), Failure> {
    check_size::<V>(struct_size)?;
    Output::new(place, name)?;
    // SAFETY: struct_size bytes are writable by this function's contract, and no more than `value` holds.
    unsafe { std::ptr::copy_nonoverlapping((&raw const value).cast::<u8>(), place.cast::<u8>(), struct_size) };
    Ok(())
}

/// A place for an array of structs, of each of which the caller knows `struct_size` bytes.
pub(in crate::capi) struct Known<V> {
    struct_size: usize,
    place: *mut V,
}

impl<V: Growing> Known<V> {
    pub(in crate::capi) fn new(struct_size: usize, place: *mut V, count: usize, name: &str) -> Result<Self, Failure> {
        check_size::<V>(struct_size)?;
        Output::array(place, count, name)?;
        Ok(Self { struct_size, place })
    }

    /// # Safety
    /// The place is writable for as many times `struct_size` bytes as `values` yields.
    pub(in crate::capi) unsafe fn write_all(self, values: impl Iterator<Item = V>) -> Result<(), Failure> {
        for (index, value) in values.enumerate() {
            // SAFETY: by this function's contract, and `value` holds no less.
            unsafe {
                let place = self.place.byte_add(index * self.struct_size).cast::<u8>();
                std::ptr::copy_nonoverlapping((&raw const value).cast::<u8>(), place, self.struct_size);
            }
        }
        Ok(())
    }
}

/// # Safety
/// `place` is writable for `struct_size` bytes.
pub(in crate::capi) unsafe fn write_defaults<O: Options>(struct_size: usize, place: *mut O) -> Result<(), Failure> {
    // SAFETY: by this function's contract.
    unsafe { write_options(struct_size, place, "options", O::defaults()) }
}

/// # Safety
/// `place` is writable for `struct_size` bytes.
pub(in crate::capi) unsafe fn write_options<O: Options>(
    struct_size: usize,
    place: *mut O,
    name: &str,
    options: O,
) -> Result<(), Failure> {
    // SAFETY: by this function's contract. The first field is the size, which tells later calls how much of the struct
    // the caller knows.
    unsafe {
        write_known(struct_size, place, name, options)?;
        place.cast::<usize>().write(struct_size);
    }
    Ok(())
}
