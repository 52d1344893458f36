//! What the integration tests share.
#![allow(dead_code)] // each test uses a part of it

pub mod c;
pub mod cuboid;
pub mod ends;
pub mod host;
pub mod random;
pub mod shapes;

use raycontact::contact::{Contact, ContactList};
use raycontact::math::Scalar;

/// Debug builds are some thirty times as slow, and try only every eighth of many similar cases.
pub const STRIDE: usize = if cfg!(debug_assertions) { 8 } else { 1 };

/// Contacts in an order that does not depend on the octree: by colliding body, then where on it the ray starts.
pub fn sorted_along_surface<T: Scalar>(mut contacts: Vec<Contact<T>>) -> Vec<Contact<T>> {
    let key = |contact: &Contact<T>| (contact.colliding, contact.p1.triangle, contact.p1.vertices[0]);
    contacts.sort_by(|a, b| {
        let by_weights = a.p1.weights.partial_cmp(&b.p1.weights).expect("weights are finite");
        key(a).cmp(&key(b)).then(by_weights)
    });
    contacts
}

/// The same for rays from vertices: by colliding body, then vertex.
pub fn sorted_by_vertex<T: Scalar>(mut contacts: Vec<Contact<T>>) -> Vec<Contact<T>> {
    contacts.sort_by_key(|contact| (contact.colliding, contact.p1.vertices[0]));
    contacts
}

/// Asserts that every ray is a contact or counted under the one reason why it is none.
pub fn assert_every_ray_is_counted<T: Scalar>(list: &ContactList<T>) {
    let counts = &list.statistics;
    let none = counts.misses + counts.entry_hits + counts.own_surface_hits + counts.replaced;
    assert_eq!(counts.rays, list.len() as u64 + none, "{counts:?}");
}
