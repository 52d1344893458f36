use super::number::Number;
use super::rayc_contact_system;
use super::step::{add_forces, add_product, begin, detect_again, explicit_step, finish, number_at};
use crate::capi::base::rayc_status;
use crate::capi::ffi::{Output, changing, guard, slice, with_precision};
use crate::capi::scene::rayc_scene;

/// rayc_contact_system_begin() with floats. Numbers are read as they are, of a system of either precision; all
/// arithmetic is in double. This holds for all functions whose names end in _f32.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_begin_f32(
    system: *mut rayc_contact_system,
    scene: *mut rayc_scene,
    dt: f64,
    count: usize,
    positions: *const f32,
    velocities: *const f32,
    free_velocities: *const f32,
) -> rayc_status {
    guard(|| begin(system, scene, dt, count, [positions, velocities, free_velocities]))
}

/// rayc_contact_system_add_forces() with floats. Each sum is rounded once; it is infinite where no float is as large.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_add_forces_f32(
    system: *mut rayc_contact_system,
    count: usize,
    velocities: *const f32,
    forces: *mut f32,
) -> rayc_status {
    guard(|| add_forces(system, count, velocities, forces))
}

/// rayc_contact_system_add_product() with floats, rounded as by rayc_contact_system_add_forces_f32().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_add_product_f32(
    system: *mut rayc_contact_system,
    factor: f64,
    count: usize,
    change: *const f32,
    result: *mut f32,
) -> rayc_status {
    guard(|| add_product(system, factor, count, change, result))
}

/// rayc_contact_system_energy() with floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_energy_f32(
    system: *mut rayc_contact_system,
    count: usize,
    velocities: *const f32,
    joules: *mut f64,
) -> rayc_status {
    guard(|| number_at!(system, velocities, count, energy, joules))
}

/// rayc_contact_system_linearise() with floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_linearise_f32(
    system: *mut rayc_contact_system,
    count: usize,
    velocities: *const f32,
    wrong: *mut f64,
) -> rayc_status {
    guard(|| number_at!(system, velocities, count, linearise, wrong))
}

/// rayc_contact_system_misjudged() with floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_misjudged_f32(
    system: *mut rayc_contact_system,
    count: usize,
    velocities: *const f32,
    wrong: *mut f64,
) -> rayc_status {
    guard(|| number_at!(system, velocities, count, misjudged, wrong))
}

/// rayc_contact_system_detect_again() with floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_detect_again_f32(
    system: *mut rayc_contact_system,
    scene: *mut rayc_scene,
    count: usize,
    velocities: *const f32,
    is_more: *mut u32,
) -> rayc_status {
    guard(|| detect_again(system, scene, count, velocities, is_more))
}

/// rayc_contact_system_finish() with floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_finish_f32(
    system: *mut rayc_contact_system,
    count: usize,
    velocities: *const f32,
) -> rayc_status {
    guard(|| finish(system, count, velocities))
}

/// rayc_contact_system_explicit_step() with floats, rounded as by rayc_contact_system_add_forces_f32().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_explicit_step_f32(
    system: *mut rayc_contact_system,
    scene: *mut rayc_scene,
    dt: f64,
    count: usize,
    positions: *const f32,
    velocities: *const f32,
    unknown_count: usize,
    forces: *mut f32,
    longest_step: *mut f64,
) -> rayc_status {
    guard(|| explicit_step(system, scene, dt, (count, positions, velocities), (unknown_count, forces), longest_step))
}
