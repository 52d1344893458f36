//! Looking for contacts in two stages: where a system's own bodies will be, then, once the host has added the ghosts that are
//! needed there, which contacts they have.

use crate::math::Scalar;
use crate::memory;
use crate::scene::Scene;
use crate::system::{ContactSystem, SystemError};

/// Puts the scene's bodies, but ghosts, where [`begin`](ContactSystem::begin) with the same numbers would look for contacts, or
/// [`begin_explicit`](ContactSystem::begin_explicit) where no free velocities are given, and does no more. Where the bodies are
/// then shows which ghosts the scene needs.
///
/// # Errors
/// Those of [`begin`](ContactSystem::begin).
pub fn look_ahead<T: Scalar>(
    system: &mut ContactSystem<T>,
    scene: &mut Scene<T>,
    dt: f64,
    positions: &[f64],
    velocities: &[f64],
    free_velocities: Option<&[f64]>,
) -> Result<(), SystemError> {
    system.prepare(scene, dt, [positions, velocities, free_velocities.unwrap_or(velocities)])?;
    let is_ahead = free_velocities.is_some() && !system.looks_at_start;
    system.move_surfaces(scene, if is_ahead { dt } else { 0.0 }, true)
}

/// Puts the scene's bodies, but ghosts, where they end with these velocities, and does no more. Where the bodies are then shows
/// which ghosts [`detect_among`] needs.
///
/// Systems that share bodies first ask [`off_course`](ContactSystem::off_course) whether any of them has to look. Then each
/// calls this, adds the ghosts that its scene needs there (a ghost may be added, told its motion and what its pairs remember
/// within a step), and calls [`detect_among`].
///
/// # Errors
/// Those of [`detect_again`](ContactSystem::detect_again).
pub fn look_again<T: Scalar>(
    system: &mut ContactSystem<T>,
    scene: &mut Scene<T>,
    velocities: &[f64],
) -> Result<(), SystemError> {
    let step = system.check_velocities(velocities)?;
    system.check_bodies(scene)?;
    system.go_on_with(velocities, step);
    system.move_surfaces(scene, step.dt, true)
}

/// As [`detect_again`](ContactSystem::detect_again), but it looks in any case, and rows are held as before: where any system has
/// found more, all are to [linearise](ContactSystem::linearise) at these velocities. `positions` and `start_velocities`: those
/// given to [`begin`](ContactSystem::begin), with those of ghosts that have joined.
///
/// # Errors
/// Those of [`detect_again`](ContactSystem::detect_again).
pub fn detect_among<T: Scalar>(
    system: &mut ContactSystem<T>,
    scene: &mut Scene<T>,
    positions: &[f64],
    start_velocities: &[f64],
    velocities: &[f64],
) -> Result<bool, SystemError> {
    let step = system.check_velocities(velocities)?;
    system.check_nodes([("positions", positions), ("start_velocities", start_velocities)])?;
    system.check_bodies(scene)?;
    memory::refill(&mut system.buffers.positions, positions.iter().copied());
    memory::refill(&mut system.buffers.velocities, start_velocities.iter().copied());
    system.detect_at(scene, velocities, step)
}
