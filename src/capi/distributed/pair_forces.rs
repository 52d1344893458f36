use crate::capi::base::{rayc_status, rayc_vectors};
use crate::capi::contacts::{most_force, rayc_contacts, rayc_response_options, velocities_for};
use crate::capi::ffi::{Arrays, BodyArray, Failure, Output, changing, guard, read_options, reading, with_precision};
use crate::contact::ContactList;
use crate::distributed::{ForcesByPair, PairForces};
use crate::force::PenaltyLaw;
use crate::math::{Scalar, Vector3};

/// The forces of one pair of bodies, or of a body with itself: where they lie among those of all pairs.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_pair_forces {
    /// The body whose contacts come first.
    pub first: u32,
    /// The other; the same for a body with itself.
    pub second: u32,
    /// Where the pair's forces begin.
    pub start: usize,
    /// How many are the first body's.
    pub first_count: usize,
    /// How many after them are the second's; 0 for a body with itself.
    pub second_count: usize,
}

/// What a pair does at one vertex.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_vertex_force {
    /// The vertex, in ascending order for each body of a pair.
    pub vertex: u32,
    /// Always 0, so that equal forces are equal byte by byte.
    pub reserved: u32,
    /// The force in N.
    pub force: [f64; 3],
}

/// Sums the contact forces pair by pair, for rayc_contacts_copy_pair_forces(): first the contacts of each pair, in their
/// order, at each vertex that they act on. Added in the order of the pairs they are the forces of rayc_contacts_add_forces()
/// but for the order of summation. As a pair's sum does not depend on other pairs, it may be found in another process.
///
/// options, body_count, positions, velocities: as in rayc_contacts_add_forces(), and so are the errors. *pair_count: how
/// many pairs have contacts, bodies with themselves among them; *force_count: how many forces there are.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contacts_sum_pair_forces(
    contacts: *mut rayc_contacts,
    options: *const rayc_response_options,
    body_count: usize,
    positions: *const rayc_vectors,
    velocities: *const rayc_vectors,
    pair_count: *mut usize,
    force_count: *mut usize,
) -> rayc_status {
    guard(|| {
        let mut contacts = changing(contacts, "contacts")?;
        let rayc_contacts { list, pair_forces } = &mut *contacts;
        let law = read_options(options)?.law()?;
        let positions = BodyArray::if_any(positions, body_count, "positions")?;
        let velocities = velocities_for(&law, list, velocities, body_count)?;
        let places = [Output::new(pair_count, "pair_count")?, Output::new(force_count, "force_count")?];
        let counts = with_precision!(&*list, |list| sum(list, pair_forces.as_mut(), &law, positions, velocities)?);
        places.into_iter().zip(counts).try_for_each(|(place, count)| place.write(count))
    })
}

fn sum<T: Scalar>(
    list: &ContactList<T>,
    forces: &mut ForcesByPair<T>,
    law: &PenaltyLaw,
    positions: Option<&[BodyArray]>,
    velocities: Option<&[BodyArray]>,
) -> Result<[usize; 2], Failure> {
    let read = [("positions", positions), ("velocities", velocities)];
    Arrays { read, written: None }.check(list, most_force(list, law, positions.is_some()))?;
    forces.sum(list, law, positions, velocities);
    Ok([forces.pairs().len(), forces.forces().len()])
}

/// Copies what the last rayc_contacts_sum_pair_forces() of these contacts has summed; both counts must be those it gave.
/// The pairs come in their order; the forces of each pair are its first body's, then its second's.
///
/// Errors: RAYC_STATUS_WRONG_COUNT.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contacts_copy_pair_forces(
    contacts: *const rayc_contacts,
    pair_count: usize,
    pairs: *mut rayc_pair_forces,
    force_count: usize,
    forces: *mut rayc_vertex_force,
) -> rayc_status {
    guard(|| {
        let contacts = reading(contacts, "contacts")?;
        with_precision!(&contacts.pair_forces, |summed| {
            let pairs = Output::exactly(pairs, pair_count, summed.pairs().len(), "pairs")?;
            let forces = Output::exactly(forces, force_count, summed.forces().len(), "forces")?;
            pairs.write_all(summed.pairs().iter().map(|&PairForces { bodies: [first, second], start, counts }| {
                rayc_pair_forces { first, second, start, first_count: counts[0], second_count: counts[1] }
            }))?;
            forces.write_all(summed.forces().iter().map(at_vertex))
        })
    })
}

fn at_vertex<T: Scalar>((vertex, force): &(u32, Vector3<T>)) -> rayc_vertex_force {
    rayc_vertex_force { vertex: *vertex, reserved: 0, force: force.map(T::to_f64).into() }
}
