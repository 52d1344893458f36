use super::rayc_scene;
use crate::capi::base::rayc_status;
use crate::capi::ffi::{Output, changing, flag, guard, reading, with_precision};

/// Switches contacts between two bodies off (is_on = 0) or on again (1), from the next query on; they are on for new
/// bodies. Use it for collision groups, or for parts of one machine. While it is off, the pair costs nothing, is not
/// counted, and forgets what it remembered.
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY, RAYC_STATUS_INVALID_OPTION where a and b are the same or is_on is neither 0 nor 1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_set_pair_collision(
    scene: *mut rayc_scene,
    a: u32,
    b: u32,
    is_on: u32,
) -> rayc_status {
    guard(|| {
        let mut scene = changing(scene, "scene")?;
        let is_on = flag("is_on", is_on)?;
        with_precision!(&mut scene.scene, |scene| Ok(scene.set_pair_collision(a, b, is_on)?))
    })
}

/// Allows two bodies to escape from one another (allowed = 1, the default), or forbids it (0), as for a press fit or
/// a body that is meant to stay inside another. Forbidding ends an escape that is under way. It holds until it is set
/// again or one of the bodies is removed. rayc_statistics counts in escapes_forbidden where the pair would have begun
/// to escape.
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY, RAYC_STATUS_INVALID_OPTION where a and b are the same or allowed is neither.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_allow_escape(scene: *mut rayc_scene, a: u32, b: u32, allowed: u32) -> rayc_status {
    guard(|| {
        let mut scene = changing(scene, "scene")?;
        let allowed = flag("allowed", allowed)?;
        with_precision!(&mut scene.scene, |scene| Ok(scene.allow_escape(a, b, allowed)?))
    })
}

/// Whether two bodies may escape from one another: *allowed is 1 or 0.
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY, RAYC_STATUS_INVALID_OPTION where a and b are the same.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_may_escape(
    scene: *const rayc_scene,
    a: u32,
    b: u32,
    allowed: *mut u32,
) -> rayc_status {
    guard(|| {
        let place = Output::new(allowed, "allowed")?;
        place.write(u32::from(with_precision!(&reading(scene, "scene")?.scene, |scene| scene.may_escape(a, b)?)))
    })
}
