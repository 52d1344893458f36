use super::number::Number;
use super::rayc_contact_system;
use crate::capi::base::rayc_status;
use crate::capi::contacts::rayc_contacts;
use crate::capi::ffi::{Failure, Output, apart, changing, check_apart, flag, guard, reading, slice, with_precision};
use crate::capi::scene::rayc_scene;
use crate::contact::ContactList;
use crate::math::Scalar;
use crate::system::Surface;

/// Begins a step of dt seconds. count: three times the number of nodes; positions: x, y, z of each at the start, in
/// m; velocities: at the start, in m/s; free_velocities: the velocities at the end if nothing touched the nodes. The
/// call puts the scene's bodies where they would then be, finds their contacts, and makes rows of them. It calls
/// rayc_scene_advance(), so pairs that contacts cannot part escape as described there.
///
/// Errors: RAYC_STATUS_OUT_OF_ORDER where a step is under way, RAYC_STATUS_INVALID_STEP where dt is not finite and > 0,
/// RAYC_STATUS_WRONG_COUNT, RAYC_STATUS_NOT_FINITE with a message that names the number, RAYC_STATUS_UNKNOWN_BODY where the
/// scene and the system have not the same bodies, RAYC_STATUS_PRECISION_MISMATCH; RAYC_STATUS_TOO_STIFF: the step is then
/// cancelled, as by rayc_contact_system_cancel().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_begin(
    system: *mut rayc_contact_system,
    scene: *mut rayc_scene,
    dt: f64,
    count: usize,
    positions: *const f64,
    velocities: *const f64,
    free_velocities: *const f64,
) -> rayc_status {
    guard(|| begin(system, scene, dt, count, [positions, velocities, free_velocities]))
}

/// Adds the contact forces on the unknowns to `forces`, in N and N m. `velocities` are those at the end of the step.
/// The rows are held, so the forces are linear in the velocities. count: the number of unknowns. The two arrays must
/// not overlap.
///
/// Errors: RAYC_STATUS_OUT_OF_ORDER without a step, RAYC_STATUS_WRONG_COUNT, RAYC_STATUS_NOT_FINITE,
/// RAYC_STATUS_INVALID_OPTION where the arrays overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_add_forces(
    system: *mut rayc_contact_system,
    count: usize,
    velocities: *const f64,
    forces: *mut f64,
) -> rayc_status {
    guard(|| add_forces(system, count, velocities, forces))
}

/// Adds factor · (−∂force/∂velocity) · change to `result`, as the rows are held: a product with a symmetric, positive
/// semi-definite matrix, what an implicit solver asks once per iteration. A step that solves for velocities, with the
/// matrix M + dt · (−∂force/∂velocity), gives dt as factor. By displacements the derivative is 1 / dt times as large.
/// count: that of the unknowns. The two arrays must not overlap.
///
/// Errors: RAYC_STATUS_OUT_OF_ORDER without a step, RAYC_STATUS_WRONG_COUNT, RAYC_STATUS_NOT_FINITE,
/// RAYC_STATUS_INVALID_OPTION where the arrays overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_add_product(
    system: *mut rayc_contact_system,
    factor: f64,
    count: usize,
    change: *const f64,
    result: *mut f64,
) -> rayc_status {
    guard(|| add_product(system, factor, count, change, result))
}

/// Writes the number that a method of the system gives for velocities.
macro_rules! number_at {
    ($system:ident, $velocities:ident, $count:ident, $method:ident, $place:ident) => {{
        let rayc_contact_system { system, room: [room, ..], .. } = &mut *changing($system, "system")?;
        let velocities = Number::read(slice($velocities, $count, "velocities")?, room);
        let place = Output::new($place, stringify!($place))?;
        place.write(with_precision!(system, |system| system.$method(velocities)?))
    }};
}
pub(super) use number_at;

/// The potential of the rows, as they are held, in J: the forces are its negative gradient by the positions at the end of the
/// step, velocity times dt. For line searches. count: that of the unknowns.
///
/// Errors: RAYC_STATUS_OUT_OF_ORDER without a step, RAYC_STATUS_WRONG_COUNT, RAYC_STATUS_NOT_FINITE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_energy(
    system: *mut rayc_contact_system,
    count: usize,
    velocities: *const f64,
    joules: *mut f64,
) -> rayc_status {
    guard(|| number_at!(system, velocities, count, energy, joules))
}

/// The energy in J that bodies store in contacts after `part` of the step, 0 to 1, at these velocities: the integral of the
/// pressure over what they share, up to the depth caps. Contacts are looked for there; damping and friction have no part in it.
/// So a host can tell whether a step gains energy. The step goes on, but the scene's bodies have moved. count: of unknowns.
///
/// Errors: RAYC_STATUS_OUT_OF_ORDER without a step, RAYC_STATUS_WRONG_COUNT, RAYC_STATUS_NOT_FINITE,
/// RAYC_STATUS_INVALID_OPTION where part is not within 0 and 1, RAYC_STATUS_UNKNOWN_BODY, RAYC_STATUS_PRECISION_MISMATCH,
/// RAYC_STATUS_MESH_BEYOND_RANGE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_potential(
    system: *mut rayc_contact_system,
    scene: *mut rayc_scene,
    count: usize,
    velocities: *const f64,
    part: f64,
    joules: *mut f64,
) -> rayc_status {
    guard(|| {
        let (mut system, mut scene) = (changing(system, "system")?, changing(scene, "scene")?);
        let (velocities, place) = (slice(velocities, count, "velocities")?, Output::new(joules, "joules")?);
        place.write(with_precision!(&mut system.system, &mut scene.scene, |system, scene| {
            system.potential(scene, velocities, part)?
        }))
    })
}

/// Holds the rows anew at these velocities: this decides which rows push and how much they rub. Call it after a
/// solve. *wrong: the part of all force, 0 to 1, that had been predicted wrongly. If it is above about 0.05, solve
/// again. Eliminated rigid bodies answer by the rows as they are held: of what these exchange with nodes that part of the
/// momentum is kept only where a step ends right after a solve.
///
/// Errors: RAYC_STATUS_OUT_OF_ORDER without a step, RAYC_STATUS_WRONG_COUNT, RAYC_STATUS_NOT_FINITE; RAYC_STATUS_TOO_STIFF:
/// the step is then cancelled, as by rayc_contact_system_cancel(), and can begin again with a softer material or a shorter
/// length.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_linearise(
    system: *mut rayc_contact_system,
    count: usize,
    velocities: *const f64,
    wrong: *mut f64,
) -> rayc_status {
    guard(|| number_at!(system, velocities, count, linearise, wrong))
}

/// Finds what rayc_contact_system_linearise() would write to *wrong, and leaves the rows as they are: the part of all
/// force, 0 to 1, that was predicted wrongly. So a host whose last solve was right keeps the forces that it solved
/// with.
///
/// Errors: RAYC_STATUS_OUT_OF_ORDER without a step, RAYC_STATUS_WRONG_COUNT, RAYC_STATUS_NOT_FINITE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_misjudged(
    system: *mut rayc_contact_system,
    count: usize,
    velocities: *const f64,
    wrong: *mut f64,
) -> rayc_status {
    guard(|| number_at!(system, velocities, count, misjudged, wrong))
}

/// Looks for contacts where the bodies end up with these velocities. Call it after a solve: a body that is stopped may
/// be in the way of another one, although detection took it to be moving on. *is_more: 1 where pairs have contacts that
/// had none, or rows of less than half the area; then solve again. It looks only if some node or rigid body ends farther than
/// the smallest depth cap from where it was when contacts were last looked for.
///
/// Errors: RAYC_STATUS_OUT_OF_ORDER without a step, RAYC_STATUS_WRONG_COUNT, RAYC_STATUS_NOT_FINITE,
/// RAYC_STATUS_UNKNOWN_BODY, RAYC_STATUS_PRECISION_MISMATCH; RAYC_STATUS_TOO_STIFF: the step is then cancelled, as by
/// rayc_contact_system_cancel(), and can begin again with a softer material or a shorter length. RAYC_STATUS_OUT_OF_MEMORY
/// while it looks cancels the step too.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_detect_again(
    system: *mut rayc_contact_system,
    scene: *mut rayc_scene,
    count: usize,
    velocities: *const f64,
    is_more: *mut u32,
) -> rayc_status {
    guard(|| detect_again(system, scene, count, velocities, is_more))
}

/// Finds how far the scene's bodies, without ghosts, end from where they were when contacts were last looked for, if
/// these are the velocities at the end of the step. *nodes and *rigid: the largest square of a difference of velocities
/// in m²/s², of nodes and of rigid bodies' centres. rayc_contact_system_detect_again() looks again where one is more
/// than (d / dt)², d the smallest depth cap of all bodies; that of nodes counts where any node has a finite mass.
///
/// Errors: RAYC_STATUS_OUT_OF_ORDER without a step, RAYC_STATUS_WRONG_COUNT, RAYC_STATUS_NOT_FINITE,
/// RAYC_STATUS_PRECISION_MISMATCH.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_off_course(
    system: *mut rayc_contact_system,
    scene: *const rayc_scene,
    count: usize,
    velocities: *const f64,
    nodes: *mut f64,
    rigid: *mut f64,
) -> rayc_status {
    guard(|| {
        let (mut system, scene) = (changing(system, "system")?, reading(scene, "scene")?);
        let velocities = slice(velocities, count, "velocities")?;
        let places = [Output::new(nodes, "nodes")?, Output::new(rigid, "rigid")?];
        let squares = with_precision!(&mut system.system, &scene.scene, |system, scene| {
            system.off_course(scene, velocities)?
        });
        places.into_iter().zip(squares).try_for_each(|(place, square)| place.write(square))
    })
}

/// Ends a step, given its velocities at the end. The loads, and what friction holds on to, are remembered for the
/// next step.
///
/// Errors: RAYC_STATUS_OUT_OF_ORDER without a step; RAYC_STATUS_WRONG_COUNT, RAYC_STATUS_NOT_FINITE: the step is then still
/// under way.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_finish(
    system: *mut rayc_contact_system,
    count: usize,
    velocities: *const f64,
) -> rayc_status {
    guard(|| finish(system, count, velocities))
}

/// Cancels a step: all is as if it had not begun, except for the positions of the scene's bodies, and that pairs which escape
/// count the step (rayc_scene_advance()). Does nothing where no step is under way.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_cancel(system: *mut rayc_contact_system) -> rayc_status {
    guard(|| {
        with_precision!(&mut changing(system, "system")?.system, |system| system.cancel());
        Ok(())
    })
}

/// Copies the linear and angular velocity of a rigid body at the end of the last finished step to `velocity`, six numbers;
/// after rayc_contact_system_potential(), at the end of the step under way as it answers to those velocities.
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY where it is not rigid, or was added since.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_rigid_velocity(
    system: *const rayc_contact_system,
    body: u32,
    velocity: *mut f64,
) -> rayc_status {
    guard(|| {
        let system = reading(system, "system")?;
        let place = Output::array(velocity, 6, "velocity")?;
        place.write_all(with_precision!(&system.system, |system| system.rigid_velocity(body)?).into_iter())
    })
}

/// A whole step for a host that integrates explicitly: adds to `forces` the contact forces on its unknowns at these positions
/// and velocities. *longest_step: the longest step, in s, for which they are stable where velocities go first and positions
/// follow them (symplectic Euler); infinity without contact. The host's own forces may need a shorter one.
///
/// dt: the step that the host takes. count: three times the number of nodes; unknown_count: that of the unknowns. Rigid
/// bodies have to be kept; they move as rayc_contact_system_set_motion() says.
///
/// Errors: those of rayc_contact_system_begin(), and RAYC_STATUS_RIGID_ELIMINATED.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_explicit_step(
    system: *mut rayc_contact_system,
    scene: *mut rayc_scene,
    dt: f64,
    count: usize,
    positions: *const f64,
    velocities: *const f64,
    unknown_count: usize,
    forces: *mut f64,
    longest_step: *mut f64,
) -> rayc_status {
    guard(|| explicit_step(system, scene, dt, (count, positions, velocities), (unknown_count, forces), longest_step))
}

/// Copies the contacts of the last detection, with its statistics: positions are where bodies were looked for. Replaces what
/// `contacts` held.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_copy_contacts(
    system: *const rayc_contact_system,
    contacts: *mut rayc_contacts,
) -> rayc_status {
    fn copy<T: Scalar>(from: &ContactList<T>, to: &mut ContactList<T>) {
        if from.pushes().is_empty() && to.pushes().is_empty() {
            // What detection works with is left out.
            to.contacts.clone_from(&from.contacts);
            to.statistics = from.statistics;
        } else {
            to.clone_from(from);
        }
    }
    guard(|| {
        let system = reading(system, "system")?;
        let mut contacts = changing(contacts, "contacts")?;
        with_precision!(&system.system, |system| copy(system.contacts(), contacts.list.as_mut()));
        Ok(())
    })
}

/// The net force with which `other` acted on a body in the last finished step: three numbers, in N; zero for a body and itself.
/// other: a body, or where is_half_space is 1 the number of a half-space.
///
/// Errors: RAYC_STATUS_UNKNOWN_BODY, RAYC_STATUS_WRONG_COUNT where there is no such half-space, RAYC_STATUS_INVALID_OPTION
/// where is_half_space is neither 0 nor 1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contact_system_pair_force(
    system: *const rayc_contact_system,
    body: u32,
    other: u32,
    is_half_space: u32,
    force: *mut f64,
) -> rayc_status {
    guard(|| {
        let system = reading(system, "system")?;
        let place = Output::array(force, 3, "force")?;
        let is_half_space = flag("is_half_space", is_half_space)?;
        let other = if is_half_space { Surface::HalfSpace(other) } else { Surface::Body(other) };
        let found = with_precision!(&system.system, |system| system.pair_force(body, other)?);
        place.write_all(found.into_iter())
    })
}

/// rayc_contact_system_begin() with numbers of either type, as the functions below.
///
/// # Safety
/// That of the function, as for those below.
pub(super) unsafe fn begin<N: Number>(
    system: *mut rayc_contact_system,
    scene: *mut rayc_scene,
    dt: f64,
    count: usize,
    given: [*const N; 3],
) -> Result<(), Failure> {
    let (mut system, mut scene) = (changing(system, "system")?, changing(scene, "scene")?);
    let rayc_contact_system { system, room: [first, second, third], .. } = &mut *system;
    let positions = N::read(slice(given[0], count, "positions")?, first);
    let velocities = N::read(slice(given[1], count, "velocities")?, second);
    let free = N::read(slice(given[2], count, "free_velocities")?, third);
    with_precision!(system, &mut scene.scene, |system, scene| {
        Ok(system.begin(scene, dt, positions, velocities, free)?)
    })
}

pub(super) unsafe fn add_forces<N: Number>(
    system: *mut rayc_contact_system,
    count: usize,
    velocities: *const N,
    forces: *mut N,
) -> Result<(), Failure> {
    let mut system = changing(system, "system")?;
    let (velocities, forces) = apart((velocities, count, "velocities"), (forces, count, "forces"))?;
    let rayc_contact_system { system, room: [first, second, _], .. } = &mut *system;
    let velocities = N::read(velocities, first);
    N::add(forces, second, |forces| with_precision!(system, |system| Ok(system.add_forces(velocities, forces)?)))
}

pub(super) unsafe fn add_product<N: Number>(
    system: *mut rayc_contact_system,
    factor: f64,
    count: usize,
    change: *const N,
    result: *mut N,
) -> Result<(), Failure> {
    let mut system = changing(system, "system")?;
    let (change, result) = apart((change, count, "change"), (result, count, "result"))?;
    let rayc_contact_system { system, room: [first, second, _], .. } = &mut *system;
    let change = N::read(change, first);
    N::add(result, second, |result| with_precision!(system, |system| Ok(system.add_product(factor, change, result)?)))
}

pub(super) unsafe fn detect_again<N: Number>(
    system: *mut rayc_contact_system,
    scene: *mut rayc_scene,
    count: usize,
    velocities: *const N,
    is_more: *mut u32,
) -> Result<(), Failure> {
    let (mut system, mut scene) = (changing(system, "system")?, changing(scene, "scene")?);
    let rayc_contact_system { system, room: [room, ..], .. } = &mut *system;
    let velocities = N::read(slice(velocities, count, "velocities")?, room);
    let place = Output::new(is_more, "is_more")?;
    place.write(with_precision!(system, &mut scene.scene, |system, scene| {
        u32::from(system.detect_again(scene, velocities)?)
    }))
}

pub(super) unsafe fn finish<N: Number>(
    system: *mut rayc_contact_system,
    count: usize,
    velocities: *const N,
) -> Result<(), Failure> {
    let rayc_contact_system { system, room: [room, ..], .. } = &mut *changing(system, "system")?;
    let velocities = N::read(slice(velocities, count, "velocities")?, room);
    with_precision!(system, |system| Ok(system.finish(velocities)?))
}

pub(super) unsafe fn explicit_step<N: Number>(
    system: *mut rayc_contact_system,
    scene: *mut rayc_scene,
    dt: f64,
    (count, positions, velocities): (usize, *const N, *const N),
    (unknown_count, forces): (usize, *mut N),
    longest_step: *mut f64,
) -> Result<(), Failure> {
    let (mut system, mut scene) = (changing(system, "system")?, changing(scene, "scene")?);
    let place = Output::new(longest_step, "longest_step")?;
    check_apart(positions, count, forces, unknown_count)?;
    let rayc_contact_system { system, room: [first, second, third], .. } = &mut *system;
    let positions = N::read(slice(positions, count, "positions")?, first);
    let (velocities, forces) = apart((velocities, count, "velocities"), (forces, unknown_count, "forces"))?;
    let velocities = N::read(velocities, second);
    N::add(forces, third, |forces| {
        place.write(with_precision!(system, &mut scene.scene, |system, scene| {
            system.explicit_step(scene, dt, positions, velocities, forces)?
        }))
    })
}
