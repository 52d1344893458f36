use super::{AnyContacts, rayc_contacts};
use crate::capi::base::rayc_status;
use crate::capi::ffi::{Known, Output, growing, guard, range_of, reading, with_precision};
use crate::contact::EscapePush;
use crate::math::Scalar;

/// Which way an escaping pair goes, and how far: the sum of the pair's contacts of kind RAYC_CONTACT_KIND_ESCAPE. It
/// says nothing that the contacts do not: hosts that move bodies themselves translate the first by a part of depth ·
/// direction, and the second against it; hosts with very soft bodies, which contacts would stretch, spread the push
/// evenly over each body, as the contact system does. Later versions may tell more, at the end.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_escape_push {
    /// The body that leaves along the direction.
    pub first: u32,
    /// The body that leaves against it.
    pub second: u32,
    /// How many contacts the pair has.
    pub contact_count: u32,
    /// Always 0, so that equal pushes are equal byte by byte.
    pub reserved: u32,
    /// Of unit length.
    pub direction: [f64; 3],
    /// How far the two have to move apart along it, as far as the rays tell, > 0.
    pub depth: f64,
    /// The area of the pair's contacts, together: the push is stiffness · area · depth, in N, with RAYC_WEIGHTING_AREA.
    pub area: f64,
}

growing!(rayc_escape_push);

impl<T: Scalar> From<&EscapePush<T>> for rayc_escape_push {
    fn from(push: &EscapePush<T>) -> Self {
        Self {
            first: push.bodies[0],
            second: push.bodies[1],
            contact_count: push.contact_count,
            reserved: 0,
            direction: push.direction.map(T::to_f64).into(),
            depth: push.depth.to_f64(),
            area: push.area.to_f64(),
        }
    }
}

/// How many pairs are escaping.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contacts_escape_push_count(
    contacts: *const rayc_contacts,
    count: *mut usize,
) -> rayc_status {
    guard(|| {
        let list = &reading(contacts, "contacts")?.list;
        Output::new(count, "count")?.write(push_count(list))
    })
}

/// Copies the pushes first … first + count − 1 to `out`, which has room for `count`: one for each escaping pair, in
/// the order of the contacts. struct_size: sizeof(rayc_escape_push), so that a later library writes no more of each
/// than the caller knows.
///
/// Errors: RAYC_STATUS_WRONG_COUNT where the range reaches beyond the end, RAYC_STATUS_INVALID_STRUCT_SIZE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_contacts_copy_escape_pushes(
    contacts: *const rayc_contacts,
    first: usize,
    count: usize,
    struct_size: usize,
    out: *mut rayc_escape_push,
) -> rayc_status {
    guard(|| {
        let list = &reading(contacts, "contacts")?.list;
        let range = range_of("pushes", first, count, push_count(list))?;
        let out = Known::new(struct_size, out, count, "out")?;
        with_precision!(list, |list| out.write_all(list.pushes()[range].iter().map(Into::into)))
    })
}

fn push_count(list: &AnyContacts) -> usize {
    with_precision!(list, |list| list.pushes().len())
}
