use super::{AnyContacts, AnyForcesByPair, rayc_contacts};
use crate::capi::base::rayc_status;
use crate::capi::ffi::{Failure, Output, changing, give, guard, guard_end, reading, take_back, with_precision};
use crate::capi::scene::{Pointers, for_each_scene, rayc_scene};
use crate::contact::{Contact, ContactKind, ContactList, SurfacePoint};
use crate::distributed::ForcesByPair;
use crate::math::Scalar;

/// Makes an empty list. *contacts: the new handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contacts_create(contacts: *mut *mut rayc_contacts) -> rayc_status {
    guard(|| {
        let list = AnyContacts::F64(ContactList::default());
        let pair_forces = AnyForcesByPair::F64(ForcesByPair::default());
        give(Output::new(contacts, "contacts")?, rayc_contacts { list, pair_forces })
    })
}

/// Finds all contacts between different bodies at their present positions: first which boxes overlap, then, for each
/// such pair, rays both ways. It also finds the contacts of bodies with themselves where that is switched on. Search
/// trees are renewed where they need to be. The call replaces what `contacts` held. Contacts are ordered by pair (the
/// body that comes first by key, or by number where none has a key, then the other; a body with itself before its
/// pairs), then by the colliding body, then along its surface. The order does not depend on the number of threads.
///
/// With the same positions a query finds the same contacts, however often it is called in a step: see rayc_scene_advance().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_query(scene: *mut rayc_scene, contacts: *mut rayc_contacts) -> rayc_status {
    guard(|| query(scene, contacts))
}

/// rayc_scene_query() for many scenes at once: scene i into contacts i, on the threads of the first scene, a scene on one
/// thread at a time. Each gets the same contacts as by itself. No handle may come twice.
///
/// statuses: of each scene, what the call for it would have returned. Where one is an error, the others are done nevertheless;
/// the call returns the first error, and rayc_last_error_message() names its scene.
///
/// Errors: those of rayc_scene_query(). Where the first scene is no handle or an array is NULL, nothing is done and no
/// status written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scenes_query(
    count: usize,
    scenes: *const *mut rayc_scene,
    contacts: *const *mut rayc_contacts,
    statuses: *mut u32,
) -> rayc_status {
    guard(|| {
        let (scenes, lists) = (Pointers::new(scenes, count, "scenes")?, Pointers::new(contacts, count, "contacts")?);
        for_each_scene(&scenes, statuses, |k, scene| query(scene, lists.of(k)))
    })
}

/// # Safety
/// That of rayc_scene_query().
unsafe fn query(scene: *mut rayc_scene, contacts: *mut rayc_contacts) -> Result<(), Failure> {
    let (mut scene, mut contacts) = (changing(scene, "scene")?, changing(contacts, "contacts")?);
    let list = &mut contacts.list;
    with_precision!(&mut scene.scene, |scene| scene.query(list.as_mut()));
    Ok(())
}

/// How many contacts there are.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contacts_count(contacts: *const rayc_contacts, count: *mut usize) -> rayc_status {
    guard(|| {
        let contacts = reading(contacts, "contacts")?;
        Output::new(count, "count")?.write(contacts.list.len())
    })
}

/// A point on a mesh's surface: the weighted sum of a triangle's vertices, with which it moves.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_surface_point {
    /// The triangle it lies on.
    pub triangle: u32,
    /// The triangle's corners. Where the point is a vertex, that vertex comes first.
    pub vertices: [u32; 3],
    /// Barycentric weights at `vertices`; they sum to 1. A vertex has 1, 0, 0.
    pub weights: [f64; 3],
    /// Where it was at detection, in m.
    pub position: [f64; 3],
}

impl<T: Scalar> From<&SurfacePoint<T>> for rayc_surface_point {
    fn from(point: &SurfacePoint<T>) -> Self {
        Self {
            triangle: point.triangle,
            vertices: point.vertices,
            weights: point.weights.map(T::to_f64),
            position: point.position.map(T::to_f64).into(),
        }
    }
}

/// How a contact came about.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum rayc_contact_kind {
    /// A ray along the inward normal leaves the other body before its own: the paper's contact.
    RAYC_CONTACT_KIND_RAY = 1,
    /// The same from the middle of that stretch of an edge which lies inside the other body. Only where no ray from the
    /// surface points of either body finds the overlap.
    RAYC_CONTACT_KIND_EDGE = 2,
    /// The pair is escaping: direction is the pair's, depth is that of its deepest point, cos_alpha is 1.
    RAYC_CONTACT_KIND_ESCAPE = 3,
}

/// A point p1 of one surface inside another body, and the point p2 of that body's surface to which it is pulled.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_contact {
    /// How it came about, a rayc_contact_kind.
    pub kind: u32,
    /// The body the ray starts from: its number in the scene, or 0 and 1 for the first and second mesh of
    /// rayc_query_pair().
    pub colliding: u32,
    /// The body the ray ends on; the same for a contact of a body with itself.
    pub collided: u32,
    /// Which part of p1's triangle the ray stands for: 1 is the whole triangle, and the halves of piece n are 2 n and
    /// 2 n + 1. 2³¹ or more where the ray stands for a patch of triangles. 0 for a ray from a vertex. For a contact of an
    /// edge it is 3 n + k: the edge lies across from corner k, and the contact is on its n-th stretch inside the other body,
    /// counted from 0.
    pub piece: u32,
    /// Names the contact from step to step, for hosts that keep something for each: the same as long as the same piece
    /// of surface meets the same body, and another for every other contact. It is a hash of 64 bits of kind, bodies,
    /// p1's triangle and piece: that any two of 100 000 contacts share one has a probability of 3e-10. Where an overlap
    /// changes, patches and triangles may be halved more or less often, and their contacts get other names.
    pub id: u64,
    /// The ray's origin, on the colliding body.
    pub p1: rayc_surface_point,
    /// The ray's end, on the collided body.
    pub p2: rayc_surface_point,
    /// The ray's direction, from p1 to p2: the inward normal at p1, of unit length.
    pub direction: [f64; 3],
    /// The distance from p1 to p2, in m; ≥ 0.
    pub depth: f64,
    /// What the depth is multiplied with in the pressure, 0 to 1. With RAYC_LAW_PRESSURE the distance from p1 to the nearest
    /// point of the collided body over the depth, which beside a flat face is the cosine of the angle between the ray and the
    /// outward normal at p2; with RAYC_LAW_RAY_LENGTH that cosine.
    pub cos_alpha: f64,
    /// The surface area the contact stands for, in m²: that of the piece of surface behind the ray, times the share of
    /// the pair's load that the rays of the colliding body carry. The rays of both bodies find the same overlap, so the
    /// two bodies' shares sum to 1.
    pub area: f64,
}

impl<T: Scalar> From<&Contact<T>> for rayc_contact {
    fn from(contact: &Contact<T>) -> Self {
        let kind = match contact.kind {
            ContactKind::Ray => rayc_contact_kind::RAYC_CONTACT_KIND_RAY,
            ContactKind::Edge => rayc_contact_kind::RAYC_CONTACT_KIND_EDGE,
            ContactKind::Escape => rayc_contact_kind::RAYC_CONTACT_KIND_ESCAPE,
        };
        Self {
            kind: kind as u32,
            colliding: contact.colliding,
            collided: contact.collided,
            piece: contact.piece,
            id: contact.id(),
            p1: (&contact.p1).into(),
            p2: (&contact.p2).into(),
            direction: contact.direction.map(T::to_f64).into(),
            depth: contact.depth.to_f64(),
            cos_alpha: contact.cos_alpha.to_f64(),
            area: contact.area.to_f64(),
        }
    }
}

/// Copies contacts first … first + count − 1 to `out`, which has room for `count`.
///
/// Errors: RAYC_STATUS_WRONG_COUNT where the range reaches beyond the end.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contacts_copy(
    contacts: *const rayc_contacts,
    first: usize,
    count: usize,
    out: *mut rayc_contact,
) -> rayc_status {
    guard(|| {
        let contacts = reading(contacts, "contacts")?;
        let range = contacts.list.range(first, count)?;
        let out = Output::array(out, count, "out")?;
        with_precision!(&contacts.list, |list| out.write_all(list.contacts[range].iter().map(Into::into)))
    })
}

/// Frees the contacts; NULL does nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contacts_destroy(contacts: *mut rayc_contacts) -> rayc_status {
    guard_end(|| take_back(contacts, "contacts"))
}
