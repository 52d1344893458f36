use super::contact_system_options::{rayc_contact_system_options, rayc_material, rayc_motion};
use super::failure::{Failure, rayc_status};
use super::guard::{guard, guard_end};
use super::handles::{Handle, HandleKind, changing, give, reading, take_back};
use super::pointers::{Output, reference, slice};
use super::precision::{InPrecision, with_precision};
use super::scene::rayc_scene;
use super::sized_structs::read_options;
use super::vectors::{rayc_scalar, scalar_from};
use crate::math::Scalar;
use crate::scene::Scene;
use crate::system::{Carriers, ContactSystem, Material, Motion, SystemError};

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
/// Numbers are doubles in SI units, whatever the precision. Vectors of unknowns hold x, y, z of each node, then, where
/// rigid bodies are kept, six numbers of each in the order they were added: linear and angular velocity, or force and torque.
/// Numbers given are at most 2^80 (1.2e24) in size, so that forces and energies stay finite; others are refused with
/// RAYC_STATUS_INVALID_OPTION or, where they have one, with a status of their own.
///
/// Threads: one call at a time for one system. The caller frees it with rayc_contact_system_destroy().
pub struct rayc_contact_system {
    pub(super) system: AnySystem,
}

impl Handle for rayc_contact_system {
    const KIND: HandleKind = HandleKind::ContactSystem;
}

/// A system of either precision.
pub(super) type AnySystem = InPrecision<ContactSystem<f32>, ContactSystem<f64>>;

/// Makes a system without bodies. options: NULL for the defaults. *system: the new handle.
///
/// Errors: RAYC_STATUS_INVALID_STRUCT_SIZE, RAYC_STATUS_UNKNOWN_ENUM, RAYC_STATUS_INVALID_OPTION.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_create(
    options: *const rayc_contact_system_options,
    system: *mut *mut rayc_contact_system,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let options = read_options(options)?;
        let place = Output::new(system, "system")?;
        let system = match scalar_from(options.precision, "precision")? {
            rayc_scalar::RAYC_SCALAR_F32 => AnySystem::F32(options.system()?),
            rayc_scalar::RAYC_SCALAR_F64 => AnySystem::F64(options.system()?),
        };
        give(place, rayc_contact_system { system });
        Ok(())
    })
}

/// Frees a system; NULL does nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_destroy(system: *mut rayc_contact_system) -> rayc_status {
    // SAFETY: the handle is the caller's, and is not used again.
    guard_end(|| unsafe { take_back(system, "system") })
}

/// Sets how many nodes the host has, and their masses in kg: > 0, or infinity for a node that is held fast. Call it
/// before adding bodies that have these nodes. Within a step there may be more than before, for ghosts that join it; the
/// nodes of all other bodies keep their masses.
///
/// Errors: RAYC_STATUS_INVALID_MASS, RAYC_STATUS_OUT_OF_ORDER within a step, RAYC_STATUS_WRONG_COUNT where a body's nodes
/// lie beyond.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_set_node_masses(
    system: *mut rayc_contact_system,
    count: usize,
    masses: *const f64,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let mut system = changing(system, "system")?;
        let masses = slice(masses, count, "masses")?;
        with_precision!(&mut system.system, |system| Ok(system.set_node_masses(masses)?))
    })
}

/// Adds a deformable body: number `body` of the scene, with the host's nodes first_node … first_node + node_count − 1.
///
/// offsets, nodes, weights: how these carry the surface. Surface vertex v is the sum of `weights[e]` · node `nodes[e]` over e
/// from `offsets[v]` up to `offsets[v + 1]`: a skin in a cage of tetrahedra or trilinear cells, any linear mapping. Nodes count
/// from the body's first; the weights of a vertex sum to 1. offsets has one more number than the mesh has vertices, nodes and
/// weights have entry_count. All three NULL: surface vertex v is the body's node v.
///
/// Within a step only ghosts may be added, of this kind or another (rayc_contact_system_off_course()).
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY where the scene has no such body, RAYC_STATUS_BODY_TWICE, RAYC_STATUS_WRONG_COUNT,
/// RAYC_STATUS_INVALID_WEIGHTS where weights do not sum to 1 or the table does not fit together, RAYC_STATUS_NOT_FINITE,
/// RAYC_STATUS_INVALID_MATERIAL, RAYC_STATUS_OUT_OF_ORDER within a step, RAYC_STATUS_PRECISION_MISMATCH.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_add_deformable(
    system: *mut rayc_contact_system,
    scene: *const rayc_scene,
    body: u32,
    first_node: u32,
    node_count: u32,
    offsets: *const u32,
    entry_count: usize,
    nodes: *const u32,
    weights: *const f64,
    material: *const rayc_material,
) -> rayc_status {
    /// # Safety
    /// As the call around it says.
    unsafe fn add<T: Scalar>(
        system: &mut ContactSystem<T>,
        scene: &Scene<T>,
        body: u32,
        own: std::ops::Range<u32>,
        table: (*const u32, usize, *const u32, *const f64),
        material: Material,
    ) -> Result<(), Failure> {
        let (offsets, entries, nodes, weights) = table;
        let vertices = scene.mesh(body).map_err(|_| SystemError::NotInScene { body })?.topology().vertex_count();
        let carriers = if offsets.is_null() && nodes.is_null() && weights.is_null() {
            Carriers::Nodes
        } else {
            // SAFETY: by this function's contract.
            unsafe {
                Carriers::Weights {
                    offsets: slice(offsets, vertices + 1, "offsets")?,
                    nodes: slice(nodes, entries, "nodes")?,
                    weights: slice(weights, entries, "weights")?,
                }
            }
        };
        Ok(system.add_deformable(scene, body, own, carriers, material)?)
    }
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let mut system = changing(system, "system")?;
        let scene = reading(scene, "scene")?;
        let material = rayc_material::read(material)?;
        let own = first_node..first_node.saturating_add(node_count);
        let table = (offsets, entry_count, nodes, weights);
        with_precision!(&mut system.system, &scene.scene, |system, scene| add(
            system, scene, body, own, table, material
        ))
    })
}

/// Adds a rigid body: number `body` of the scene, whose mesh was created in the body's own coordinates, with the centre of
/// mass at the origin. mass in kg; inertia: nine numbers, kg m² about that point in those coordinates. It is at the origin
/// until rayc_contact_system_set_motion().
///
/// Errors: RAYC_STATUS_INVALID_MASS, RAYC_STATUS_INVALID_INERTIA where the matrix is not symmetric and positive definite,
/// RAYC_STATUS_UNKNOWN_BODY where the scene has no such body, RAYC_STATUS_BODY_TWICE, RAYC_STATUS_INVALID_MATERIAL,
/// RAYC_STATUS_OUT_OF_ORDER within a step, RAYC_STATUS_PRECISION_MISMATCH.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_add_rigid(
    system: *mut rayc_contact_system,
    scene: *const rayc_scene,
    body: u32,
    mass: f64,
    inertia: *const f64,
    material: *const rayc_material,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let mut system = changing(system, "system")?;
        let scene = reading(scene, "scene")?;
        let given = slice(inertia, 9, "inertia")?;
        let inertia = std::array::from_fn(|row| std::array::from_fn(|column| given[3 * row + column]));
        let material = rayc_material::read(material)?;
        with_precision!(&mut system.system, &scene.scene, |system, scene| {
            Ok(system.add_rigid(scene, body, mass, inertia, material)?)
        })
    })
}

/// Adds a body that stands still or that the host moves: number `body` of the scene, whose mesh was created in the
/// body's own coordinates. Until rayc_contact_system_set_motion() it is where its own coordinates say.
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY where the scene has no such body, RAYC_STATUS_BODY_TWICE, RAYC_STATUS_INVALID_MATERIAL,
/// RAYC_STATUS_OUT_OF_ORDER within a step, RAYC_STATUS_PRECISION_MISMATCH.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_add_moved(
    system: *mut rayc_contact_system,
    scene: *const rayc_scene,
    body: u32,
    material: *const rayc_material,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let mut system = changing(system, "system")?;
        let scene = reading(scene, "scene")?;
        let material = rayc_material::read(material)?;
        with_precision!(&mut system.system, &scene.scene, |system, scene| Ok(system.add_moved(scene, body, material)?))
    })
}

/// Adds a half-space, solid where normal · x < offset, for all bodies with unknowns. normal: three numbers, a unit vector.
/// The surface vertices of bodies below the plane bear its pressure.
///
/// Errors: RAYC_STATUS_INVALID_DIRECTION where the normal is no unit vector, RAYC_STATUS_NOT_FINITE,
/// RAYC_STATUS_INVALID_MATERIAL, RAYC_STATUS_OUT_OF_ORDER within a step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_add_half_space(
    system: *mut rayc_contact_system,
    normal: *const f64,
    offset: f64,
    material: *const rayc_material,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let mut system = changing(system, "system")?;
        let given = slice(normal, 3, "normal")?;
        let material = rayc_material::read(material)?;
        let normal = std::array::from_fn(|axis| given[axis]);
        with_precision!(&mut system.system, |system| system.add_half_space(normal, offset, material)?);
        Ok(())
    })
}

/// Removes a body from the system. Remove it from the scene too. Rigid bodies added after it move up by one place.
/// Removing a rigid body also discards the velocities of the last step.
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY, RAYC_STATUS_OUT_OF_ORDER within a step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_remove_body(system: *mut rayc_contact_system, body: u32) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe { with_precision!(&mut changing(system, "system")?.system, |system| Ok(system.remove(body)?)) })
}

/// Gives two bodies, or a body with itself, a material of their own instead of the combined one. material: NULL
/// restores the combined one.
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY, RAYC_STATUS_INVALID_MATERIAL, RAYC_STATUS_OUT_OF_ORDER within a step, unless one of the
/// bodies is a ghost that has joined it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_set_pair_material(
    system: *mut rayc_contact_system,
    a: u32,
    b: u32,
    material: *const rayc_material,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let mut system = changing(system, "system")?;
        let material = if material.is_null() { None } else { Some(rayc_material::read(material)?) };
        with_precision!(&mut system.system, |system| Ok(system.set_pair_material(a, b, material)?))
    })
}

/// Sets where a rigid or moved body is, and how it moves. Call it before each step, and within one for a ghost that has
/// joined it.
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY also for a deformable body, RAYC_STATUS_NOT_FINITE, RAYC_STATUS_INVALID_DIRECTION where
/// the rotation is no rotation matrix, RAYC_STATUS_OUT_OF_ORDER within a step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_set_motion(
    system: *mut rayc_contact_system,
    body: u32,
    motion: *const rayc_motion,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let mut system = changing(system, "system")?;
        let rayc_motion { position, rotation, velocity, free_velocity } = *reference(motion, "motion")?;
        let motion = Motion { position, rotation, velocity, free_velocity };
        with_precision!(&mut system.system, |system| Ok(system.set_motion(body, &motion)?))
    })
}

/// How many numbers a vector of unknowns has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_unknown_count(
    system: *const rayc_contact_system,
    count: *mut usize,
) -> rayc_status {
    // SAFETY: the pointers are the caller's, as documented.
    guard(|| unsafe {
        let system = reading(system, "system")?;
        Output::new(count, "count")?.write(with_precision!(&system.system, |system| system.unknown_count()));
        Ok(())
    })
}
