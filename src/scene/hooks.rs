//! Bodies that several scenes share: whose they are, and which scene finds their contacts.

use super::bodies::Body;
use super::{Scene, SceneError};
use crate::math::Scalar;

/// How a scene shares a body with others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sharing {
    /// Whether it is another scene's body. Such a body has no contacts with itself here, and none with other foreign bodies. Its
    /// contacts with a body of this scene are found by one of the two scenes, as [`finds_pair`] says.
    pub is_foreign: bool,
    /// How many bodies' boxes overlap its own in all scenes together, by which crowds are known; `None`: as many as here.
    pub neighbours: Option<u32>,
    /// For a foreign body, what [`Scene::overlaps_itself`] says in its own scene.
    pub overlaps_itself: bool,
}

impl<T: Scalar> Scene<T> {
    /// Sets how a body is shared with other scenes, from the next query on. A new body is not shared.
    pub fn share(&mut self, body: u32, sharing: Sharing) -> Result<(), SceneError> {
        let shared = self.bodies.get_mut(body).ok_or(SceneError::UnknownBody { body })?;
        shared.own.take_if(|_| sharing.is_foreign);
        let Sharing { is_foreign, neighbours, overlaps_itself } = sharing;
        (shared.is_foreign, shared.neighbours, shared.overlaps_elsewhere) = (is_foreign, neighbours, overlaps_itself);
        Ok(())
    }

    /// Whether a body is another scene's; never one that the scene does not have.
    pub fn is_foreign(&self, body: u32) -> bool {
        self.bodies.get(body).is_some_and(|body| body.is_foreign)
    }
}

impl<T: Scalar> Body<T> {
    /// Whether the contacts of the two, first and second in their order, are to be found here.
    pub(super) fn is_found_with(&self, other: &Self) -> bool {
        match [self.is_foreign, other.is_foreign] {
            [false, false] => true,
            [false, true] => finds_pair(self.key, other.key),
            [true, false] => finds_pair(other.key, self.key),
            [true, true] => false,
        }
    }
}

/// Whether the scene of the body with key `own` finds its contacts with a foreign body. The foreign body's own scene, which asks
/// the other way round, gets the opposite answer. Each finds about half of such pairs.
pub fn finds_pair(own: u64, foreign: u64) -> bool {
    let low_finds = (own ^ foreign).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 63 == 0;
    (own < foreign) == low_finds
}

#[cfg(test)]
mod tests {
    use super::finds_pair;

    #[test]
    fn one_of_two_scenes_finds_a_pair() {
        let mut found = 0;
        for own in 0..100u64 {
            for foreign in (0..100).filter(|&foreign| foreign != own) {
                assert_ne!(finds_pair(own, foreign), finds_pair(foreign, own), "{own} {foreign}");
                found += u32::from(own < foreign && finds_pair(own, foreign));
            }
        }
        assert!((2000..2950).contains(&found), "{found} of 4950 by the first");
    }
}
