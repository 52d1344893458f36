//! What stands between C's calls and the library: the guard, handles, arrays, structs that grow, and failures.

#![deny(unsafe_op_in_unsafe_fn)] // here each operation says what it rests on

mod body_arrays;
mod checks;
mod failure;
mod float_mode;
mod guard;
mod handles;
mod host_positions;
mod pointers;
mod precision;
mod sized_structs;
mod strided;

pub(super) use body_arrays::{Arrays, BodyArray, BodyArraysMut, beyond_range};
pub(super) use checks::{check_numbers, check_reserved, flag};
pub(super) use failure::{Failure, mesh_status, unknown_enum};
pub(super) use float_mode::DefaultMode;
#[cfg(test)]
pub(super) use float_mode::Mode;
pub(super) use guard::{guard, guard_each, guard_end, guard_value, last_error_message};
pub(super) use handles::{Handle, HandleKind, changing, give, glancing, reading, take_back};
pub(super) use host_positions::set_positions;
pub(super) use pointers::{Output, apart, check_apart, check_length, range_of, reference, slice, slice_mut};
pub(super) use precision::{InPrecision, precision_mismatch, with_all, with_precision};
pub(super) use sized_structs::{
    Growing, Known, Options, check_size, growing, read_options, write_defaults, write_known, write_options,
};
pub(super) use strided::{Strided, scalar_from};
