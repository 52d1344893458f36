use super::checks::flag;
use super::contact_system::rayc_contact_system;
use super::contact_system_step::apart;
use super::failure::{Failure, rayc_status};
use super::guard::guard;
use super::handles::{changing, reading};
use super::pointers::{Output, slice};
use super::precision::with_precision;
use super::scene::rayc_scene;
use crate::system::{Part, Surface};

/// One pair's rows as they act on one of its bodies: which of the blocks of rayc_contact_system_copy_parts() are
/// theirs.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_contact_part {
    /// The body that it acts on.
    pub body: u32,
    /// The body that it touches, itself too; the number of a half-space where is_half_space is 1.
    pub other: u32,
    /// 1 or 0.
    pub is_half_space: u32,
    /// Always 0.
    pub reserved: u32,
    /// The first of its blocks.
    pub start: usize,
    /// How many blocks it has.
    pub count: usize,
}

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
    /// What rayc_contact_system_pack_memory() writes.
    pub length: usize,
}

/// Puts the scene's own bodies where rayc_contact_system_begin() with the same numbers would look for contacts, and
/// does no more. Their boxes there (rayc_scene_body_state()) show which ghosts the scene needs.
/// rayc_contact_system_begin() puts the ghosts in place, once the system knows them and their nodes.
///
/// Errors: those of rayc_contact_system_begin().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_look_ahead(
    system: *mut rayc_contact_system,
    scene: *mut rayc_scene,
    dt: f64,
    count: usize,
    positions: *const f64,
    velocities: *const f64,
    free_velocities: *const f64,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let (mut system, mut scene) = (changing(system, "system")?, changing(scene, "scene")?);
        let positions = slice(positions, count, "positions")?;
        let velocities = slice(velocities, count, "velocities")?;
        let free = slice(free_velocities, count, "free_velocities")?;
        with_precision!(&mut system.system, &mut scene.scene, |system, scene| {
            Ok(system.look_ahead(scene, dt, positions, velocities, free)?)
        })
    })
}

/// How many parts the rows of the step under way have, and how many blocks of three unknowns these act on together.
/// There is one part for each pair and each body of it that has unknowns. They stay until the step ends or
/// rayc_contact_system_detect_again() finds more.
///
/// What a pair does to its bodies does not depend on other pairs, so another process may compute it. Forces that are
/// added part by part in one order have the same bits, whichever process found the pairs. They are those of
/// rayc_contact_system_add_forces(), except for the order of summation.
///
/// Errors: RAYC_STATUS_OUT_OF_ORDER without a step, RAYC_STATUS_RIGID_ELIMINATED where rigid bodies are not kept.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_part_count(
    system: *mut rayc_contact_system,
    part_count: *mut usize,
    block_count: *mut usize,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let mut system = changing(system, "system")?;
        let places = [Output::new(part_count, "part_count")?, Output::new(block_count, "block_count")?];
        let counts = with_precision!(&mut system.system, |system| {
            let (parts, blocks) = system.parts()?;
            [parts.len(), blocks.len()]
        });
        for (place, count) in places.into_iter().zip(counts) {
            place.write(count);
        }
        Ok(())
    })
}

/// Copies the parts, and their blocks, numbered as rayc_contact_system_copy_blocks() does: the unknowns of block b are
/// 3 b to 3 b + 2. Those of a part ascend; a rigid body has two, linear and angular. Both counts are those of
/// rayc_contact_system_part_count().
///
/// Errors: those, and RAYC_STATUS_WRONG_COUNT.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_copy_parts(
    system: *mut rayc_contact_system,
    part_count: usize,
    parts: *mut rayc_contact_part,
    block_count: usize,
    blocks: *mut u32,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let mut system = changing(system, "system")?;
        with_precision!(&mut system.system, |system| {
            let (all_parts, all_blocks) = system.parts()?;
            let parts = Output::exactly(parts, part_count, all_parts.len(), "parts")?;
            let blocks = Output::exactly(blocks, block_count, all_blocks.len(), "blocks")?;
            parts.write_all(all_parts.iter().map(|&Part { body, other, start, count }| {
                let (other, is_half_space) = numbers_of(other);
                rayc_contact_part { body, other, is_half_space, reserved: 0, start, count }
            }));
            blocks.write_all(all_blocks.iter().copied());
        });
        Ok(())
    })
}

/// As rayc_contact_system_add_forces(), part by part: replaces `forces`, three numbers for each block of
/// rayc_contact_system_copy_parts(), in that order. Of `velocities` only the unknowns of those blocks count.
///
/// count: that of the unknowns; block_count: that of rayc_contact_system_part_count(). Errors: as for both.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_part_forces(
    system: *mut rayc_contact_system,
    count: usize,
    velocities: *const f64,
    block_count: usize,
    forces: *mut f64,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let mut system = changing(system, "system")?;
        let length = block_count.saturating_mul(3);
        let (velocities, forces) = apart((velocities, count, "velocities"), (forces, length, "forces"))?;
        with_precision!(&mut system.system, |system| Ok(system.part_forces(velocities, forces)?))
    })
}

/// As rayc_contact_system_add_product(), part by part: replaces `result`, three numbers for each block of
/// rayc_contact_system_copy_parts(), in that order. Of `change` only the unknowns of those blocks count.
///
/// count: that of the unknowns; block_count: that of rayc_contact_system_part_count(). Errors: as for both.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_part_products(
    system: *mut rayc_contact_system,
    factor: f64,
    count: usize,
    change: *const f64,
    block_count: usize,
    result: *mut f64,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let mut system = changing(system, "system")?;
        let length = block_count.saturating_mul(3);
        let (change, result) = apart((change, count, "change"), (result, length, "result"))?;
        with_precision!(&mut system.system, |system| Ok(system.part_products(factor, change, result)?))
    })
}

/// How many pairs remember something of the last finished step: what they bore, and what their friction holds on to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_memory_count(
    system: *const rayc_contact_system,
    count: *mut usize,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let system = reading(system, "system")?;
        Output::new(count, "count")?.write(with_precision!(&system.system, |system| system.remembered_pairs().len()));
        Ok(())
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
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let system = reading(system, "system")?;
        with_precision!(&system.system, |system| {
            let pairs = system.remembered_pairs();
            let place = Output::exactly(memories, count, pairs.len(), "memories")?;
            place.write_all(pairs.map(|pair| {
                let (second, is_half_space) = numbers_of(pair.1);
                let length = system.packed_memory_length(pair);
                rayc_contact_memory { first: pair.0, second, is_half_space, reserved: 0, length }
            }));
        });
        Ok(())
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
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let system = reading(system, "system")?;
        let (key, length) = read_pair(pair)?;
        let mut packed = Vec::new();
        with_precision!(&system.system, |system| system.pack_pair_memory(key, &mut packed)?);
        Output::exactly(bytes, length, packed.len(), "bytes")?.write_all(packed.into_iter());
        Ok(())
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
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let mut system = changing(system, "system")?;
        let (key, length) = read_pair(pair)?;
        let bytes = slice(bytes, length, "bytes")?;
        with_precision!(&mut system.system, |system| Ok(system.put_pair_memory(key, bytes)?))
    })
}

fn numbers_of(surface: Surface) -> (u32, u32) {
    match surface {
        Surface::Body(number) => (number, 0),
        Surface::HalfSpace(number) => (number, 1),
    }
}

/// # Safety
/// `pair` is NULL or points to one.
unsafe fn read_pair(pair: *const rayc_contact_memory) -> Result<((u32, Surface), usize), Failure> {
    // SAFETY: by this function's contract.
    let pair = unsafe { super::pointers::reference(pair, "pair")? };
    let is_half_space = flag("is_half_space", pair.is_half_space)?;
    let second = if is_half_space { Surface::HalfSpace(pair.second) } else { Surface::Body(pair.second) };
    Ok(((pair.first, second), pair.length))
}
