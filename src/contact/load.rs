use super::Contact;
use crate::math::{Scalar, Vector3, length};

/// Shares the load of a pair between the rays of its two directions, by scaling their contacts' areas.
///
/// Either direction alone integrates the pressure over the overlapped surface, but not equally well: rays of a curved
/// body into a flat one give exactly the force of Archimedes, since depth · cos α is then the depth across the face;
/// the flat body's own rays are columns of that depth, lessened once more by cos α. So each direction counts by how
/// much its overlapped surface turns, weighted by depth: u = Σ a δ − |Σ a δ d|. A flat body leaves the load to a curved
/// one, equal bodies share it, and where one side's rays see nothing (a coarse floor cast from its corners) the other
/// carries all. New contacts come with δ = 0, so the shares change without jumps.
pub(super) fn share_load<T: Scalar>(first: &mut [Contact<T>], second: &mut [Contact<T>]) {
    let (a, b) = (turning(first), turning(second));
    let sum = a + b;
    let half = T::of(0.5);
    let (share_a, share_b) = if sum > T::zero() { (a / sum, b / sum) } else { (half, half) };
    for (contacts, share) in [(first, share_a), (second, share_b)] {
        contacts.iter_mut().for_each(|contact| contact.area *= share);
    }
}

/// How much the surface under these contacts turns; at least a thousandth of their pressure, so that of two flat
/// bodies neither is left out by rounding.
fn turning<T: Scalar>(contacts: &[Contact<T>]) -> T {
    let mut pressure = T::zero();
    let mut vector = Vector3::zeros();
    for contact in contacts {
        let share = contact.area * contact.depth;
        pressure += share;
        vector += contact.direction * share;
    }
    pressure * T::of(1.0 + 1.0 / 1024.0) - length(&vector)
}
