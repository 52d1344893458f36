use super::checks::flag;
use super::contact_system::rayc_contact_system;
use super::contact_system_options::rayc_material;
use super::contact_system_step::number_at;
use super::contacts::rayc_contacts;
use super::failure::rayc_status;
use super::guard::guard;
use super::handles::{changing, reading};
use super::pointers::{Output, slice};
use super::precision::with_precision;
use crate::contact::ContactList;
use crate::math::Scalar;
use crate::system::Surface;

/// Gives a body and a half-space a material of their own in place of the combined one. half_space: their number, in the order
/// they were added, from 0. material: NULL takes it back.
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY, RAYC_STATUS_WRONG_COUNT where there is no such half-space, RAYC_STATUS_INVALID_MATERIAL,
/// RAYC_STATUS_OUT_OF_ORDER within a step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_set_half_space_material(
    system: *mut rayc_contact_system,
    body: u32,
    half_space: u32,
    material: *const rayc_material,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let mut system = changing(system, "system")?;
        let material = if material.is_null() { None } else { Some(rayc_material::read(material)?) };
        with_precision!(&mut system.system, |system| Ok(system.set_half_space_material(body, half_space, material)?))
    })
}

/// Copies the contacts of the last detection, with its statistics: positions are where bodies were looked for. Replaces what
/// `contacts` held.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_copy_contacts(
    system: *const rayc_contact_system,
    contacts: *mut rayc_contacts,
) -> rayc_status {
    fn copy<T: Scalar>(from: &ContactList<T>, to: &mut ContactList<T>) {
        if from.pushes().is_empty() && to.pushes().is_empty() {
            // What detection works with is left out.
            to.contacts.clone_from(&from.contacts);
            to.statistics = from.statistics;
        } else {
            to.clone_from(from);
        }
    }
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let system = reading(system, "system")?;
        let mut contacts = changing(contacts, "contacts")?;
        with_precision!(&system.system, |system| copy(system.contacts(), contacts.list.as_mut()));
        Ok(())
    })
}

/// Finds what rayc_contact_system_linearise() would write to *wrong, and leaves the rows as they are: the part of all
/// force, 0 to 1, that was predicted wrongly. So a host whose last solve was right keeps the forces that it solved
/// with.
///
/// Errors: RAYC_STATUS_OUT_OF_ORDER without a step, RAYC_STATUS_WRONG_COUNT, RAYC_STATUS_NOT_FINITE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_misjudged(
    system: *mut rayc_contact_system,
    count: usize,
    velocities: *const f64,
    wrong: *mut f64,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe { number_at!(system, velocities, count, misjudged, wrong) })
}

/// The net force with which `other` acted on a body in the last finished step: three numbers, in N; zero for a body and itself.
/// other: a body, or where is_half_space is 1 the number of a half-space.
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY, RAYC_STATUS_WRONG_COUNT where there is no such half-space, RAYC_STATUS_INVALID_OPTION
/// where is_half_space is neither 0 nor 1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_pair_force(
    system: *const rayc_contact_system,
    body: u32,
    other: u32,
    is_half_space: u32,
    force: *mut f64,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let system = reading(system, "system")?;
        let place = Output::array(force, 3, "force")?;
        let is_half_space = flag("is_half_space", is_half_space)?;
        let other = if is_half_space { Surface::HalfSpace(other) } else { Surface::Body(other) };
        let found = with_precision!(&system.system, |system| system.pair_force(body, other)?);
        place.write_all(found.into_iter());
        Ok(())
    })
}
