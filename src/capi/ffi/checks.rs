//! Checks of the host's numbers: flags, reserved fields, and doubles that are to be held in the mesh's precision.

use super::failure::Failure;
use crate::capi::base::rayc_status;
use crate::math::Scalar;
use crate::memory::text;
use std::fmt;

pub(in crate::capi) fn flag(field: &str, value: u32) -> Result<bool, Failure> {
    match value {
        0 => Ok(false),
        1 => Ok(true),
        _ => {
            let message = text!("{field} is {value}; give 0 for no or 1 for yes");
            Err(Failure::new(rayc_status::RAYC_STATUS_INVALID_OPTION, message))
        }
    }
}

/// Refuses a reserved field in use: later versions may give it a meaning.
pub(in crate::capi) fn check_reserved(name: &str, reserved: u32) -> Result<(), Failure> {
    if reserved == 0 {
        return Ok(());
    }
    let message = text!("reserved of {name} is {reserved}; leave it 0, as its default function does");
    Err(Failure::new(rayc_status::RAYC_STATUS_INVALID_OPTION, message))
}

/// Refuses numbers that the precision does not hold.
pub(in crate::capi) fn check_numbers<T: Scalar>(numbers: &[f64], what: fmt::Arguments) -> Result<(), Failure> {
    match numbers.iter().find(|&&x| !T::of(x).is_finite()) {
        None => Ok(()),
        Some(&value) => Err(refused::<T>(numbers, value, what)),
    }
}

#[cold]
fn refused<T: Scalar>(numbers: &[f64], value: f64, what: fmt::Arguments) -> Failure {
    if !numbers.iter().all(|x| x.is_finite()) {
        let message = text!("{what} has a number that is NaN or infinite; give finite ones");
        return Failure::new(rayc_status::RAYC_STATUS_NOT_FINITE, message);
    }
    let largest = T::LARGEST.to_f64();
    let message = text!(
        "{what} has {value:e}, beyond {largest:e}, the largest number of the mesh's precision; give smaller ones, or \
         make the mesh of doubles"
    );
    Failure::new(rayc_status::RAYC_STATUS_MESH_BEYOND_RANGE, message)
}
