//! How a body is shared between scenes, and which of two scenes finds a pair's contacts.

/// How a scene shares a body with others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sharing {
    /// Another scene's body: it has no contacts with itself here and none with other ghosts; of a pair of it and a body of
    /// this scene's own one of the two scenes finds the contacts, as [`finds_pair`] says.
    pub is_ghost: bool,
    /// How many bodies' boxes overlap its own in all scenes together, by which crowds are known; `None`: as many as here.
    pub neighbours: Option<u32>,
    /// Of a ghost: what [`Scene::overlaps_itself`](super::Scene::overlaps_itself) says of the body in its own scene.
    pub overlaps_itself: bool,
}

/// What a query took for one pair of bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairCost {
    /// The pair's bodies by number, the one that comes first in their order first.
    pub bodies: [u32; 2],
    /// The cost in rays, without reading the bodies' triangles: see
    /// [`Scene::body_cost`](super::Scene::body_cost).
    pub cost: f64,
}

/// Whether the scene that has the body of key `own` finds the contacts with the other, of which it has a ghost; the scene
/// that has it the other way round says the opposite. Each finds about half of such pairs.
pub fn finds_pair(own: u64, ghost: u64) -> bool {
    let low_finds = (own ^ ghost).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 63 == 0;
    (own < ghost) == low_finds
}

#[cfg(test)]
mod tests {
    use super::finds_pair;

    #[test]
    fn one_of_two_scenes_finds_a_pair() {
        let mut found = 0;
        for own in 0..100u64 {
            for ghost in (0..100).filter(|&ghost| ghost != own) {
                assert_ne!(finds_pair(own, ghost), finds_pair(ghost, own), "{own} {ghost}");
                found += u32::from(own < ghost && finds_pair(own, ghost));
            }
        }
        assert!((2000..2950).contains(&found), "{found} of 4950 by the first");
    }
}
