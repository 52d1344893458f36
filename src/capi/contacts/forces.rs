use super::{AnyContacts, rayc_contacts};
use crate::capi::base::{rayc_status, rayc_vectors, rayc_vectors_mut};
use crate::capi::ffi::{
    Arrays, BodyArray, BodyArraysMut, Failure, Options, Output, beyond_range, check_reserved, growing, guard,
    read_options, reading, unknown_enum, with_precision, write_defaults,
};
use crate::contact::{Contact, ContactList};
use crate::force::{PenaltyLaw, Weighting, add_differential, add_forces, energy};
use crate::math::Scalar;
use crate::memory::text;

/// What a contact's stiffness is multiplied with.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum rayc_weighting {
    /// The area the ray stands for: stiffness is in N/m³, and the net force does not depend on the triangulation.
    RAYC_WEIGHTING_AREA = 1,
    /// Nothing, as in the paper: stiffness is in N/m per ray, and a finer mesh is a stiffer one.
    RAYC_WEIGHTING_VERTEX = 2,
}

impl rayc_weighting {
    pub(in crate::capi) fn read(number: u32) -> Result<Weighting, Failure> {
        match number {
            w if w == Self::RAYC_WEIGHTING_AREA as u32 => Ok(Weighting::Area),
            w if w == Self::RAYC_WEIGHTING_VERTEX as u32 => Ok(Weighting::Vertex),
            other => Err(unknown_enum("weighting", other, "rayc_weighting")),
        }
    }
}

/// How contacts push. Fill with rayc_default_response_options(), then change what you need.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_response_options {
    /// sizeof(rayc_response_options).
    pub struct_size: usize,
    /// k ≥ 0, in N/m³ with RAYC_WEIGHTING_AREA, in N/m with RAYC_WEIGHTING_VERTEX. Default 1.
    pub stiffness: f64,
    /// Damping over stiffness, in s; ≥ 0. The damping along the ray is k · damping_time. Default 0.
    pub damping_time: f64,
    /// A rayc_weighting. Default RAYC_WEIGHTING_AREA.
    pub weighting: u32,
    /// Always 0.
    pub reserved: u32,
}

growing!(rayc_response_options);

impl Options for rayc_response_options {
    fn defaults() -> Self {
        let weighting = rayc_weighting::RAYC_WEIGHTING_AREA as u32;
        let struct_size = size_of::<Self>();
        Self { struct_size, stiffness: 1.0, damping_time: 0.0, weighting, reserved: 0 }
    }
}

impl rayc_response_options {
    pub(in crate::capi) fn law(&self) -> Result<PenaltyLaw, Failure> {
        let weighting = rayc_weighting::read(self.weighting)?;
        check_reserved("rayc_response_options", self.reserved)?;
        Ok(PenaltyLaw::new(self.stiffness, self.damping_time, weighting)?)
    }
}

/// Fills `options` with the defaults. struct_size: sizeof(rayc_response_options).
///
/// Errors: RAYC_STATUS_INVALID_STRUCT_SIZE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_default_response_options(
    struct_size: usize,
    options: *mut rayc_response_options,
) -> rayc_status {
    // SAFETY: the caller's struct has the size it says.
    guard(|| unsafe { write_defaults(struct_size, options) })
}

/// Adds the contact forces to `forces`, in N. Each contact gives stiffness · weight · cos α · depth along the ray at
/// p1 and the opposite at p2, spread by the barycentric weights (Hermann, Faure, Raffin 2008, section 4). A contact under
/// RAYC_LAW_PRESSURE that stands for many triangles presses on all their vertices, by area, and the opposite lies on
/// about as much of the other surface around p2. The two loads have no net force and no net torque.
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

/// What a contact exerts at most, where its vertices' positions and velocities sum up to these sizes.
pub(in crate::capi) fn most_force<T: Scalar>(
    list: &ContactList<T>,
    law: &PenaltyLaw,
    is_moved: bool,
) -> impl Fn(&Contact<T>, [T; 2]) -> T {
    let damping_time = T::of(law.damping_time());
    move |contact, [positions, velocities]| {
        law.coefficient(contact) * (most_depth(list, contact, positions, is_moved) + damping_time * velocities)
    }
}

/// How deep it is at most, there or as it was found.
fn most_depth<T: Scalar>(list: &ContactList<T>, contact: &Contact<T>, positions: T, is_moved: bool) -> T {
    if is_moved { contact.depth + positions + list.spreads.gap(contact).abs() } else { contact.depth }
}

/// NULL for none, where there is something to damp, is refused: the damping would be lost.
///
/// # Safety
/// As [`BodyArray::if_any`].
pub(in crate::capi) unsafe fn velocities_for<'a>(
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
    Arrays { read, written: Some(&forces) }.check(list, most_force(list, law, positions.is_some()))?;
    add_forces(list, law, positions, velocities, &mut forces);
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
    add_differential(list, law, stiffness, damping, displacements, &mut forces);
    Ok(())
}

fn all_energy<T: Scalar>(
    list: &ContactList<T>,
    law: &PenaltyLaw,
    positions: Option<&[BodyArray]>,
) -> Result<f64, Failure> {
    let most = |contact: &Contact<T>, [size]: [T; 1]| {
        let depth = most_depth(list, contact, size, positions.is_some());
        law.coefficient(contact) * depth * depth
    };
    Arrays { read: [("positions", positions)], written: None }.check(list, most)?;
    Ok(energy(list, law, positions).to_f64())
}
