use super::host_threads::HostThreads;
use super::options::rayc_scene_options;
use super::{AnyScene, rayc_scene};
use crate::capi::base::{rayc_scalar, rayc_status, rayc_vectors};
use crate::capi::ffi::{
    Failure, Output, Strided, changing, flag, give, guard, guard_end, read_options, reading, reference, scalar_from,
    take_back, with_precision,
};
use crate::capi::mesh::{rayc_mesh, renew_positions};
use crate::math::{Pose, Scalar};
use crate::memory::{self, text};
use crate::scene::Scene;
use std::sync::Arc;

/// More threads than any machine this runs on has cores are a mistake of the caller's.
const MOST_THREADS: u32 = 1024;

/// Makes an empty scene. options: NULL for the defaults. *scene: the new handle.
///
/// Errors: RAYC_STATUS_THREADS_NOT_STARTED, RAYC_STATUS_INVALID_OPTION for too many threads, or for
/// threads beside a parallel_for.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_create(
    options: *const rayc_scene_options,
    scene: *mut *mut rayc_scene,
) -> rayc_status {
    guard(|| {
        let options = read_options(options)?;
        let place = Output::new(scene, "scene")?;
        let precision = scalar_from(options.precision, "precision")?;
        if options.threads > MOST_THREADS {
            return Err(Failure::new(
                rayc_status::RAYC_STATUS_INVALID_OPTION,
                text!("threads is {}; give 0 to {MOST_THREADS}", options.threads),
            ));
        }
        if options.parallel_for.is_some() && options.threads != 1 {
            return Err(Failure::new(
                rayc_status::RAYC_STATUS_INVALID_OPTION,
                text!("threads is {} beside a parallel_for; give 1, or no parallel_for", options.threads),
            ));
        }
        let scene = match precision {
            rayc_scalar::RAYC_SCALAR_F32 => AnyScene::F32(new_scene(&options)?),
            rayc_scalar::RAYC_SCALAR_F64 => AnyScene::F64(new_scene(&options)?),
        };
        give(place, rayc_scene { scene })
    })
}

fn new_scene<T: Scalar>(options: &rayc_scene_options) -> Result<Scene<T>, Failure> {
    let context = options.parallel_context;
    Ok(match options.parallel_for {
        Some(parallel_for) => {
            // For the pointer and its counts.
            memory::ask(size_of::<HostThreads>() + 2 * size_of::<usize>());
            Scene::with_host_threads(Arc::new(HostThreads { parallel_for, context }))
        }
        None => Scene::new(options.threads as usize)?,
    })
}

/// Adds a copy of `mesh` with its present positions. *body: its number.
///
/// The n-th body gets the number n − 1, whatever was removed before: any call with the number of a removed body gets
/// RAYC_STATUS_UNKNOWN_BODY. In a scene whose bodies come and go without end, rayc_scene_release_body_numbers() keeps
/// numbers small, and so arrays indexed by them short.
///
/// Errors: RAYC_STATUS_PRECISION_MISMATCH, RAYC_STATUS_OUT_OF_MEMORY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_add_mesh(
    scene: *mut rayc_scene,
    mesh: *const rayc_mesh,
    body: *mut u32,
) -> rayc_status {
    guard(|| {
        let mut scene = changing(scene, "scene")?;
        let mesh = reading(mesh, "mesh")?;
        let place = Output::new(body, "body")?;
        place.write(with_precision!(&mut scene.scene, &mesh.mesh, |scene, mesh| scene.add(mesh.clone())))
    })
}

/// Renews the positions of a body's vertices.
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY, RAYC_STATUS_WRONG_COUNT, RAYC_STATUS_NOT_FINITE, RAYC_STATUS_MESH_BEYOND_RANGE; the
/// positions are then as before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_set_positions(
    scene: *mut rayc_scene,
    body: u32,
    positions: *const rayc_vectors,
) -> rayc_status {
    fn set<T: Scalar>(scene: &mut Scene<T>, body: u32, positions: &Strided) -> Result<(), Failure> {
        renew_positions(scene.mesh_mut(body)?, positions)
            .map_err(|failure| Failure { message: text!("body {body}: {}", failure.message).into(), ..failure })
    }
    guard(|| {
        let mut scene = changing(scene, "scene")?;
        let positions = Strided::new(reference(positions, "positions")?, "positions")?;
        with_precision!(&mut scene.scene, |scene| set(scene, body, &positions))
    })
}

/// Where a body is that keeps its shape: a point p of it, in its own coordinates, is at rotation · p + position in the
/// world's, both right-handed.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_pose {
    /// Where the origin of the body's own coordinates is, in the world's; in the scene's unit of length, finite.
    pub position: [f64; 3],
    /// The rows of the rotation matrix from the body's own coordinates to the world's; its columns are the body's axes as
    /// the world sees them. The rows are of unit length and at right angles to within 1e-6 (that is how far the matrix times
    /// its transpose may be from the identity, as the root of the sum of squares), and the determinant is 1, not −1. Of a
    /// unit quaternion w, x, y, z the rows are 1 − 2(y² + z²), 2(xy − wz), 2(xz + wy); 2(xy + wz), 1 − 2(x² + z²),
    /// 2(yz − wx); 2(xz − wy), 2(yz + wx), 1 − 2(x² + y²).
    pub rotation: [[f64; 3]; 3],
}

/// Moves a body that keeps its shape, instead of rayc_scene_set_positions(). The pose is applied to the positions
/// with which the rayc_mesh was created. Later positions of the mesh or the body do not count, nor does the last
/// pose: poses are not added up. Any body may be moved by a pose, and by positions again at any time; a body that was
/// deformed gets its first shape back.
///
/// No vertex is copied. The search tree stays as it is, and a query moves only what lies where the body meets others.
/// So a step costs what the overlap costs, however many vertices the body has. The first pose of a body takes the
/// time of a few copies. A body that gets neither pose nor positions, or the same pose again, costs nothing. A body
/// whose contacts with itself are switched on is moved as a whole, as with positions.
///
/// Contacts are the same, to the bit, as with rayc_scene_set_positions() where coordinate k of each vertex is
/// `rotation[k][0] · x + rotation[k][1] · y + rotation[k][2] · z + position[k]`, in double precision, each product and
/// sum rounded, added from left to right; in a scene of single precision x, y, z are the mesh's coordinates in that
/// precision and the sum is rounded once more. As new positions do, it ends a step where rayc_scene_advance() is not
/// used; contacts found before it are those of the old pose. Contacts, forces and boxes are in the world's coordinates.
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY; RAYC_STATUS_NOT_FINITE where a number of the pose is not; RAYC_STATUS_INVALID_DIRECTION
/// where the rotation is no rotation matrix, or mirrors; RAYC_STATUS_MESH_BEYOND_RANGE where the body might reach beyond the
/// largest number of the scene's precision. The body is then where it was.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_set_pose(scene: *mut rayc_scene, body: u32, pose: *const rayc_pose) -> rayc_status {
    guard(|| {
        let mut scene = changing(scene, "scene")?;
        let rayc_pose { position, rotation } = *reference(pose, "pose")?;
        let pose = Pose { position, rotation };
        with_precision!(&mut scene.scene, |scene| Ok(scene.set_pose(body, &pose)?))
    })
}

/// Ends a step of `seconds` seconds, ≥ 0. What the last query of the step found goes into the memory of the pairs,
/// which decides when a pair that contacts cannot part begins to escape. Call it once a step, after the step's last
/// rayc_scene_query(). A host that queries several times a step, to look ahead or to detect again, then escapes no
/// sooner.
///
/// The rules count steps; a step shorter than 1/60 s counts as the fraction of 1/60 s that it is. From the first call
/// on, only this function ends a step: a host that queries several times in its first step calls it once before them,
/// with 0. A scene for which it is never called ends a step, of 1/60 s or more, at each query before which any body
/// was given positions since the last query.
///
/// Errors: RAYC_STATUS_INVALID_OPTION where seconds is negative or not finite.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_advance(scene: *mut rayc_scene, seconds: f64) -> rayc_status {
    guard(|| with_precision!(&mut changing(scene, "scene")?.scene, |scene| Ok(scene.advance(seconds)?)))
}

/// Removes a body. Its number is refused from here on, and no other body gets it before
/// rayc_scene_release_body_numbers().
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_remove_body(scene: *mut rayc_scene, body: u32) -> rayc_status {
    guard(|| with_precision!(&mut changing(scene, "scene")?.scene, |scene| Ok(scene.remove(body).map(drop)?)))
}

/// Frees a scene and ends its threads, which have ended when it returns; NULL does nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_destroy(scene: *mut rayc_scene) -> rayc_status {
    guard_end(|| take_back(scene, "scene"))
}

/// Lets the numbers of bodies removed so far be given to new bodies, the smallest first. An array indexed by body
/// number then never has to be longer than the largest number of bodies that were in the scene between two calls.
///
/// Call it when nothing uses the number of a removed body any more: no contacts, no saved state, no contact system. A
/// call with such a number would reach the body that has it next. Takes time in proportion to the numbers in use.
///
/// Errors: RAYC_STATUS_BUSY, RAYC_STATUS_OUT_OF_MEMORY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_release_body_numbers(scene: *mut rayc_scene) -> rayc_status {
    guard(|| {
        with_precision!(&mut changing(scene, "scene")?.scene, |scene| scene.release_body_numbers());
        Ok(())
    })
}

/// Switches contacts of a body with itself on (is_on = 1) or off (0), from the next query on; they are off for a new
/// body. rayc_query_self() says what they are. Where they are on, contacts with other bodies are also found past the
/// body's own folds, as with past_folds in rayc_detection_options.
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY, RAYC_STATUS_INVALID_OPTION where is_on is neither 0 nor 1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_set_self_collision(scene: *mut rayc_scene, body: u32, is_on: u32) -> rayc_status {
    guard(|| {
        let mut scene = changing(scene, "scene")?;
        let is_on = flag("is_on", is_on)?;
        with_precision!(&mut scene.scene, |scene| Ok(scene.set_self_collision(body, is_on)?))
    })
}

/// Says how far apart the unknowns are that move a body's vertices: 0 where the vertices are unknowns; the distance between
/// nodes where a cage carries it; infinity where nothing moves it. A rigid body need not be told. With an accuracy the samples
/// of a pair stand no closer to one another than the unknowns of the finer one of both, and where neither has 0, its contacts'
/// loads are not spread. A body that is not told counts as one with 0 there. Where 0 was said, the body's vertices also bear
/// what the other's rays bring as an even pressure on the areas of these does: two elastic bodies with different meshes that
/// are pressed together flush have the same stress everywhere. Detection then takes 1.5 to 9 times as long. From the next query
/// on. A contact system knows it, but what is said here counts.
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY, RAYC_STATUS_INVALID_OPTION where it is negative or NaN.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_set_carrier_spacing(
    scene: *mut rayc_scene,
    body: u32,
    spacing: f64,
) -> rayc_status {
    guard(|| {
        with_precision!(&mut changing(scene, "scene")?.scene, |scene| {
            let spacing = Scalar::of(spacing);
            Ok(scene.mesh_mut(body)?.set_carrier_spacing(spacing)?)
        })
    })
}
