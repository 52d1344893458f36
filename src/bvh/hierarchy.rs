use crate::bvh::node::Node;
use crate::math::Scalar;
use crate::memory::{self, Room};
use crate::mesh::{capacity_below, middle};

/// The nodes above this many tiles, level by level, so that a node's children follow one another. Tiles are in the order in
/// which the nodes lead to them, as [`Clusters`](crate::mesh::Clusters) are.
pub(crate) fn nodes_above<T: Scalar>(tile_count: usize) -> Vec<Node<T>> {
    let mut nodes = memory::with_room(tile_count / 8 + 1);
    // The first tile and the number of tiles of each node, in the order of the nodes.
    let mut parts = memory::listed([(0, tile_count)]);
    let mut first_child = 1;
    while !parts.is_empty() {
        let mut below = Vec::new();
        for (first, count) in parts {
            let Some(capacity) = capacity_below(count) else {
                nodes.room_for(1).push(Node::new(first, count, true));
                continue;
            };
            let before = below.len();
            cut(first, count, capacity, &mut below);
            let child_count = below.len() - before;
            nodes.room_for(1).push(Node::new(first_child, child_count, false));
            first_child += child_count as u32;
        }
        parts = below;
    }
    nodes
}

/// Halves a range of tiles until no part is above the capacity.
fn cut(first: u32, count: usize, capacity: usize, parts: &mut Vec<(u32, usize)>) {
    match middle(count, capacity) {
        None => parts.room_for(1).push((first, count)),
        Some(middle) => {
            cut(first, middle, capacity, parts);
            cut(first + middle as u32, count - middle, capacity, parts);
        }
    }
}
