//! Many bodies in one scene: adding and removing them, moving them each step, and which of them may touch. What touches is asked
//! with rayc_scene_query() of raycontact/contacts.h.

mod batch;
mod bodies;
mod host_threads;
mod options;
mod pairs;

pub(super) use batch::{Pointers, for_each_scene};
pub use bodies::*;
pub use options::*;
pub use pairs::*;

use crate::capi::ffi::{Handle, HandleKind, InPrecision};
use crate::scene::Scene;

/// Many bodies, and all contacts among them. Bodies are numbered from 0, and keep their numbers; a scene holds copies of the
/// meshes it is given.
///
/// Threads: only one call at a time may use a scene, from any thread; calls with a const scene may run at the same
/// time. Other calls return RAYC_STATUS_BUSY. Different scenes may be used at once. rayc_scene_options says whose
/// threads do the work. The caller frees the scene with rayc_scene_destroy(), which also ends its threads.
pub struct rayc_scene {
    pub(super) scene: AnyScene,
}

impl Handle for rayc_scene {
    const KIND: HandleKind = HandleKind::SCENE;
}

/// A scene of either precision.
pub(super) type AnyScene = InPrecision<Scene<f32>, Scene<f64>>;
