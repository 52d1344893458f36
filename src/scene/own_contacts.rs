use crate::contact::ContactList;
use crate::math::Scalar;
use crate::self_contact::SelfWarmStart;

/// The contacts of a body with itself.
#[derive(Debug, Default)]
pub(super) struct OwnContacts<T: Scalar> {
    pub(super) memory: SelfWarmStart<T>,
    pub(super) contacts: ContactList<T>,
    /// Whether the body may overlap itself at its present positions.
    pub(super) may_overlap: bool,
    /// The stamp of the positions for which they were found; 0 where they have to be found anew.
    pub(super) found_at: u64,
}
