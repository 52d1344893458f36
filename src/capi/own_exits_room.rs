use crate::contact::OwnExits;

/// What the octree of a mesh keeps for rayc_octree_own_exits().
pub(super) struct OwnExitsRoom {
    pub(super) singles: OwnExits<f32>,
    pub(super) doubles: OwnExits<f64>,
}

impl OwnExitsRoom {
    pub(super) fn new() -> Self {
        Self { singles: OwnExits::default(), doubles: OwnExits::default() }
    }
}
