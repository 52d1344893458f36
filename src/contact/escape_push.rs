use crate::contact::point_pair::Contact;
use crate::math::{Scalar, Vector3};

/// Which way an escaping pair goes, and how far: the sum of the pair's contacts of kind `Escape`, for those who move or push
/// bodies as a whole. A body without stiffness of its own gives way where contacts push it, and the rest of it stays inside;
/// pushed evenly, it keeps its shape and comes out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EscapePush<T: Scalar> {
    /// The pair; in a scene the smaller number comes first.
    pub bodies: [u32; 2],
    /// The direction in which the first body leaves the second, of unit length.
    pub direction: Vector3<T>,
    /// How far the two have to move apart along it, as far as the rays tell, > 0.
    pub depth: T,
    /// The area of the pair's contacts, together: depth · area, times a stiffness in N/m³, is what the contacts push with.
    pub area: T,
    /// How many they are.
    pub contact_count: u32,
}

impl<T: Scalar> EscapePush<T> {
    pub(crate) fn new(bodies: [u32; 2], direction: Vector3<T>, depth: T, contacts: &[Contact<T>]) -> Self {
        let area = contacts.iter().fold(T::zero(), |sum, contact| sum + contact.area);
        Self { bodies, direction, depth, area, contact_count: contacts.len() as u32 }
    }
}
