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
    /// The stamp of the positions for which the next query need not find them; 0 for none.
    pub(super) found_at: u64,
}
