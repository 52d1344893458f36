//! Contact with friction, rigid bodies and cages, on the unknowns of the host's own solver.

mod batch;
mod bodies;
mod floats;
mod matrix;
mod number;
mod options;
mod step;

pub use batch::*;
pub use bodies::*;
pub use floats::*;
pub use matrix::*;
pub use options::*;
pub use step::*;

use crate::capi::ffi::{Handle, HandleKind, InPrecision};
use crate::distributed::Parts;
use crate::system::ContactSystem;

/// Contact on the unknowns that a simulator solves for. It knows what carries each body of a scene, its material, its
/// friction, and which bodies are rigid. It looks where bodies will be at the end of the step, turns each contact into
/// a row (a spring that only pushes, with friction) on the host's nodes and rigid bodies, and gives a solver the forces
/// and the products with their derivative. Rows are held: which of them push and how they rub is decided when a step
/// begins, and anew only by rayc_contact_system_linearise() and rayc_contact_system_detect_again(). In between, forces
/// are linear in the velocities.
///
/// One step: rayc_contact_system_set_motion() for bodies that are not deformable, rayc_contact_system_begin(); then, as
/// often as needed, a solve with rayc_contact_system_add_forces() and rayc_contact_system_add_product(), then
/// rayc_contact_system_linearise() and rayc_contact_system_detect_again(); rayc_contact_system_finish(). A steady step
/// allocates nothing.
///
/// Numbers are doubles in SI units, whatever the precision; functions whose names end in _f32 take floats. Vectors of
/// unknowns hold x, y, z of each node, then, where rigid bodies are kept, six numbers of each in the order they were
/// added: linear and angular velocity, or force and torque. Numbers given are at most 2^80 (1.2e24) in size, so that forces
/// and energies stay finite; others are refused with RAYC_STATUS_INVALID_OPTION or, where they have one, with a status of
/// their own.
///
/// Threads: one call at a time for one system. The caller frees it with rayc_contact_system_destroy().
pub struct rayc_contact_system {
    pub(super) system: AnySystem,
    pub(super) parts: Parts,
    /// Room for floats as doubles.
    room: [Vec<f64>; 3],
}

impl Handle for rayc_contact_system {
    const KIND: HandleKind = HandleKind::CONTACT_SYSTEM;
}

/// A system of either precision.
pub(super) type AnySystem = InPrecision<ContactSystem<f32>, ContactSystem<f64>>;
