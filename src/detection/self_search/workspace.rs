use super::culling::Culling;
use super::own_side::Folds;
use super::touching::Touching;
use crate::math::Scalar;

/// What the search for self-contacts needs; kept with the contacts, so that a steady step allocates nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct SelfWorkspace<T: Scalar> {
    pub(in crate::detection) touching: Touching<T>,
    pub(in crate::detection) culling: Culling,
    pub(in crate::detection) folds: Folds,
}
