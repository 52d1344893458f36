use super::checks::flag;
use super::failure::{Failure, rayc_status};
use super::guard::guard;
use super::options::rayc_weighting;
use super::pointers::reference;
use super::sized_structs::{Options, growing, read_options, write_defaults, write_options};
use super::vectors::rayc_scalar;
use crate::math::Scalar;
use crate::system::{ContactSystem, Material, RigidUnknowns};

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
///
/// Errors: RAYC_STATUS_INVALID_STRUCT_SIZE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_default_contact_system_options(
    struct_size: usize,
    options: *mut rayc_contact_system_options,
) -> rayc_status {
    // SAFETY: the caller's struct has the size it says.
    guard(|| unsafe { write_defaults(struct_size, options) })
}

/// How a body's surface bears load, damps and rubs. Fill with rayc_bearing_material(), which suggests values, then change
/// what you need.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_material {
    /// sizeof(rayc_material).
    pub struct_size: usize,
    /// Pressure per depth, in N/m³; from 0 to 2^80 (1.2e24).
    pub stiffness: f64,
    /// Damping over stiffness, in s; from 0 to 2^80.
    pub damping_time: f64,
    /// Coulomb's coefficient, static and kinetic; from 0 to 2^80.
    pub friction: f64,
    /// At more than this depth, in m, a contact pushes no harder in one step than at this depth; > 0, and infinity for
    /// no cap. By as much as bodies come nearer within the step they are pushed back in full.
    pub depth_cap: f64,
}

growing!(rayc_material, depth_cap: f64);

impl Options for rayc_material {
    /// Of what a caller's header does not have yet; all that there is now is in the first.
    fn defaults() -> Self {
        let (damping_time, friction, depth_cap) = (0.05, 0.5, f64::INFINITY);
        Self { struct_size: size_of::<Self>(), stiffness: 0.0, damping_time, friction, depth_cap }
    }
}

impl rayc_material {
    /// # Safety
    /// `material` is NULL or points to as many readable bytes as it says.
    pub(super) unsafe fn read(material: *const Self) -> Result<Material, Failure> {
        // SAFETY: the first field is the size; the rest by this function's contract.
        let Self { stiffness, damping_time, friction, depth_cap, .. } = unsafe {
            reference(material.cast::<usize>(), "material")?;
            read_options(material)?
        };
        Ok(Material { stiffness, damping_time, friction, depth_cap })
    }
}

/// Where a rigid body, or one moved by the host, is and how it moves.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_motion {
    /// The centre of mass, in m.
    pub position: [f64; 3],
    /// The rows of the rotation matrix from the body's own coordinates to the world's.
    pub rotation: [[f64; 3]; 3],
    /// At the start of the step: linear velocity in m/s, then angular in rad/s, in the world's coordinates.
    pub velocity: [f64; 6],
    /// What the velocity would be at the end of the step without contact; of a body moved by the host, what moves it.
    pub free_velocity: [f64; 6],
}

/// Fills `material` with one that bears `pressure` (Pa) at `depth` (m), and asks for no more in one step: the stiffness is
/// pressure / depth, the cap is depth, damping time 0.05 s, friction 0.5. struct_size: sizeof(rayc_material).
///
/// For an elastic body, take a quarter of its Young's modulus and a quarter of the edge of its elements: more would crush
/// elements. For a rigid or still one, take some ten times the pressure that it bears at rest (weight over the area that
/// carries it), and ten times the depth to which bodies may sink in.
///
/// Two bodies' materials combine so: the surfaces are springs in series, so the softer decides; damping times are weighted
/// by how much of the depth each surface takes; friction is the geometric mean; the smaller cap holds.
/// rayc_contact_system_set_pair_material() overrides it.
///
/// Errors: RAYC_STATUS_INVALID_MATERIAL where a number is not finite and > 0, RAYC_STATUS_INVALID_STRUCT_SIZE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_bearing_material(
    pressure: f64,
    depth: f64,
    struct_size: usize,
    material: *mut rayc_material,
) -> rayc_status {
    // SAFETY: the caller's struct has the size it says.
    guard(|| unsafe {
        let Material { stiffness, damping_time, friction, depth_cap } = Material::bearing(pressure, depth)?;
        let bearing = rayc_material { struct_size, stiffness, damping_time, friction, depth_cap };
        write_options(struct_size, material, "material", bearing)
    })
}
