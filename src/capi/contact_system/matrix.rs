use super::{AnySystem, rayc_contact_system};
use crate::capi::base::rayc_status;
use crate::capi::ffi::{Failure, Output, changing, check_length, guard, reading, slice_mut, with_precision};
use crate::system::CompressedRows;

/// How many blocks rayc_contact_system_copy_blocks() gives, as the rows are held.
///
/// Errors: RAYC_STATUS_OUT_OF_ORDER without a step, RAYC_STATUS_RIGID_ELIMINATED.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_block_count(
    system: *const rayc_contact_system,
    count: *mut usize,
) -> rayc_status {
    guard(|| {
        let system = reading(system, "system")?;
        let place = Output::new(count, "count")?;
        place.write(block_count(&system.system)?)
    })
}

/// Copies the matrix of rayc_contact_system_add_product() as 3 × 3 blocks, for direct solvers and preconditioners: block i
/// stands at `rows[i]`, `columns[i]`, counted in blocks of three unknowns, and its nine numbers, by rows, at `blocks[9 i]`.
/// Those of equal place are to be added. count: that of rayc_contact_system_block_count(); rows and columns have room for as
/// many numbers, blocks for nine times as many. A pair that escapes has a block for each two of its nodes.
///
/// Errors: RAYC_STATUS_OUT_OF_ORDER without a step, RAYC_STATUS_RIGID_ELIMINATED where rigid bodies are not kept,
/// RAYC_STATUS_WRONG_COUNT, RAYC_STATUS_NOT_FINITE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_copy_blocks(
    system: *const rayc_contact_system,
    factor: f64,
    count: usize,
    rows: *mut u32,
    columns: *mut u32,
    blocks: *mut f64,
) -> rayc_status {
    guard(|| {
        let system = reading(system, "system")?;
        check_length("blocks", count, block_count(&system.system)?)?;
        let rows = slice_mut(rows, count, "rows")?;
        let columns = slice_mut(columns, count, "columns")?;
        let blocks = slice_mut(blocks, 9 * count, "blocks")?;
        let mut next = 0;
        let copy = |row: usize, column: usize, block: [f64; 9]| {
            (rows[next], columns[next]) = (row as u32, column as u32);
            blocks[9 * next..9 * next + 9].copy_from_slice(&block);
            next += 1;
        };
        with_precision!(&system.system, |system| Ok(system.for_each_block(factor, copy)?))
    })
}

/// A square matrix in compressed sparse rows (CSR), one for each unknown: row i has the numbers `offsets[i]` to
/// `offsets[i + 1]`, exclusive, of `columns` and `values`. Columns ascend within each row, and none comes twice.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_csr {
    /// How many rows and columns it has.
    pub row_count: usize,
    /// How many numbers it has, also the last of the offsets.
    pub value_count: usize,
    /// One more than there are rows.
    pub offsets: *const i32,
    /// The column of each number, from 0.
    pub columns: *const i32,
    /// The numbers: the factor times N s/m and, with angular velocities, N s and N s m.
    pub values: *const f64,
}

/// Assembles the matrix of rayc_contact_system_add_product() in compressed sparse rows, for direct solvers and
/// preconditioners. The arrays are the system's: they stay as they are until this is called again, whatever it then returns,
/// or the system is destroyed. In a steady step no memory is allocated.
///
/// Errors: RAYC_STATUS_OUT_OF_ORDER without a step, RAYC_STATUS_RIGID_ELIMINATED where rigid bodies are not kept,
/// RAYC_STATUS_NOT_FINITE, RAYC_STATUS_MATRIX_TOO_LARGE, which rayc_contact_system_copy_blocks() does not return.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_csr(
    system: *mut rayc_contact_system,
    factor: f64,
    matrix: *mut rayc_csr,
) -> rayc_status {
    guard(|| {
        let mut system = changing(system, "system")?;
        let place = Output::new(matrix, "matrix")?;
        let CompressedRows { offsets, columns, values } =
            with_precision!(&mut system.system, |system| system.compressed_rows(factor)?);
        place.write(rayc_csr {
            row_count: offsets.len() - 1,
            value_count: values.len(),
            offsets: offsets.as_ptr(),
            columns: columns.as_ptr(),
            values: values.as_ptr(),
        })
    })
}

fn block_count(system: &AnySystem) -> Result<usize, Failure> {
    let mut count = 0;
    with_precision!(system, |system| system.for_each_block(1.0, |_, _, _| count += 1)?);
    Ok(count)
}
