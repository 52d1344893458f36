use super::numbers_of;
use crate::capi::base::rayc_status;
use crate::capi::contact_system::rayc_contact_system;
use crate::capi::ffi::{Failure, Output, changing, flag, guard, reading, reference, slice, with_precision};
use crate::distributed::{pack_memory, packed_memory_length, put_memory};
use crate::system::Surface;

/// A pair whose friction remembers something from step to step, and how many bytes that takes.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_contact_memory {
    /// A body.
    pub first: u32,
    /// The other; the same for a body with itself; the number of a half-space where is_half_space is 1.
    pub second: u32,
    /// 1 or 0.
    pub is_half_space: u32,
    /// Always 0.
    pub reserved: u32,
    /// How many bytes rayc_contact_system_pack_memory() writes.
    pub length: usize,
}

/// How many pairs remember something of the last finished step: what they bore, and what their friction holds on to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_memory_count(
    system: *const rayc_contact_system,
    count: *mut usize,
) -> rayc_status {
    guard(|| {
        let system = reading(system, "system")?;
        Output::new(count, "count")?.write(with_precision!(&system.system, |system| system.remembered_pairs().len()))
    })
}

/// Which pairs these are. count: that of rayc_contact_system_memory_count().
///
/// Errors: RAYC_STATUS_WRONG_COUNT.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_copy_memories(
    system: *const rayc_contact_system,
    count: usize,
    memories: *mut rayc_contact_memory,
) -> rayc_status {
    guard(|| {
        let system = reading(system, "system")?;
        with_precision!(&system.system, |system| {
            let pairs = system.remembered_pairs();
            let place = Output::exactly(memories, count, pairs.len(), "memories")?;
            place.write_all(pairs.map(|pair| {
                let (second, is_half_space) = numbers_of(pair.1);
                let length = packed_memory_length(system, pair);
                rayc_contact_memory { first: pair.0, second, is_half_space, reserved: 0, length }
            }))
        })
    })
}

/// Writes what a pair remembers to `bytes`, for another system that finds its contacts from now on, in this process or
/// another. pair: as rayc_contact_system_copy_memories() gave it. bytes: room for pair->length bytes. The bytes carry
/// their version and a checksum, and are the same on every machine.
///
/// Errors: RAYC_STATUS_WRONG_COUNT where the pair remembers nothing, or not so much; RAYC_STATUS_UNKNOWN_ENUM.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_pack_memory(
    system: *const rayc_contact_system,
    pair: *const rayc_contact_memory,
    bytes: *mut u8,
) -> rayc_status {
    guard(|| {
        let system = reading(system, "system")?;
        let (key, length) = read_pair(pair)?;
        let mut packed = Vec::new();
        with_precision!(&system.system, |system| pack_memory(system, key, &mut packed)?);
        Output::exactly(bytes, length, packed.len(), "bytes")?.write_all(packed.into_iter())
    })
}

/// Takes over what a pair remembered elsewhere, in place of what it remembers here. pair: its length, and the numbers that
/// its bodies have here, in the order that they had when they were packed.
///
/// Errors: RAYC_STATUS_SAVED_STATE_BROKEN where the bytes are not what was packed, or not of these meshes,
/// RAYC_STATUS_UNKNOWN_BODY, RAYC_STATUS_UNKNOWN_ENUM, RAYC_STATUS_OUT_OF_ORDER within a step, unless one of the bodies is a
/// ghost that has joined it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_put_memory(
    system: *mut rayc_contact_system,
    pair: *const rayc_contact_memory,
    bytes: *const u8,
) -> rayc_status {
    guard(|| {
        let mut system = changing(system, "system")?;
        let (key, length) = read_pair(pair)?;
        let bytes = slice(bytes, length, "bytes")?;
        with_precision!(&mut system.system, |system| Ok(put_memory(system, key, bytes)?))
    })
}

/// # Safety
/// `pair` is NULL or points to one.
unsafe fn read_pair(pair: *const rayc_contact_memory) -> Result<((u32, Surface), usize), Failure> {
    let pair = reference(pair, "pair")?;
    let is_half_space = flag("is_half_space", pair.is_half_space)?;
    let second = if is_half_space { Surface::HalfSpace(pair.second) } else { Surface::Body(pair.second) };
    Ok(((pair.first, second), pair.length))
}
