use super::rayc_contact_system;
use crate::capi::base::rayc_status;
use crate::capi::ffi::{
    Failure, Options, Output, changing, growing, guard, read_options, reading, reference, slice, with_precision,
    write_options,
};
use crate::capi::scene::rayc_scene;
use crate::math::Scalar;
use crate::scene::Scene;
use crate::system::{Carriers, ContactSystem, Material, Motion, SystemError};

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
    guard(|| {
        let mut system = changing(system, "system")?;
        let masses = slice(masses, count, "masses")?;
        with_precision!(&mut system.system, |system| Ok(system.set_node_masses(masses)?))
    })
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
    /// no cap. In a step that looks ahead, bodies that start deep part no faster than by the cap over the damping time. By as
    /// much as bodies come nearer within the step they are pushed back in full.
    pub depth_cap: f64,
    /// How fast two bodies that meet part again, over the speed with which they met; from 0 to 1. Above 0, an impact of
    /// bodies that are not deformable is over in one step of implicit Euler, however soft and damped their surfaces are;
    /// what closes faster than by what free motion adds in two steps is an impact. At 0 the surfaces stop what meets, and
    /// give back what damping and the length of the steps leave. A deformable body bounces by its own elasticity and takes
    /// no restitution, and neither does an explicit step; the midpoint rule wants 0.
    pub restitution: f64,
}

growing!(rayc_material, depth_cap: f64);

impl Options for rayc_material {
    /// Only the restitution counts: callers give the other fields.
    fn defaults() -> Self {
        let (damping_time, friction, depth_cap) = (0.05, 0.5, f64::INFINITY);
        Self { struct_size: size_of::<Self>(), stiffness: 0.0, damping_time, friction, depth_cap, restitution: 0.0 }
    }
}

impl rayc_material {
    /// # Safety
    /// `material` is NULL or points to as many readable bytes as it says.
    pub(super) unsafe fn read(material: *const Self) -> Result<Material, Failure> {
        reference(material.cast::<usize>(), "material")?;
        let Self { stiffness, damping_time, friction, depth_cap, restitution, .. } = read_options(material)?;
        Ok(Material { stiffness, damping_time, friction, depth_cap, restitution })
    }

    fn of(material: Material, struct_size: usize) -> Self {
        let Material { stiffness, damping_time, friction, depth_cap, restitution } = material;
        Self { struct_size, stiffness, damping_time, friction, depth_cap, restitution }
    }
}

/// Fills `material` with one that bears `pressure` (Pa) at `depth` (m), and asks for no more in one step: the stiffness is
/// pressure / depth, the cap is depth, damping time 0.05 s, friction 0.5, restitution 0. struct_size: sizeof(rayc_material).
///
/// For an elastic body there is rayc_elastic_material(). For a rigid or still one, take some ten times the pressure that it
/// bears at rest (weight over the area that carries it), and ten times the depth to which bodies may sink in.
///
/// Two bodies' materials combine so: the surfaces are springs in series, so the softer decides; damping times are weighted
/// by how much of the depth each surface takes; friction is the geometric mean; the smaller cap and the larger restitution
/// hold. rayc_contact_system_set_pair_material() overrides it.
///
/// Errors: RAYC_STATUS_INVALID_MATERIAL where a number is not finite and > 0, RAYC_STATUS_INVALID_STRUCT_SIZE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_bearing_material(
    pressure: f64,
    depth: f64,
    struct_size: usize,
    material: *mut rayc_material,
) -> rayc_status {
    guard(|| {
        let bearing = rayc_material::of(Material::bearing(pressure, depth)?, struct_size);
        write_options(struct_size, material, "material", bearing)
    })
}

/// Fills `material` with that of an elastic body, by its Young's modulus (Pa), Poisson's ratio and the edge (m) of its elements.
/// It bears the larger of its Young's and its bulk modulus at a fortieth of an edge, and the cap is a twentieth of an edge;
/// the rest is as rayc_bearing_material() has it. struct_size: sizeof(rayc_material).
///
/// Errors: RAYC_STATUS_INVALID_MATERIAL where modulus or edge is not finite and > 0 or the ratio not between -1 and 0.5,
/// RAYC_STATUS_INVALID_STRUCT_SIZE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_elastic_material(
    youngs_modulus: f64,
    poissons_ratio: f64,
    element_edge: f64,
    struct_size: usize,
    material: *mut rayc_material,
) -> rayc_status {
    guard(|| {
        let elastic = Material::elastic(youngs_modulus, poissons_ratio, element_edge)?;
        write_options(struct_size, material, "material", rayc_material::of(elastic, struct_size))
    })
}

/// Adds a deformable body: number `body` of the scene, with the host's nodes first_node … first_node + node_count − 1.
///
/// offsets, nodes, weights: how these carry the surface. Surface vertex v is the sum of `weights[e]` · node `nodes[e]` over e
/// from `offsets[v]` up to `offsets[v + 1]`: a skin in a cage of tetrahedra or trilinear cells, any linear mapping. Nodes count
/// from the body's first; the weights of a vertex sum to 1. offsets has one more number than the mesh has vertices, nodes and
/// weights have entry_count. All three NULL: surface vertex v is the body's node v.
///
/// Within a step only ghosts may be added, of this kind or another (rayc_contact_system_look_again()).
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
            Carriers::Weights {
                offsets: slice(offsets, vertices + 1, "offsets")?,
                nodes: slice(nodes, entries, "nodes")?,
                weights: slice(weights, entries, "weights")?,
            }
        };
        Ok(system.add_deformable(scene, body, own, carriers, material)?)
    }
    guard(|| {
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
    guard(|| {
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
    guard(|| {
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
    guard(|| {
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
    guard(|| with_precision!(&mut changing(system, "system")?.system, |system| Ok(system.remove(body)?)))
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
    guard(|| {
        let mut system = changing(system, "system")?;
        let material = if material.is_null() { None } else { Some(rayc_material::read(material)?) };
        with_precision!(&mut system.system, |system| Ok(system.set_pair_material(a, b, material)?))
    })
}

/// Gives a body and a half-space a material of their own in place of the combined one. half_space: their number, in the order
/// they were added, from 0. material: NULL takes it back.
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY, RAYC_STATUS_WRONG_COUNT where there is no such half-space, RAYC_STATUS_INVALID_MATERIAL,
/// RAYC_STATUS_OUT_OF_ORDER within a step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_set_half_space_material(
    system: *mut rayc_contact_system,
    body: u32,
    half_space: u32,
    material: *const rayc_material,
) -> rayc_status {
    guard(|| {
        let mut system = changing(system, "system")?;
        let material = if material.is_null() { None } else { Some(rayc_material::read(material)?) };
        with_precision!(&mut system.system, |system| Ok(system.set_half_space_material(body, half_space, material)?))
    })
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
    guard(|| {
        let mut system = changing(system, "system")?;
        let rayc_motion { position, rotation, velocity, free_velocity } = *reference(motion, "motion")?;
        let motion = Motion { position, rotation, velocity, free_velocity };
        with_precision!(&mut system.system, |system| Ok(system.set_motion(body, &motion)?))
    })
}

/// Says what joints add to a rigid body's mass and inertia: 6 × 6 numbers, symmetric, by which linear and angular velocity
/// in the body's own coordinates give momentum. For a robot's link it is the articulated inertia at its centre of mass, less
/// its own. It stays until the next call, and explicit steps take no notice of it. added: NULL for nothing.
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY where it is no rigid body, RAYC_STATUS_NOT_FINITE, RAYC_STATUS_INVALID_INERTIA where the
/// matrix is not symmetric or its sum with the body's own is not positive definite, RAYC_STATUS_OUT_OF_ORDER within a step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_set_added_inertia(
    system: *mut rayc_contact_system,
    body: u32,
    added: *const f64,
) -> rayc_status {
    guard(|| {
        let mut system = changing(system, "system")?;
        let given = if added.is_null() { &[0.0; 36] } else { slice(added, 36, "added")? };
        let added = std::array::from_fn(|row| std::array::from_fn(|column| given[6 * row + column]));
        with_precision!(&mut system.system, |system| Ok(system.set_added_inertia(body, added)?))
    })
}

/// How many numbers a vector of unknowns has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_unknown_count(
    system: *const rayc_contact_system,
    count: *mut usize,
) -> rayc_status {
    guard(|| {
        let system = reading(system, "system")?;
        Output::new(count, "count")?.write(with_precision!(&system.system, |system| system.unknown_count()))
    })
}
