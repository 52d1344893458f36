//! What a scene remembers of pairs from step to step: to look at, and to save with the state of a simulation and restore.

use crate::capi::base::rayc_status;
use crate::capi::ffi::{Known, Output, changing, growing, guard, range_of, reading, slice, with_precision};
use crate::capi::scene::{AnyScene, rayc_scene};
use crate::escape::PairMemory;
use crate::math::Scalar;

/// What a pair of bodies of a scene remembers from step to step while their boxes overlap; rayc_scene_advance() ends a
/// step. Later versions may tell more, at the end.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_pair_memory {
    /// The pair's bodies, the one that comes first in their order first: by key, and so by number where none has a key.
    pub first: u32,
    /// The other.
    pub second: u32,
    /// 1: the pair is escaping; 0: its contacts part it. For reading: rayc_scene_set_pair_memory() takes it from
    /// `state`.
    pub escaping: u32,
    /// Always 0, so that equal memories are equal byte by byte.
    pub reserved: u32,
    /// The direction in which the first body leaves the second, of unit length; 0, 0, 0 where the pair is not escaping.
    /// For reading, too.
    pub direction: [f64; 3],
    /// All that the pair remembers, for rayc_scene_set_pair_memory(); the same bytes on every machine. What they mean is the
    /// library's own and changes with its version.
    pub state: [u8; 88],
}

growing!(rayc_pair_memory);

impl<T: Scalar> From<&([u32; 2], PairMemory<T>)> for rayc_pair_memory {
    fn from(([first, second], memory): &([u32; 2], PairMemory<T>)) -> Self {
        let mut state = [0; 88];
        let packed = memory.to_bytes();
        state[..packed.len()].copy_from_slice(&packed);
        Self {
            first: *first,
            second: *second,
            escaping: u32::from(memory.escape.is_some()),
            reserved: 0,
            direction: memory.escape.unwrap_or_default().map(T::to_f64).into(),
            state,
        }
    }
}

/// How many pairs remember something: those whose boxes overlapped in the last query.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_pair_memory_count(scene: *const rayc_scene, count: *mut usize) -> rayc_status {
    guard(|| {
        let scene = &reading(scene, "scene")?.scene;
        Output::new(count, "count")?.write(memory_count(scene))
    })
}

/// Copies the memories of pairs first … first + count − 1 to `out`, which has room for `count`. They stand in the
/// order of their first, then their second body. struct_size: sizeof(rayc_pair_memory), so that a later library writes
/// no more of each than the caller knows.
///
/// Errors: RAYC_STATUS_WRONG_COUNT where the range reaches beyond the end, RAYC_STATUS_INVALID_STRUCT_SIZE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_copy_pair_memories(
    scene: *const rayc_scene,
    first: usize,
    count: usize,
    struct_size: usize,
    out: *mut rayc_pair_memory,
) -> rayc_status {
    guard(|| {
        let scene = &reading(scene, "scene")?.scene;
        let range = range_of("pair memories", first, count, memory_count(scene))?;
        let out = Known::new(struct_size, out, count, "out")?;
        with_precision!(scene, |scene| out.write_all(scene.pair_memories()[range].iter().map(Into::into)))
    })
}

/// How many bytes rayc_scene_save_pair_memories() writes now.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_saved_length(scene: *const rayc_scene, length: *mut usize) -> rayc_status {
    guard(|| {
        let scene = &reading(scene, "scene")?.scene;
        Output::new(length, "length")?.write(with_precision!(scene, |scene| scene.saved_length()))
    })
}

/// Writes what all pairs remember to `bytes`; length must be that of rayc_scene_saved_length(). A scene with the same
/// bodies, positions, options and forbidden escapes that restores it goes on as this one does, to the bit. The bytes
/// carry their version and a checksum, and are the same on every machine.
///
/// Errors: RAYC_STATUS_WRONG_COUNT.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_save_pair_memories(
    scene: *const rayc_scene,
    length: usize,
    bytes: *mut u8,
) -> rayc_status {
    guard(|| {
        let scene = &reading(scene, "scene")?.scene;
        let mut saved = Vec::new();
        with_precision!(scene, |scene| scene.save_pair_memories(&mut saved));
        Output::exactly(bytes, length, saved.len(), "bytes")?.write_all(saved.into_iter())
    })
}

/// Replaces what the pairs remember by the `length` bytes that were saved.
///
/// Errors: RAYC_STATUS_SAVED_STATE_BROKEN where the bytes are not what was saved,
/// RAYC_STATUS_SAVED_STATE_OTHER_VERSION, RAYC_STATUS_PRECISION_MISMATCH, and RAYC_STATUS_UNKNOWN_BODY where a body of a
/// saved pair is not in the scene; the memories are then as before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_restore_pair_memories(
    scene: *mut rayc_scene,
    length: usize,
    bytes: *const u8,
) -> rayc_status {
    guard(|| {
        let mut scene = changing(scene, "scene")?;
        let bytes = slice(bytes, length, "bytes")?;
        with_precision!(&mut scene.scene, |scene| Ok(scene.restore_pair_memories(bytes)?))
    })
}

fn memory_count(scene: &AnyScene) -> usize {
    with_precision!(scene, |scene| scene.pair_memories().len())
}
