//! How a body is shared between scenes, and which of two scenes finds a pair's contacts.

/// How a scene shares a body with others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sharing {
    /// Another scene's body: it has no contacts with itself here and none with other foreign ones; of a pair of it and a body of
    /// this scene's own one of the two scenes finds the contacts, as [`finds_pair`] says.
    pub is_foreign: bool,
    /// How many bodies' boxes overlap its own in all scenes together, by which crowds are known; `None`: as many as here.
    pub neighbours: Option<u32>,
    /// Of a foreign body: what [`Scene::overlaps_itself`](crate::scene::Scene::overlaps_itself) says of it in its own scene.
    pub overlaps_itself: bool,
}

/// Whether the scene that has the body of key `own` finds the contacts with the other, which is foreign to it; the scene that
/// has it the other way round says the opposite. Each finds about half of such pairs.
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
