use crate::math::Scalar;
use crate::self_contact::culling::Culling;
use crate::self_contact::own_side::Folds;
use crate::self_contact::touching::Touching;

/// What the search for self-contacts needs; kept with the contacts, so that a steady step allocates nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct SelfWorkspace<T: Scalar> {
    pub(crate) touching: Touching<T>,
    pub(crate) culling: Culling,
    pub(crate) folds: Folds,
}
