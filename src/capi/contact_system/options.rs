use super::{AnySystem, rayc_contact_system};
use crate::capi::base::{rayc_scalar, rayc_status};
use crate::capi::contacts::rayc_weighting;
use crate::capi::ffi::{
    Failure, Options, Output, flag, give, growing, guard, guard_end, read_options, scalar_from, take_back,
    write_defaults,
};
use crate::math::Scalar;
use crate::system::{ContactSystem, RigidUnknowns};

/// How a contact system works. Fill with rayc_default_contact_system_options(), then change what you need.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_contact_system_options {
    /// sizeof(rayc_contact_system_options).
    pub struct_size: usize,
    /// That of the scene, a rayc_scalar. Default RAYC_SCALAR_F64.
    pub precision: u32,
    /// 1: the velocities of rigid bodies are unknowns of the host, behind those of its nodes. 0: the host solves for
    /// its nodes alone, and rigid bodies give way exactly as if they were solved for;
    /// rayc_contact_system_rigid_velocity() gives their velocities. A step then factors a dense matrix of six rows for
    /// each, so fifty of them are about the most. Default 0.
    pub keeps_rigid_unknowns: u32,
    /// 1: contacts are looked for where bodies will be at the end of the step; 0: where they are at its start. Default 1.
    pub look_ahead: u32,
    /// A rayc_weighting: RAYC_WEIGHTING_VERTEX weights all contacts of bodies alike, and materials' stiffness is in N/m.
    /// Default RAYC_WEIGHTING_AREA.
    pub weighting: u32,
}

growing!(rayc_contact_system_options, keeps_rigid_unknowns: u32);

impl Options for rayc_contact_system_options {
    fn defaults() -> Self {
        let precision = rayc_scalar::RAYC_SCALAR_F64 as u32;
        let weighting = rayc_weighting::RAYC_WEIGHTING_AREA as u32;
        Self { struct_size: size_of::<Self>(), precision, keeps_rigid_unknowns: 0, look_ahead: 1, weighting }
    }
}

impl rayc_contact_system_options {
    /// The system that these ask for.
    pub(super) fn system<T: Scalar>(&self) -> Result<ContactSystem<T>, Failure> {
        let unknowns = match flag("keeps_rigid_unknowns", self.keeps_rigid_unknowns)? {
            true => RigidUnknowns::Kept,
            false => RigidUnknowns::Eliminated,
        };
        let looks_ahead = flag("look_ahead", self.look_ahead)?;
        let system = ContactSystem::new(unknowns).weighted_by(rayc_weighting::read(self.weighting)?);
        Ok(if looks_ahead { system } else { system.looking_at_the_start() })
    }
}

/// Fills `options` with the defaults. struct_size: sizeof(rayc_contact_system_options).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_default_contact_system_options(
    struct_size: usize,
    options: *mut rayc_contact_system_options,
) -> rayc_status {
    guard(|| write_defaults(struct_size, options))
}

/// Makes a system without bodies. options: NULL for the defaults. *system: the new handle.
///
/// Errors: RAYC_STATUS_INVALID_STRUCT_SIZE, RAYC_STATUS_UNKNOWN_ENUM, RAYC_STATUS_INVALID_OPTION.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_create(
    options: *const rayc_contact_system_options,
    system: *mut *mut rayc_contact_system,
) -> rayc_status {
    guard(|| {
        let options = read_options(options)?;
        let place = Output::new(system, "system")?;
        let system = match scalar_from(options.precision, "precision")? {
            rayc_scalar::RAYC_SCALAR_F32 => AnySystem::F32(options.system()?),
            rayc_scalar::RAYC_SCALAR_F64 => AnySystem::F64(options.system()?),
        };
        give(place, rayc_contact_system { system, parts: Default::default(), room: Default::default() })
    })
}

/// Frees a system; NULL does nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_destroy(system: *mut rayc_contact_system) -> rayc_status {
    guard_end(|| take_back(system, "system"))
}
