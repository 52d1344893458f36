//! Bodies that keep their shape and are moved by a pose: they are read only where they meet others.

use super::bodies::Body;
use super::{Scene, SceneError};
use crate::math::{Pose, Scalar};
use crate::mesh::next_stamp;

impl<T: Scalar> Scene<T> {
    /// Moves a body by a pose: its vertices are those of its mesh as it was created, each moved by [`Pose::moved`]. Positions
    /// that it was given since do not count, nor does its last pose. Contacts are those of the same positions given to
    /// [`mesh_mut`](Self::mesh_mut), to the bit.
    ///
    /// No vertex is looked at but those that decide how far the body reaches; a query then moves those near other bodies.
    /// A body whose contacts with itself are switched on is moved as a whole. The same pose again costs nothing.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`], [`SceneError::Pose`], [`SceneError::PoseBeyondRange`]; the body is then where it was.
    pub fn set_pose(&mut self, body: u32, pose: &Pose) -> Result<(), SceneError> {
        let moved = self.bodies.get_mut(body).ok_or(SceneError::UnknownBody { body })?;
        pose.check().map_err(|source| SceneError::Pose { body, source })?;
        if moved.set_pose(pose) { Ok(()) } else { Err(SceneError::PoseBeyondRange { body }) }
    }

    /// Whether [`follow`](Self::follow) will succeed.
    pub(crate) fn may_follow(&mut self, body: u32, pose: &Pose) -> bool {
        self.bodies.get_mut(body).is_some_and(|body| body.surface.may_move(pose))
    }

    /// [`set_pose`](Self::set_pose) of a pose that was checked before, or derived from a checked one; false where there is no
    /// such body or it would be beyond the precision.
    pub(crate) fn follow(&mut self, body: u32, pose: &Pose) -> bool {
        self.bodies.get_mut(body).is_some_and(|body| body.set_pose(pose))
    }
}

impl<T: Scalar> Body<T> {
    /// Moves the body; false where it would be beyond the precision.
    fn set_pose(&mut self, pose: &Pose) -> bool {
        let Self { surface, own, given, .. } = self;
        if surface.mesh().pose() == Some(pose) {
            *given = next_stamp();
            return true;
        }
        let is_moved = surface.set_pose(pose);
        if is_moved && own.is_some() {
            surface.mesh_mut().settle();
        }
        is_moved
    }
}
