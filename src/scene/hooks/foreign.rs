use super::{Sharing, finds_pair};
use crate::math::Scalar;
use crate::scene::bodies::Body;
use crate::scene::{Scene, SceneError};

impl<T: Scalar> Scene<T> {
    /// Sets how a body is shared with other scenes, from the next query on. A new body is not shared.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`].
    pub fn share(&mut self, body: u32, sharing: Sharing) -> Result<(), SceneError> {
        let shared = self.bodies.get_mut(body).ok_or(SceneError::UnknownBody { body })?;
        if sharing.is_foreign {
            shared.own = None;
        }
        shared.sharing = sharing;
        Ok(())
    }

    /// Whether a body is another scene's; never one that the scene does not have.
    pub fn is_foreign(&self, body: u32) -> bool {
        self.bodies.get(body).is_some_and(|body| body.sharing.is_foreign)
    }
}

impl<T: Scalar> Body<T> {
    /// Whether the contacts of the two, first and second in their order, are to be found here.
    pub(in crate::scene) fn is_found_with(&self, other: &Self) -> bool {
        match [self.sharing.is_foreign, other.sharing.is_foreign] {
            [false, false] => true,
            [false, true] => finds_pair(self.key, other.key),
            [true, false] => finds_pair(other.key, self.key),
            [true, true] => false,
        }
    }
}
