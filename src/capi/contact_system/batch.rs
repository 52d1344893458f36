use super::rayc_contact_system;
use super::step::{begin, detect_again};
use crate::capi::base::rayc_status;
use crate::capi::ffi::{guard, slice};
use crate::capi::scene::{Pointers, for_each_scene, rayc_scene};
use std::sync::atomic::{AtomicU32, Ordering};

/// rayc_contact_system_begin() for many scenes at once, such as those of robot learning: system i with scene i, on the threads
/// of the first scene, a scene on one thread at a time. Each gets the same bits as by itself. No handle may come twice.
///
/// number_count: three times the number of nodes of each system, all of which have equally many, or none; the numbers of
/// system i begin at i * number_count of the three arrays.
///
/// statuses: of each scene, what the call for it would have returned. Where one is an error, the others are done nevertheless;
/// the call returns the first error, and rayc_last_error_message() names its scene.
///
/// Errors: those of rayc_contact_system_begin(). Where the first scene is no handle or an array is NULL, nothing is done
/// and no status written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_systems_begin(
    count: usize,
    systems: *const *mut rayc_contact_system,
    scenes: *const *mut rayc_scene,
    dt: f64,
    number_count: usize,
    positions: *const f64,
    velocities: *const f64,
    free_velocities: *const f64,
    statuses: *mut u32,
) -> rayc_status {
    guard(|| {
        let (systems, scenes) = (Pointers::new(systems, count, "systems")?, Pointers::new(scenes, count, "scenes")?);
        let positions = slice(positions, count * number_count, "positions")?;
        let velocities = slice(velocities, count * number_count, "velocities")?;
        let free = slice(free_velocities, count * number_count, "free_velocities")?;
        for_each_scene(&scenes, statuses, |k, scene| {
            let given = [positions, velocities, free].map(|all| all[k * number_count..].as_ptr());
            begin(systems.of(k), scene, dt, number_count, given)
        })
    })
}

/// rayc_contact_system_detect_again() for many scenes at once: see rayc_contact_systems_begin(). number_count: the number of
/// unknowns of each system; is_more: 0 or 1 for each scene that has no error.
///
/// Errors: those of rayc_contact_system_detect_again(), as there.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_systems_detect_again(
    count: usize,
    systems: *const *mut rayc_contact_system,
    scenes: *const *mut rayc_scene,
    number_count: usize,
    velocities: *const f64,
    is_more: *mut u32,
    statuses: *mut u32,
) -> rayc_status {
    guard(|| {
        let (systems, scenes) = (Pointers::new(systems, count, "systems")?, Pointers::new(scenes, count, "scenes")?);
        let velocities = slice(velocities, count * number_count, "velocities")?;
        let places = slice(is_more.cast::<AtomicU32>(), count, "is_more")?;
        for_each_scene(&scenes, statuses, |k, scene| {
            let (given, mut found) = (velocities[k * number_count..].as_ptr(), 0);
            detect_again(systems.of(k), scene, number_count, given, &mut found)?;
            places[k].store(found, Ordering::Relaxed);
            Ok(())
        })
    })
}
