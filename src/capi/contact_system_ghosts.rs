use super::contact_system::rayc_contact_system;
use super::contact_system_step::apart;
use super::failure::rayc_status;
use super::guard::guard;
use super::handles::{changing, reading};
use super::pointers::{Output, slice};
use super::precision::with_precision;
use super::scene::rayc_scene;

/// Finds how far the scene's bodies, without ghosts, end from where they were when contacts were last looked for, if
/// these are the velocities at the end of the step. *nodes and *rigid: the largest square of a difference of velocities
/// in m²/s², of nodes and of rigid bodies' centres. rayc_contact_system_detect_again() looks again where one is more
/// than (d / dt)², d the smallest depth cap of all bodies; that of nodes counts where any node has a finite mass.
///
/// Systems that share bodies all ask first. If one of them has to look, all call rayc_contact_system_look_again(), add
/// the ghosts that their scenes need there, and call rayc_contact_system_detect_among(). Ghosts may be added within a
/// step, with rayc_contact_system_set_node_masses() for further nodes; then they may be told their motion and what
/// their pairs remember. They are unknowns from then on, and vectors are longer.
///
/// Errors: RAYC_STATUS_OUT_OF_ORDER without a step, RAYC_STATUS_WRONG_COUNT, RAYC_STATUS_NOT_FINITE,
/// RAYC_STATUS_PRECISION_MISMATCH.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_off_course(
    system: *mut rayc_contact_system,
    scene: *const rayc_scene,
    count: usize,
    velocities: *const f64,
    nodes: *mut f64,
    rigid: *mut f64,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let (mut system, scene) = (changing(system, "system")?, reading(scene, "scene")?);
        let velocities = slice(velocities, count, "velocities")?;
        let places = [Output::new(nodes, "nodes")?, Output::new(rigid, "rigid")?];
        let squares = with_precision!(&mut system.system, &scene.scene, |system, scene| {
            system.off_course(scene, velocities)?
        });
        for (place, square) in places.into_iter().zip(squares) {
            place.write(square);
        }
        Ok(())
    })
}

/// Puts the scene's bodies, but ghosts, where they end with these velocities, and does no more. These places show which
/// ghosts rayc_contact_system_detect_among() needs.
///
/// Errors: those of rayc_contact_system_detect_again().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_look_again(
    system: *mut rayc_contact_system,
    scene: *mut rayc_scene,
    count: usize,
    velocities: *const f64,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let (mut system, mut scene) = (changing(system, "system")?, changing(scene, "scene")?);
        let velocities = slice(velocities, count, "velocities")?;
        with_precision!(&mut system.system, &mut scene.scene, |system, scene| Ok(system.look_again(scene, velocities)?))
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
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let (mut system, mut scene) = (changing(system, "system")?, changing(scene, "scene")?);
        let positions = slice(positions, node_count, "positions")?;
        let start = slice(start_velocities, node_count, "start_velocities")?;
        let velocities = slice(velocities, count, "velocities")?;
        let place = Output::new(is_more, "is_more")?;
        place.write(with_precision!(&mut system.system, &mut scene.scene, |system, scene| {
            u32::from(system.detect_among(scene, positions, start, velocities)?)
        }));
        Ok(())
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
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let (mut system, mut scene) = (changing(system, "system")?, changing(scene, "scene")?);
        let positions = slice(positions, count, "positions")?;
        let velocities = slice(velocities, count, "velocities")?;
        with_precision!(&mut system.system, &mut scene.scene, |system, scene| {
            Ok(system.look_explicit(scene, dt, positions, velocities)?)
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
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
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
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let mut system = changing(system, "system")?;
        let couplings = super::pointers::slice_mut(couplings, block_count, "couplings")?;
        with_precision!(&mut system.system, |system| Ok(system.part_couplings(couplings)?))
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
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let system = reading(system, "system")?;
        let sums = slice(sums, count, "sums")?;
        let places = [Output::new(largest, "largest")?, Output::new(damping_time, "damping_time")?];
        let found = with_precision!(&system.system, |system| system.largest_coupling(sums)?);
        for (place, number) in places.into_iter().zip(found) {
            place.write(number);
        }
        Ok(())
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
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let mut system = changing(system, "system")?;
        let (velocities, joules) = apart((velocities, count, "velocities"), (joules, part_count, "joules"))?;
        with_precision!(&mut system.system, |system| Ok(system.part_energies(velocities, joules)?))
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
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let mut system = changing(system, "system")?;
        let place = Output::new(count, "count")?;
        place.write(with_precision!(&mut system.system, |system| system.part_blocks(1.0)?.len()));
        Ok(())
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
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let mut system = changing(system, "system")?;
        with_precision!(&mut system.system, |system| {
            let all = system.part_blocks(factor)?;
            let parts = Output::exactly(parts, count, all.len(), "parts")?;
            let rows = Output::array(rows, count, "rows")?;
            let columns = Output::array(columns, count, "columns")?;
            let blocks = Output::array(blocks, 9 * count, "blocks")?;
            parts.write_all(all.iter().map(|block| block.part as u32));
            rows.write_all(all.iter().map(|block| block.row));
            columns.write_all(all.iter().map(|block| block.column));
            blocks.write_all(all.iter().flat_map(|block| block.numbers));
        });
        Ok(())
    })
}
