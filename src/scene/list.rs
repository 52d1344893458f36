/// One list of contacts.
#[derive(Clone, Copy, Debug)]
pub(super) enum List {
    /// The contacts of the body at this place with itself.
    Body(usize),
    /// The contacts of the pair at this place.
    Pair(usize),
}

/// What a query took for one pair of bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairCost {
    /// The pair's bodies by number, the one that comes first in their order first.
    pub bodies: [u32; 2],
    /// The cost in rays, without reading the bodies' triangles: see [`Scene::body_cost`](super::Scene::body_cost).
    pub cost: f64,
}
