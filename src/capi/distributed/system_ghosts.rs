use crate::capi::base::rayc_status;
use crate::capi::contact_system::rayc_contact_system;
use crate::capi::ffi::{Output, changing, guard, reading, slice, slice_mut, with_precision};
use crate::capi::scene::rayc_scene;
use crate::distributed::{detect_among, largest_coupling, look_again, look_ahead};

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
    guard(|| {
        let (mut system, mut scene) = (changing(system, "system")?, changing(scene, "scene")?);
        let positions = slice(positions, count, "positions")?;
        let velocities = slice(velocities, count, "velocities")?;
        let free = slice(free_velocities, count, "free_velocities")?;
        with_precision!(&mut system.system, &mut scene.scene, |system, scene| {
            Ok(look_ahead(system, scene, dt, positions, velocities, Some(free))?)
        })
    })
}

/// Puts the scene's bodies, but ghosts, where they end with these velocities, and does no more. These places show which
/// ghosts rayc_contact_system_detect_among() needs.
///
/// Systems that share bodies all ask rayc_contact_system_off_course() first. If one has to look, all call this function, add
/// the ghosts that their scenes need there, and call rayc_contact_system_detect_among(). Ghosts may be added within a
/// step, with rayc_contact_system_set_node_masses() for further nodes; then they may be told their motion and what
/// their pairs remember. They are unknowns from then on, and vectors are longer.
///
/// Errors: those of rayc_contact_system_detect_again().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_look_again(
    system: *mut rayc_contact_system,
    scene: *mut rayc_scene,
    count: usize,
    velocities: *const f64,
) -> rayc_status {
    guard(|| {
        let (mut system, mut scene) = (changing(system, "system")?, changing(scene, "scene")?);
        let end = slice(velocities, count, "velocities")?;
        with_precision!(&mut system.system, &mut scene.scene, |system, scene| Ok(look_again(system, scene, end)?))
    })
}

/// As rayc_contact_system_detect_again(), but it looks in any case, and holds the rows as before. If *is_more is 1 in
/// any of the systems that share bodies, all call rayc_contact_system_linearise() with these velocities.
///
/// node_count: three times the number of nodes; positions, start_velocities: as given to rayc_contact_system_begin(),
/// with those of ghosts that have joined the step. count: that of the unknowns. Errors: those of
/// rayc_contact_system_detect_again().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_detect_among(
    system: *mut rayc_contact_system,
    scene: *mut rayc_scene,
    node_count: usize,
    positions: *const f64,
    start_velocities: *const f64,
    count: usize,
    velocities: *const f64,
    is_more: *mut u32,
) -> rayc_status {
    guard(|| {
        let (mut system, mut scene) = (changing(system, "system")?, changing(scene, "scene")?);
        let positions = slice(positions, node_count, "positions")?;
        let start = slice(start_velocities, node_count, "start_velocities")?;
        let velocities = slice(velocities, count, "velocities")?;
        let place = Output::new(is_more, "is_more")?;
        place.write(with_precision!(&mut system.system, &mut scene.scene, |system, scene| {
            u32::from(detect_among(system, scene, positions, start, velocities)?)
        }))
    })
}

/// Puts the scene's bodies, but ghosts, where rayc_contact_system_begin_explicit() with the same numbers would look for
/// contacts, and does no more: which ghosts the scene needs there.
///
/// Errors: those of rayc_contact_system_begin().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_look_explicit(
    system: *mut rayc_contact_system,
    scene: *mut rayc_scene,
    dt: f64,
    count: usize,
    positions: *const f64,
    velocities: *const f64,
) -> rayc_status {
    guard(|| {
        let (mut system, mut scene) = (changing(system, "system")?, changing(scene, "scene")?);
        let positions = slice(positions, count, "positions")?;
        let velocities = slice(velocities, count, "velocities")?;
        with_precision!(&mut system.system, &mut scene.scene, |system, scene| {
            Ok(look_ahead(system, scene, dt, positions, velocities, None)?)
        })
    })
}

/// Begins a step as rayc_contact_system_explicit_step() does, and does no more. The forces are those of
/// rayc_contact_system_part_forces() at the velocities of the start, those of rigid bodies behind;
/// rayc_contact_system_finish() with the same velocities ends the step.
///
/// Errors: those of rayc_contact_system_explicit_step().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_begin_explicit(
    system: *mut rayc_contact_system,
    scene: *mut rayc_scene,
    dt: f64,
    count: usize,
    positions: *const f64,
    velocities: *const f64,
) -> rayc_status {
    guard(|| {
        let (mut system, mut scene) = (changing(system, "system")?, changing(scene, "scene")?);
        let positions = slice(positions, count, "positions")?;
        let velocities = slice(velocities, count, "velocities")?;
        with_precision!(&mut system.system, &mut scene.scene, |system, scene| {
            Ok(system.begin_explicit(scene, dt, positions, velocities)?)
        })
    })
}

/// How strongly the rows that push act on each block of rayc_contact_system_copy_parts(): replaces `couplings`, a number for
/// each, in N/m, of a rigid body's angular velocity in N. Their sums by block are for rayc_contact_system_largest_coupling().
///
/// block_count: that of rayc_contact_system_part_count(). Errors: as there, and RAYC_STATUS_WRONG_COUNT.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_part_couplings(
    system: *mut rayc_contact_system,
    block_count: usize,
    couplings: *mut f64,
) -> rayc_status {
    guard(|| {
        let rayc_contact_system { system, parts, .. } = &mut *changing(system, "system")?;
        let couplings = slice_mut(couplings, block_count, "couplings")?;
        with_precision!(system, |system| Ok(parts.of(system)?.couplings(couplings)?))
    })
}

/// Finds from the sums of couplings, one for each block of three unknowns, what limits an explicit step. *largest: a
/// bound λ on the largest eigenvalue of M⁻¹ K, in 1/s²; *damping_time: the largest damping time τ of the rows that
/// push, in s; both are zero without contact. Where systems share bodies, take the largest λ and τ of all. Symplectic
/// Euler is stable for steps up to √(τ² + 4 / λ) − τ.
///
/// count: a third of that of the unknowns. Errors: RAYC_STATUS_OUT_OF_ORDER without a step, RAYC_STATUS_WRONG_COUNT,
/// RAYC_STATUS_NOT_FINITE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_largest_coupling(
    system: *const rayc_contact_system,
    count: usize,
    sums: *const f64,
    largest: *mut f64,
    damping_time: *mut f64,
) -> rayc_status {
    guard(|| {
        let system = reading(system, "system")?;
        let sums = slice(sums, count, "sums")?;
        let places = [Output::new(largest, "largest")?, Output::new(damping_time, "damping_time")?];
        let found = with_precision!(&system.system, |system| largest_coupling(system, sums)?);
        places.into_iter().zip(found).try_for_each(|(place, number)| place.write(number))
    })
}
