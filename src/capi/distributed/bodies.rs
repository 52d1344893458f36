use crate::bytes::Reader;
use crate::capi::base::rayc_status;
use crate::capi::ffi::{
    Failure, Known, Output, changing, check_size, flag, growing, guard, range_of, reading, reference, with_precision,
    write_known,
};
use crate::capi::mesh::rayc_mesh;
use crate::capi::scene::{AnyScene, rayc_scene};
use crate::capi::state::rayc_pair_memory;
use crate::distributed::{Sharing, finds_pair};
use crate::escape::PairMemory;
use crate::math::Scalar;
use crate::memory::text;
use crate::scene::{PairCost, Scene, SceneError};

/// The same with a key that the host chooses. Pairs, contacts and sums are ordered by the bodies' keys, and by number
/// where keys are equal; the first body of a pair is the first in this order. A body added without a key has its
/// number as key. So scenes whose bodies have the same keys find the same contacts in the same order, whatever
/// numbers the bodies have.
///
/// Errors: RAYC_STATUS_KEY_TAKEN, and those of rayc_scene_add_mesh().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_add_mesh_with_key(
    scene: *mut rayc_scene,
    mesh: *const rayc_mesh,
    key: u64,
    body: *mut u32,
) -> rayc_status {
    guard(|| {
        let mut scene = changing(scene, "scene")?;
        let mesh = reading(mesh, "mesh")?;
        let place = Output::new(body, "body")?;
        place.write(with_precision!(&mut scene.scene, &mesh.mesh, |scene, mesh| scene.add_with_key(mesh.clone(), key)?))
    })
}

/// For rayc_scene_share_body(): the neighbours of a body are counted in this scene alone.
pub const RAYC_NEIGHBOURS_COUNTED: u32 = u32::MAX;

/// What a scene knows of a body's present state; later versions may tell more, at the end.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_body_state {
    /// The smallest corner of the box around the body's surface.
    pub lower: [f64; 3],
    /// The largest.
    pub upper: [f64; 3],
    /// What the newest query took for this body, counted in rays; 0 before the first. These are the rays of its
    /// contacts with itself, half of those of its pairs, all of those of its pairs with ghosts
    /// (rayc_scene_share_body()), and one ray for every fifty triangles that were read.
    pub cost: f64,
    /// 1: the body may overlap itself, as the newest query or rayc_scene_find_self_contacts() found; 0: it does not, or
    /// its self-collision is off.
    pub overlaps_itself: u32,
    /// Always 0.
    pub reserved: u32,
}

growing!(rayc_body_state);

/// What the newest query took for one pair of bodies; later versions may tell more, at the end.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_pair_cost {
    /// The pair's bodies, the one that comes first in their order first.
    pub first: u32,
    /// The other.
    pub second: u32,
    /// How many rays as long as this the query took. Reading the bodies' triangles is no pair's cost; it is in that of
    /// rayc_body_state.
    pub cost: f64,
}

growing!(rayc_pair_cost);

/// Says how a body is shared between scenes of several processes. Each scene has some bodies of its own, and ghosts:
/// copies of bodies of other scenes that meet its own. The call takes effect from the next query on; a new body is
/// not shared.
///
/// is_ghost: 1 for a body that belongs to another scene. A ghost has no contacts with itself here, and none with other
/// ghosts. The contacts of a ghost and a body of this scene are found by only one of the two scenes. The two keys
/// (rayc_scene_add_mesh_with_key()) decide which one; each of the two is about as likely. 0 for a body of this scene.
/// neighbours: how many bodies of all scenes together have boxes that overlap its own, which decides how many rays a
/// crowd gets (RAYC_SAMPLING_ACCURACY); or RAYC_NEIGHBOURS_COUNTED. overlaps_itself: for a ghost, what
/// rayc_scene_body_state() says in its own scene; otherwise 0.
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY, RAYC_STATUS_INVALID_OPTION where a flag is neither 0 nor 1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_share_body(
    scene: *mut rayc_scene,
    body: u32,
    is_ghost: u32,
    neighbours: u32,
    overlaps_itself: u32,
) -> rayc_status {
    guard(|| {
        let mut scene = changing(scene, "scene")?;
        let sharing = Sharing {
            is_foreign: flag("is_ghost", is_ghost)?,
            neighbours: Some(neighbours).filter(|&count| count != RAYC_NEIGHBOURS_COUNTED),
            overlaps_itself: flag("overlaps_itself", overlaps_itself)?,
        };
        with_precision!(&mut scene.scene, |scene| Ok(scene.share(body, sharing)?))
    })
}

/// Whether the scene that has the body of key `own` finds the contacts with a ghost of key `ghost` (*found: 1), or
/// the scene that has the ghost's body does (0): see rayc_scene_share_body().
///
/// Errors: RAYC_STATUS_INVALID_OPTION where the keys are the same.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_finds_pair(own: u64, ghost: u64, found: *mut u32) -> rayc_status {
    guard(|| {
        let place = Output::new(found, "found")?;
        if own == ghost {
            let message = text!("both keys are {own}; give those of two different bodies");
            return Err(Failure::new(rayc_status::RAYC_STATUS_INVALID_OPTION, message));
        }
        place.write(u32::from(finds_pair(own, ghost)))
    })
}

/// Finds the contacts of bodies with themselves where that is switched on, as the next rayc_scene_query() would. That
/// query does not find them again if the positions stay the same. Use it to know overlaps_itself of rayc_body_state
/// before the query.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_find_self_contacts(scene: *mut rayc_scene) -> rayc_status {
    guard(|| {
        with_precision!(&mut changing(scene, "scene")?.scene, |scene| scene.find_self_contacts());
        Ok(())
    })
}

/// A body's state. struct_size: sizeof(rayc_body_state), so that a later library writes no more than the caller knows.
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY, RAYC_STATUS_INVALID_STRUCT_SIZE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_body_state(
    scene: *const rayc_scene,
    body: u32,
    struct_size: usize,
    state: *mut rayc_body_state,
) -> rayc_status {
    fn state_of<T: Scalar>(scene: &Scene<T>, body: u32) -> Result<rayc_body_state, SceneError> {
        let aabb = scene.mesh(body)?.aabb();
        let [lower, upper] = [aabb.lower, aabb.upper].map(|corner| corner.map(T::to_f64).into());
        let (cost, overlaps_itself) = (scene.body_cost(body)?, u32::from(scene.overlaps_itself(body)?));
        Ok(rayc_body_state { lower, upper, cost, overlaps_itself, reserved: 0 })
    }
    guard(|| {
        let found = with_precision!(&reading(scene, "scene")?.scene, |scene| state_of(scene, body)?);
        write_known(struct_size, state, "state", found)
    })
}

/// How many pairs the newest query looked at: those whose boxes overlap, but for pairs that do not collide or are found
/// by another process. *count: 0 before the first query.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_pair_cost_count(scene: *const rayc_scene, count: *mut usize) -> rayc_status {
    guard(|| {
        let scene = reading(scene, "scene")?;
        Output::new(count, "count")?.write(pair_costs(&scene.scene).len())
    })
}

/// Copies what the newest query took for pairs first … first + count − 1 to `out`, which has room for `count`: to balance
/// work between processes. They stand in the order of their first, then their second body; one that was removed since
/// is still named. struct_size: sizeof(rayc_pair_cost), so that a later library writes no more of each than the caller
/// knows.
///
/// Errors: RAYC_STATUS_WRONG_COUNT where the range reaches beyond the end, RAYC_STATUS_INVALID_STRUCT_SIZE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_copy_pair_costs(
    scene: *const rayc_scene,
    first: usize,
    count: usize,
    struct_size: usize,
    out: *mut rayc_pair_cost,
) -> rayc_status {
    guard(|| {
        let scene = reading(scene, "scene")?;
        let costs = pair_costs(&scene.scene);
        let asked = &costs[range_of("costs of pairs", first, count, costs.len())?];
        let of = |&PairCost { bodies: [first, second], cost }: &PairCost| rayc_pair_cost { first, second, cost };
        Known::new(struct_size, out, count, "out")?.write_all(asked.iter().map(of))
    })
}

fn pair_costs(scene: &AnyScene) -> &[PairCost] {
    with_precision!(scene, |scene| scene.pair_costs())
}

/// Replaces what one pair remembers by what rayc_scene_copy_pair_memories() gave, for this scene or for another: for
/// bodies that move from one process to another. Give the pair's bodies by their numbers in this scene, the one that
/// comes first in their order first. A query forgets it if the two boxes do not overlap then. struct_size:
/// sizeof(rayc_pair_memory).
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY, RAYC_STATUS_INVALID_OPTION where both are the same body,
/// RAYC_STATUS_SAVED_STATE_BROKEN where it is nothing that a pair remembers or the bodies are the other way round,
/// RAYC_STATUS_INVALID_STRUCT_SIZE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_set_pair_memory(
    scene: *mut rayc_scene,
    struct_size: usize,
    memory: *const rayc_pair_memory,
) -> rayc_status {
    fn set<T: Scalar>(scene: &mut Scene<T>, memory: &rayc_pair_memory) -> Result<(), SceneError> {
        let pair = [memory.first, memory.second];
        let remembered = PairMemory::from_bytes(&mut Reader { rest: &memory.state });
        scene.set_pair_memory(pair, remembered.ok_or(SceneError::PairMemory { pair })?)
    }
    guard(|| {
        let mut scene = changing(scene, "scene")?;
        check_size::<rayc_pair_memory>(struct_size)?;
        let memory = reference(memory, "memory")?;
        with_precision!(&mut scene.scene, |scene| Ok(set(scene, memory)?))
    })
}
