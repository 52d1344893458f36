use super::{AnyContacts, rayc_contacts};
use crate::capi::base::{rayc_status, rayc_vectors, rayc_vectors_mut};
use crate::capi::ffi::{
    Arrays, BodyArray, BodyArraysMut, Failure, Options, Output, apart, beyond_range, changing, check_apart,
    check_numbers, check_reserved, growing, guard, read_options, reading, slice, unknown_enum, with_precision,
    write_defaults,
};
use crate::capi::scene::rayc_scene;
use crate::contact::{Contact, ContactList};
use crate::force::{PenaltyLaw, RigidMotion, Weighting, add_differential, add_forces, add_wrenches, energy};
use crate::math::{Scalar, Vector3};
use crate::memory::text;
use crate::scene::Scene;

/// What a contact's stiffness is multiplied with.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum rayc_weighting {
    /// The area the ray stands for: stiffness is in N/m³, and the net force does not depend on the triangulation.
    RAYC_WEIGHTING_AREA = 1,
    /// Nothing, as in the paper: stiffness is in N/m per ray, and a finer mesh is a stiffer one.
    RAYC_WEIGHTING_VERTEX = 2,
}

impl rayc_weighting {
    pub(in crate::capi) fn read(number: u32) -> Result<Weighting, Failure> {
        match number {
            w if w == Self::RAYC_WEIGHTING_AREA as u32 => Ok(Weighting::Area),
            w if w == Self::RAYC_WEIGHTING_VERTEX as u32 => Ok(Weighting::Vertex),
            other => Err(unknown_enum("weighting", other, "rayc_weighting")),
        }
    }
}

/// How contacts push. Fill with rayc_default_response_options(), then change what you need.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_response_options {
    /// sizeof(rayc_response_options).
    pub struct_size: usize,
    /// k ≥ 0, in N/m³ with RAYC_WEIGHTING_AREA, in N/m with RAYC_WEIGHTING_VERTEX. Default 1.
    pub stiffness: f64,
    /// Damping over stiffness, in s; ≥ 0. The damping along the ray is k · damping_time. Default 0.
    pub damping_time: f64,
    /// A rayc_weighting. Default RAYC_WEIGHTING_AREA.
    pub weighting: u32,
    /// Always 0.
    pub reserved: u32,
    /// μ ≥ 0 of Coulomb friction that needs no memory, as integrators that choose their own steps want it. A contact that
    /// pushes by N rubs by μ cos α N v / √(v² + slip_speed²) against its slip v across the ray: regularised by the square
    /// root (Wriggers 2006, Computational Contact Mechanics, section 5.2). It needs velocities. Default 0.
    pub friction: f64,
    /// In m/s; above 0 where there is friction. What friction has to bear by a part p < μ of N creeps at
    /// slip_speed · p / √(μ² − p²). The smaller it is the stiffer: the damping of a contact at rest is μ cos α N / slip_speed.
    /// Default 0.
    pub slip_speed: f64,
}

growing!(rayc_response_options, reserved: u32);

impl Options for rayc_response_options {
    fn defaults() -> Self {
        let weighting = rayc_weighting::RAYC_WEIGHTING_AREA as u32;
        let struct_size = size_of::<Self>();
        let [stiffness, damping_time, friction, slip_speed] = [1.0, 0.0, 0.0, 0.0];
        Self { struct_size, stiffness, damping_time, weighting, reserved: 0, friction, slip_speed }
    }
}

impl rayc_response_options {
    pub(in crate::capi) fn law(&self) -> Result<PenaltyLaw, Failure> {
        let weighting = rayc_weighting::read(self.weighting)?;
        check_reserved("rayc_response_options", self.reserved)?;
        let law = PenaltyLaw::new(self.stiffness, self.damping_time, weighting)?;
        Ok(law.with_friction(self.friction, self.slip_speed)?)
    }
}

/// Fills `options` with the defaults. struct_size: sizeof(rayc_response_options).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_default_response_options(
    struct_size: usize,
    options: *mut rayc_response_options,
) -> rayc_status {
    guard(|| write_defaults(struct_size, options))
}

/// Adds the contact forces to `forces`, in N. Each contact gives stiffness · weight · cos α · depth along the ray at
/// p1 and the opposite at p2, spread by the barycentric weights (Hermann, Faure, Raffin 2008, section 4). A contact under
/// RAYC_LAW_PRESSURE that stands for many triangles presses on all their vertices, by area, and the opposite lies on
/// about as much of the other surface around p2. The two loads have no net force and no net torque. Friction acts in the
/// same way, each end by its own velocity, so it has no net force, but the net torque of the depth times the friction;
/// rayc_contacts_add_wrenches() has none.
///
/// options: NULL for the defaults. positions, velocities, forces: body_count arrays each, one for each body, in the
/// order of the bodies' numbers; a body without contacts may have an array of count 0. positions NULL: the positions at
/// detection. velocities NULL: no damping and no friction; damping_time and friction must then be 0. Contacts stay as they
/// were found: each keeps its two points of the surfaces and its direction, whatever the positions. Where the points have
/// moved apart, the force pulls, because an implicit integrator's linear step needs that.
///
/// Errors: RAYC_STATUS_WRONG_COUNT where a contact's body or vertex lies beyond the arrays, RAYC_STATUS_NOT_FINITE
/// where a number that a contact needs is NaN or infinite, RAYC_STATUS_MESH_BEYOND_RANGE where it is infinite only in
/// the precision of the contacts, RAYC_STATUS_INVALID_OPTION where damping_time or friction has no velocities, where a sum
/// might go beyond its largest number, or where `forces` shares memory with what is read. Numbers that no contact needs are
/// not checked.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contacts_add_forces(
    contacts: *const rayc_contacts,
    options: *const rayc_response_options,
    body_count: usize,
    positions: *const rayc_vectors,
    velocities: *const rayc_vectors,
    forces: *const rayc_vectors_mut,
) -> rayc_status {
    guard(|| {
        let list = &reading(contacts, "contacts")?.list;
        let law = read_options(options)?.law()?;
        let positions = BodyArray::if_any(positions, body_count, "positions")?;
        let velocities = velocities_for(&law, list, velocities, body_count)?;
        let forces = BodyArraysMut::all(forces, body_count, "forces")?;
        with_precision!(list, |list| add_all_forces(list, &law, positions, velocities, forces))
    })
}

/// Adds stiffness_factor · (∂force/∂position) d + damping_factor · (∂force/∂velocity) d to `forces`, in N, for the
/// displacements d (m, or m/s); both Jacobians are symmetric and negative semi-definite. What an implicit integrator asks once
/// per iteration. Friction is not in them: as it depends on the push too, its derivative is not symmetric.
///
/// options: NULL for the defaults. displacements, forces: body_count arrays each, as in rayc_contacts_add_forces().
///
/// Errors: as there, and RAYC_STATUS_INVALID_OPTION where a factor is not finite.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contacts_add_differential(
    contacts: *const rayc_contacts,
    options: *const rayc_response_options,
    stiffness_factor: f64,
    damping_factor: f64,
    body_count: usize,
    displacements: *const rayc_vectors,
    forces: *const rayc_vectors_mut,
) -> rayc_status {
    guard(|| {
        let list = &reading(contacts, "contacts")?.list;
        let law = read_options(options)?.law()?;
        let factors = finite([stiffness_factor, damping_factor])?;
        let displacements = BodyArray::all(displacements, body_count, "displacements")?;
        let forces = BodyArraysMut::all(forces, body_count, "forces")?;
        with_precision!(list, |list| add_all_differentials(list, &law, factors, displacements, forces))
    })
}

/// The same, but with contacts found anew where the displacements lead, as Newton's method needs it to converge
/// quadratically. `contacts` are those of the scene's newest query, and no body has moved since. Rays move with their
/// triangles; a push changes with the distance that it grows with, with the area and the normal of its part of the surface, and
/// where its ray ends. So this Jacobian is not symmetric: use a solver such as GMRES. Held are the samples, the vertices over
/// which patches spread loads, contacts of edges, escapes, damping and friction. With RAYC_SAMPLING_SPACING, no longer
/// than the triangles' edges, it is the derivative of the forces. By accuracy it lacks how samples come and go: tens of per cent
/// on curved bodies. It looks for nearest points again, so a call takes about as long as finding the contacts.
///
/// Errors: those of rayc_contacts_add_differential(), RAYC_STATUS_UNKNOWN_BODY, RAYC_STATUS_OCTREE_STALE where a body has moved
/// since the contacts were found, or they are of another scene, RAYC_STATUS_PRECISION_MISMATCH.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_add_differential(
    scene: *const rayc_scene,
    contacts: *const rayc_contacts,
    options: *const rayc_response_options,
    stiffness_factor: f64,
    damping_factor: f64,
    body_count: usize,
    displacements: *const rayc_vectors,
    forces: *const rayc_vectors_mut,
) -> rayc_status {
    guard(|| {
        let (scene, list) = (&reading(scene, "scene")?.scene, &reading(contacts, "contacts")?.list);
        let (law, factors) = (read_options(options)?.law()?, finite([stiffness_factor, damping_factor])?);
        let displacements = BodyArray::all(displacements, body_count, "displacements")?;
        let forces = BodyArraysMut::all(forces, body_count, "forces")?;
        with_precision!(scene, list, |scene, list| {
            add_all_whole_differentials(scene, list, &law, factors, displacements, forces)
        })
    })
}

/// Adds what the contacts of rigid bodies exert to `wrenches`: force in N, then torque in N m, six numbers for each body. The
/// law is that of rayc_contacts_add_forces() at the positions of detection, but no contact ever pulls, and all of each acts
/// at its p1: so forces, and torques about one point, add up to zero, with friction too. Damping and friction never add
/// energy. Wrenches are a function of poses and velocities alone where the scene remembers nothing: call rayc_scene_advance()
/// with 0 before the first query, and then no more. All in the world's coordinates.
///
/// options: NULL for the defaults. points: three numbers for each body, in the order of the bodies' numbers, such as its centre
/// of mass: the velocity is that of this point, and the torque is about it. velocities: six numbers for each body, linear in
/// m/s, then angular in rad/s; 0 for a body that stays where it is. What deforms counts as rigid: where one of the bodies
/// does, use rayc_contacts_add_forces() for all.
///
/// Errors: RAYC_STATUS_WRONG_COUNT where a contact's body lies beyond the arrays, RAYC_STATUS_NOT_FINITE where a number of a
/// body with contacts is NaN or infinite, RAYC_STATUS_INVALID_OPTION where a sum might go beyond the largest double, or where
/// `wrenches` shares memory with what is read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contacts_add_wrenches(
    contacts: *const rayc_contacts,
    options: *const rayc_response_options,
    body_count: usize,
    points: *const f64,
    velocities: *const f64,
    wrenches: *mut f64,
) -> rayc_status {
    guard(|| {
        let list = &reading(contacts, "contacts")?.list;
        let law = read_options(options)?.law()?;
        let [three, six] = [3, 6].map(|numbers| body_count.saturating_mul(numbers));
        check_apart(points, three, wrenches, six)?;
        let (velocities, wrenches) = apart((velocities, six, "velocities"), (wrenches, six, "wrenches"))?;
        let given = [slice(points, three, "points")?, velocities];
        with_precision!(list, |list| add_all_wrenches(list, &law, given, wrenches))
    })
}

/// The energy stored in the contacts, ½ Σ coefficient · depth², in J. positions: as in rayc_contacts_add_forces(). The
/// elastic force is its negative gradient.
///
/// Errors: RAYC_STATUS_WRONG_COUNT where a contact's body or vertex lies beyond the arrays, RAYC_STATUS_NOT_FINITE
/// where a number that a contact needs is NaN or infinite, RAYC_STATUS_MESH_BEYOND_RANGE where it is infinite only in
/// the precision of the contacts, RAYC_STATUS_INVALID_OPTION where a sum might go beyond its largest number. Numbers that no
/// contact needs are not checked.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contacts_energy(
    contacts: *const rayc_contacts,
    options: *const rayc_response_options,
    body_count: usize,
    positions: *const rayc_vectors,
    joules: *mut f64,
) -> rayc_status {
    guard(|| {
        let list = &reading(contacts, "contacts")?.list;
        let law = read_options(options)?.law()?;
        let positions = BodyArray::if_any(positions, body_count, "positions")?;
        let place = Output::new(joules, "joules")?;
        place.write(with_precision!(list, |list| all_energy(list, &law, positions)?))
    })
}

/// rayc_scene_query(), and the energy in J that bodies store where they are: the integral of the pressure over what they
/// share. Two queries differ in it by the work between. By the paper's law, with RAYC_WEIGHTING_VERTEX or rays from vertices,
/// of open sheets and of a body with itself it is the energy of held springs, as rayc_contacts_energy() gives it.
///
/// Errors: those of rayc_scene_query(), RAYC_STATUS_INVALID_OPTION.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_potential(
    scene: *mut rayc_scene,
    options: *const rayc_response_options,
    contacts: *mut rayc_contacts,
    joules: *mut f64,
) -> rayc_status {
    guard(|| {
        let (mut scene, mut contacts) = (changing(scene, "scene")?, changing(contacts, "contacts")?);
        let law = read_options(options)?.law()?;
        let (place, list) = (Output::new(joules, "joules")?, &mut contacts.list);
        place.write(with_precision!(&mut scene.scene, |scene| scene.potential(&law, list.as_mut())))
    })
}

/// Copies the spring coefficients of contacts first … first + count − 1 to `coefficients`: stiffness · weight · cos α,
/// in N/m. For hosts that carry contacts over to nodes of their own: the force on p1 is
/// coefficient · (depth + damping_time · (v2 − v1) · direction) · direction, that on p2 its opposite, before friction.
///
/// options: NULL for the defaults. Errors: RAYC_STATUS_WRONG_COUNT where the range reaches beyond the end,
/// RAYC_STATUS_INVALID_OPTION where a coefficient is beyond the largest number of the contacts' precision.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contacts_copy_coefficients(
    contacts: *const rayc_contacts,
    options: *const rayc_response_options,
    first: usize,
    count: usize,
    coefficients: *mut f64,
) -> rayc_status {
    guard(|| {
        let list = &reading(contacts, "contacts")?.list;
        let law = read_options(options)?.law()?;
        let range = list.range(first, count)?;
        let out = Output::array(coefficients, count, "coefficients")?;
        with_precision!(list, |list| {
            let contacts = &list.contacts[range];
            if let Some(contact) = contacts.iter().find(|contact| !law.coefficient(contact).is_finite()) {
                return Err(beyond_range(contact));
            }
            out.write_all(contacts.iter().map(|contact| law.coefficient(contact).to_f64()))
        })
    })
}

/// What a contact exerts at most, where its vertices' positions and velocities sum up to these sizes.
pub(in crate::capi) fn most_force<T: Scalar>(
    list: &ContactList<T>,
    law: &PenaltyLaw,
    is_moved: bool,
) -> impl Fn(&Contact<T>, [T; 2]) -> T {
    let [damping_time, with_friction] = [law.damping_time(), 1.0 + law.friction()].map(T::of);
    move |contact, [positions, velocities]| {
        let push =
            law.coefficient(contact) * (most_depth(list, contact, positions, is_moved) + damping_time * velocities);
        push * with_friction
    }
}

/// How deep a contact is at most: at positions of these sizes if `is_moved`, else as it was found.
fn most_depth<T: Scalar>(list: &ContactList<T>, contact: &Contact<T>, positions: T, is_moved: bool) -> T {
    if is_moved { contact.depth + positions + list.spreads.gap(contact).abs() } else { contact.depth }
}

/// The velocities. NULL is refused where there is damping or friction, which would be lost.
///
/// # Safety
/// As [`BodyArray::if_any`].
pub(in crate::capi) unsafe fn velocities_for<'a>(
    law: &PenaltyLaw,
    list: &AnyContacts,
    velocities: *const rayc_vectors,
    body_count: usize,
) -> Result<Option<&'a [BodyArray]>, Failure> {
    let needing = [("damping_time", law.damping_time(), "to damp"), ("friction", law.friction(), "to rub against")];
    let lost = needing.into_iter().find(|&(_, value, _)| value > 0.0);
    if let Some((name, value, what)) = lost.filter(|_| velocities.is_null() && body_count.max(list.len()) > 0) {
        return Err(Failure::new(
            rayc_status::RAYC_STATUS_INVALID_OPTION,
            text!("{name} is {value}, but there are no velocities {what}; give velocities, or a {name} of 0"),
        ));
    }
    BodyArray::if_any(velocities, body_count, "velocities")
}

fn add_all_forces<T: Scalar>(
    list: &ContactList<T>,
    law: &PenaltyLaw,
    positions: Option<&[BodyArray]>,
    velocities: Option<&[BodyArray]>,
    mut forces: BodyArraysMut<'_>,
) -> Result<(), Failure> {
    let read = [("positions", positions), ("velocities", velocities)];
    Arrays { read, written: Some(&forces) }.check(list, most_force(list, law, positions.is_some()))?;
    add_forces(list, law, positions, velocities, &mut forces);
    Ok(())
}

fn finite([stiffness, damping]: [f64; 2]) -> Result<[f64; 2], Failure> {
    if stiffness.is_finite() && damping.is_finite() {
        return Ok([stiffness, damping]);
    }
    let message = text!("the factors are {stiffness} and {damping}; give finite numbers");
    Err(Failure::new(rayc_status::RAYC_STATUS_INVALID_OPTION, message))
}

fn add_all_differentials<T: Scalar>(
    list: &ContactList<T>,
    law: &PenaltyLaw,
    factors: [f64; 2],
    displacements: &[BodyArray],
    mut forces: BodyArraysMut<'_>,
) -> Result<(), Failure> {
    check_differential(list, law, factors, displacements, &forces)?;
    add_differential(list, law, factors[0], factors[1], displacements, &mut forces);
    Ok(())
}

fn add_all_whole_differentials<T: Scalar>(
    scene: &Scene<T>,
    list: &ContactList<T>,
    law: &PenaltyLaw,
    factors: [f64; 2],
    displacements: &[BodyArray],
    mut forces: BodyArraysMut<'_>,
) -> Result<(), Failure> {
    let arrays = check_differential(list, law, factors, displacements, &forces)?;
    for pair in list.contacts.chunk_by(|one, next| one.bodies() == next.bodies()) {
        for body in pair[0].bodies() {
            arrays.check_all_of::<T>(body, scene.mesh(body)?.topology().vertex_count())?;
        }
    }
    Ok(scene.add_differential(list, law, factors, displacements, &mut forces)?)
}

fn check_differential<'a, T: Scalar>(
    list: &ContactList<T>,
    law: &PenaltyLaw,
    [stiffness, damping]: [f64; 2],
    displacements: &'a [BodyArray],
    forces: &'a BodyArraysMut<'a>,
) -> Result<Arrays<'a, 1>, Failure> {
    let factor = T::of(stiffness + damping * law.damping_time());
    let most = |contact: &Contact<T>, [size]: [T; 1]| factor * law.coefficient(contact) * size;
    let arrays = Arrays { read: [("displacements", Some(displacements))], written: Some(forces) };
    arrays.check(list, most)?;
    Ok(arrays)
}

fn add_all_wrenches<T: Scalar>(
    list: &ContactList<T>,
    law: &PenaltyLaw,
    [points, velocities]: [&[f64]; 2],
    wrenches: &mut [f64],
) -> Result<(), Failure> {
    let motion = |body: u32| {
        let vector = |from: &[f64], place: usize| Vector3::from_column_slice(&from[3 * place..3 * place + 3]);
        let body = body as usize;
        let velocity = [2 * body, 2 * body + 1].map(|place| vector(velocities, place));
        RigidMotion { point: vector(points, body), velocity }
    };
    for &Contact { colliding, collided, .. } in &list.contacts {
        for body in [colliding, collided] {
            let count = wrenches.len() / 6;
            if body as usize >= count {
                let message = text!("a contact needs body {body}, but there are {count}; give numbers for each body");
                return Err(Failure::new(rayc_status::RAYC_STATUS_WRONG_COUNT, message));
            }
            let RigidMotion { point, velocity: [linear, angular] } = motion(body);
            for (numbers, name) in [(point, "points"), (linear, "velocities"), (angular, "velocities")] {
                check_numbers::<f64>(numbers.as_slice(), format_args!("{name}: body {body}"))?;
            }
        }
    }
    let mut sizes = 0.0;
    add_wrenches(list, law, motion, |_, wrench| {
        sizes += wrench.iter().flatten().map(|number| number.abs()).sum::<f64>()
    });
    if let Some(contact) = list.contacts.first().filter(|_| !sizes.is_finite()) {
        return Err(beyond_range(contact));
    }
    add_wrenches(list, law, motion, |body, wrench| {
        let own = &mut wrenches[6 * body as usize..][..6];
        own.iter_mut().zip(wrench.iter().flatten()).for_each(|(sum, number)| *sum += number);
    });
    Ok(())
}

fn all_energy<T: Scalar>(
    list: &ContactList<T>,
    law: &PenaltyLaw,
    positions: Option<&[BodyArray]>,
) -> Result<f64, Failure> {
    let most = |contact: &Contact<T>, [size]: [T; 1]| {
        let depth = most_depth(list, contact, size, positions.is_some());
        law.coefficient(contact) * depth * depth
    };
    Arrays { read: [("positions", positions)], written: None }.check(list, most)?;
    Ok(energy(list, law, positions).to_f64())
}
