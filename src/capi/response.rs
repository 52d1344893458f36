use super::body_arrays::{Arrays, BodyArray, BodyArraysMut, beyond_range, size_of_vector};
use super::contacts::{AnyContacts, rayc_contacts};
use super::failure::{Failure, rayc_status};
use super::guard::guard;
use super::handles::reading;
use super::options::rayc_response_options;
use super::pointers::Output;
use super::precision::with_precision;
use super::sized_structs::read_options;
use super::vectors::{rayc_vectors, rayc_vectors_mut};
use crate::contact::{Contact, ContactList};
use crate::force::{PenaltyLaw, add_differential, add_forces, energy};
use crate::math::Scalar;
use crate::memory::text;

/// Copies the spring coefficients of contacts first … first + count − 1 to `coefficients`: stiffness · weight · cos α,
/// in N/m. For hosts that carry contacts over to nodes of their own: the force on p1 is
/// coefficient · (depth + damping_time · (v2 − v1) · direction) · direction, that on p2 its opposite.
///
/// options: NULL for the defaults. Errors: RAYC_STATUS_WRONG_COUNT where the range reaches beyond the end,
/// RAYC_STATUS_INVALID_OPTION where a coefficient is beyond the largest number of the contacts' precision.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contacts_copy_coefficients(
    contacts: *const rayc_contacts,
    options: *const rayc_response_options,
    first: usize,
    count: usize,
    coefficients: *mut f64,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let contacts = reading(contacts, "contacts")?;
        let list = &contacts.list;
        let law = read_options(options)?.law()?;
        let range = list.range(first, count)?;
        let out = Output::array(coefficients, count, "coefficients")?;
        with_precision!(list, |list| {
            let contacts = &list.contacts[range];
            if let Some(contact) = contacts.iter().find(|contact| !law.coefficient(contact).is_finite()) {
                return Err(beyond_range(contact));
            }
            out.write_all(contacts.iter().map(|contact| law.coefficient(contact).to_f64()));
            Ok(())
        })
    })
}

/// Adds the contact forces to `forces`, in N. Each contact gives stiffness · weight · cos α · depth along the ray at
/// p1 and the opposite at p2, spread by the barycentric weights (Hermann, Faure, Raffin 2008, section 4).
///
/// options: NULL for the defaults. positions, velocities, forces: body_count arrays each, one for each body, in the
/// order of the bodies' numbers; a body without contacts may have an array of count 0. positions NULL: the positions at
/// detection. velocities NULL: no damping; damping_time must then be 0. Contacts stay as they were found: each keeps its two
/// points of the surfaces and its direction, whatever the positions. Where the points have moved apart, the force pulls,
/// because an implicit integrator's linear step needs that.
///
/// Errors: RAYC_STATUS_WRONG_COUNT where a contact's body or vertex lies beyond the arrays, RAYC_STATUS_NOT_FINITE
/// where a number that a contact needs is NaN or infinite, RAYC_STATUS_MESH_BEYOND_RANGE where it is infinite only in
/// the precision of the contacts, RAYC_STATUS_INVALID_OPTION where damping_time has no velocities, where a sum might go
/// beyond its largest number, or where `forces` shares memory with what is read. Numbers that no contact needs are not
/// checked.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contacts_add_forces(
    contacts: *const rayc_contacts,
    options: *const rayc_response_options,
    body_count: usize,
    positions: *const rayc_vectors,
    velocities: *const rayc_vectors,
    forces: *const rayc_vectors_mut,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let contacts = reading(contacts, "contacts")?;
        let list = &contacts.list;
        let law = read_options(options)?.law()?;
        let positions = BodyArray::if_any(positions, body_count, "positions")?;
        let velocities = velocities_for(&law, list, velocities, body_count)?;
        let forces = BodyArraysMut::all(forces, body_count, "forces")?;
        with_precision!(list, |list| add_all_forces(list, &law, positions, velocities, forces))
    })
}

/// Adds stiffness_factor · (∂force/∂position) d + damping_factor · (∂force/∂velocity) d to `forces`, in N, for the
/// displacements d (m, or m/s); both Jacobians are symmetric and negative semi-definite. What an implicit integrator asks once
/// per iteration.
///
/// options: NULL for the defaults. displacements, forces: body_count arrays each, as in rayc_contacts_add_forces().
///
/// Errors: as there, and RAYC_STATUS_INVALID_OPTION where a factor is not finite.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contacts_add_differential(
    contacts: *const rayc_contacts,
    options: *const rayc_response_options,
    stiffness_factor: f64,
    damping_factor: f64,
    body_count: usize,
    displacements: *const rayc_vectors,
    forces: *const rayc_vectors_mut,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let contacts = reading(contacts, "contacts")?;
        let list = &contacts.list;
        let law = read_options(options)?.law()?;
        if !(stiffness_factor.is_finite() && damping_factor.is_finite()) {
            return Err(Failure::new(
                rayc_status::RAYC_STATUS_INVALID_OPTION,
                text!("the factors are {stiffness_factor} and {damping_factor}; give finite numbers"),
            ));
        }
        let displacements = BodyArray::all(displacements, body_count, "displacements")?;
        let forces = BodyArraysMut::all(forces, body_count, "forces")?;
        let factors = [stiffness_factor, damping_factor];
        with_precision!(list, |list| add_all_differentials(list, &law, factors, displacements, forces))
    })
}

/// The energy stored in the contacts, ½ Σ coefficient · depth², in J. positions: as in rayc_contacts_add_forces(). The
/// elastic force is its negative gradient.
///
/// Errors: RAYC_STATUS_WRONG_COUNT where a contact's body or vertex lies beyond the arrays, RAYC_STATUS_NOT_FINITE
/// where a number that a contact needs is NaN or infinite, RAYC_STATUS_MESH_BEYOND_RANGE where it is infinite only in
/// the precision of the contacts, RAYC_STATUS_INVALID_OPTION where a sum might go beyond its largest number. Numbers that no
/// contact needs are not checked.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contacts_energy(
    contacts: *const rayc_contacts,
    options: *const rayc_response_options,
    body_count: usize,
    positions: *const rayc_vectors,
    joules: *mut f64,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let contacts = reading(contacts, "contacts")?;
        let list = &contacts.list;
        let law = read_options(options)?.law()?;
        let positions = BodyArray::if_any(positions, body_count, "positions")?;
        let place = Output::new(joules, "joules")?;
        place.write(with_precision!(list, |list| all_energy(list, &law, positions)?));
        Ok(())
    })
}

/// What a contact exerts at most, where its vertices' positions and velocities sum up to these sizes.
pub(super) fn most_force<T: Scalar>(law: &PenaltyLaw, is_moved: bool) -> impl Fn(&Contact<T>, [T; 2]) -> T {
    let damping_time = T::of(law.damping_time());
    move |contact, [positions, velocities]| {
        law.coefficient(contact) * (most_depth(contact, positions, is_moved) + damping_time * velocities)
    }
}

/// How deep it is at most, there or as it was found.
fn most_depth<T: Scalar>(contact: &Contact<T>, positions: T, is_moved: bool) -> T {
    let Contact { p1, p2, depth, .. } = contact;
    if is_moved { *depth + positions + size_of_vector(&(p2.position - p1.position)) } else { *depth }
}

/// NULL for none, where there is something to damp, is refused: the damping would be lost.
///
/// # Safety
/// As [`BodyArray::if_any`].
pub(super) unsafe fn velocities_for<'a>(
    law: &PenaltyLaw,
    list: &AnyContacts,
    velocities: *const rayc_vectors,
    body_count: usize,
) -> Result<Option<&'a [BodyArray]>, Failure> {
    let time = law.damping_time();
    if velocities.is_null() && time > 0.0 && body_count.max(list.len()) > 0 {
        return Err(Failure::new(
            rayc_status::RAYC_STATUS_INVALID_OPTION,
            text!(
                "damping_time is {time}, but there are no velocities to damp; give velocities, or a damping_time of 0"
            ),
        ));
    }
    // SAFETY: by this function's contract.
    unsafe { BodyArray::if_any(velocities, body_count, "velocities") }
}

fn add_all_forces<T: Scalar>(
    list: &ContactList<T>,
    law: &PenaltyLaw,
    positions: Option<&[BodyArray]>,
    velocities: Option<&[BodyArray]>,
    mut forces: BodyArraysMut<'_>,
) -> Result<(), Failure> {
    let read = [("positions", positions), ("velocities", velocities)];
    Arrays { read, written: Some(&forces) }.check(list, most_force(law, positions.is_some()))?;
    add_forces(&list.contacts, law, positions, velocities, &mut forces);
    Ok(())
}

fn add_all_differentials<T: Scalar>(
    list: &ContactList<T>,
    law: &PenaltyLaw,
    [stiffness, damping]: [f64; 2],
    displacements: &[BodyArray],
    mut forces: BodyArraysMut<'_>,
) -> Result<(), Failure> {
    let factor = T::of(stiffness + damping * law.damping_time());
    let most = |contact: &Contact<T>, [size]: [T; 1]| factor * law.coefficient(contact) * size;
    Arrays { read: [("displacements", Some(displacements))], written: Some(&forces) }.check(list, most)?;
    add_differential(&list.contacts, law, stiffness, damping, displacements, &mut forces);
    Ok(())
}

fn all_energy<T: Scalar>(
    list: &ContactList<T>,
    law: &PenaltyLaw,
    positions: Option<&[BodyArray]>,
) -> Result<f64, Failure> {
    let most = |contact: &Contact<T>, [size]: [T; 1]| {
        let depth = most_depth(contact, size, positions.is_some());
        law.coefficient(contact) * depth * depth
    };
    Arrays { read: [("positions", positions)], written: None }.check(list, most)?;
    Ok(energy(&list.contacts, law, positions).to_f64())
}
