use super::numbers_of;
use crate::capi::base::rayc_status;
use crate::capi::contact_system::rayc_contact_system;
use crate::capi::ffi::{Output, apart, changing, guard, with_precision};
use crate::distributed::Part;

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
    guard(|| {
        let rayc_contact_system { system, parts, .. } = &mut *changing(system, "system")?;
        let places = [Output::new(part_count, "part_count")?, Output::new(block_count, "block_count")?];
        let counts = with_precision!(system, |system| {
            let (parts, blocks) = parts.of(system)?.lists();
            [parts.len(), blocks.len()]
        });
        places.into_iter().zip(counts).try_for_each(|(place, count)| place.write(count))
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
    guard(|| {
        let rayc_contact_system { system, parts: found, .. } = &mut *changing(system, "system")?;
        with_precision!(system, |system| {
            let (all_parts, all_blocks) = found.of(system)?.lists();
            let parts = Output::exactly(parts, part_count, all_parts.len(), "parts")?;
            let blocks = Output::exactly(blocks, block_count, all_blocks.len(), "blocks")?;
            parts.write_all(all_parts.iter().map(|&Part { body, other, start, count }| {
                let (other, is_half_space) = numbers_of(other);
                rayc_contact_part { body, other, is_half_space, reserved: 0, start, count }
            }))?;
            blocks.write_all(all_blocks.iter().copied())
        })
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
    guard(|| {
        let rayc_contact_system { system, parts, .. } = &mut *changing(system, "system")?;
        let length = block_count.saturating_mul(3);
        let (velocities, forces) = apart((velocities, count, "velocities"), (forces, length, "forces"))?;
        with_precision!(system, |system| Ok(parts.of(system)?.forces(velocities, forces)?))
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
    guard(|| {
        let rayc_contact_system { system, parts, .. } = &mut *changing(system, "system")?;
        let length = block_count.saturating_mul(3);
        let (change, result) = apart((change, count, "change"), (result, length, "result"))?;
        with_precision!(system, |system| Ok(parts.of(system)?.products(factor, change, result)?))
    })
}

/// As rayc_contact_system_energy(), pair by pair: replaces `joules`, a number for each part of
/// rayc_contact_system_copy_parts(). The first part of a pair has all of its energy, the second none. A pair without parts can
/// do no work, and is left out.
///
/// count: that of the unknowns; part_count: that of rayc_contact_system_part_count(). Errors: as for both.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_part_energies(
    system: *mut rayc_contact_system,
    count: usize,
    velocities: *const f64,
    part_count: usize,
    joules: *mut f64,
) -> rayc_status {
    guard(|| {
        let rayc_contact_system { system, parts, .. } = &mut *changing(system, "system")?;
        let (velocities, joules) = apart((velocities, count, "velocities"), (joules, part_count, "joules"))?;
        with_precision!(system, |system| Ok(parts.of(system)?.energies(velocities, joules)?))
    })
}

/// How many blocks rayc_contact_system_copy_part_blocks() gives, as the rows are held.
///
/// Errors: those of rayc_contact_system_part_count().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_part_block_count(
    system: *mut rayc_contact_system,
    count: *mut usize,
) -> rayc_status {
    guard(|| {
        let rayc_contact_system { system, parts, .. } = &mut *changing(system, "system")?;
        let place = Output::new(count, "count")?;
        place.write(with_precision!(system, |system| parts.of(system)?.matrix(1.0)?.len()))
    })
}

/// The matrix of rayc_contact_system_copy_blocks() part by part: block i is what the pair of part `parts[i]` (its place in
/// rayc_contact_system_copy_parts()) adds to rows of that part's body. It stands at `rows[i]`, `columns[i]`, counted in
/// blocks of three unknowns, with its nine numbers by rows at `blocks[9 i]`. They come in the order of parts, rows and
/// columns, each place of a part once. A column may be of either body of the pair.
///
/// count: that of rayc_contact_system_part_block_count(). Errors: as there; RAYC_STATUS_WRONG_COUNT, RAYC_STATUS_NOT_FINITE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_copy_part_blocks(
    system: *mut rayc_contact_system,
    factor: f64,
    count: usize,
    parts: *mut u32,
    rows: *mut u32,
    columns: *mut u32,
    blocks: *mut f64,
) -> rayc_status {
    guard(|| {
        let rayc_contact_system { system, parts: found, .. } = &mut *changing(system, "system")?;
        with_precision!(system, |system| {
            let all = found.of(system)?.matrix(factor)?;
            let parts = Output::exactly(parts, count, all.len(), "parts")?;
            let rows = Output::array(rows, count, "rows")?;
            let columns = Output::array(columns, count, "columns")?;
            let blocks = Output::array(blocks, 9 * count, "blocks")?;
            parts.write_all(all.iter().map(|block| block.part as u32))?;
            rows.write_all(all.iter().map(|block| block.row))?;
            columns.write_all(all.iter().map(|block| block.column))?;
            blocks.write_all(all.iter().flat_map(|block| block.numbers))
        })
    })
}
