use super::node::{CHILD_COUNT, Node};
use crate::math::{Aabb, Scalar, Vector3};
use crate::memory::{self, Room};
use crate::mesh::Mesh;

/// The centre of a tile's box, and the tile.
type Place<T> = (Vector3<T>, u32);

/// Groups tiles, given by their triangles, at the reference positions into nodes of up to sixteen children, from the root down: a set of tiles is
/// halved along the longest side of its centres' box again and again, at places that leave as few nodes as can be. Gives
/// the tiles in the order in which the nodes lead to them, so that neighbours in space are neighbours in memory.
pub(super) fn group<T: Scalar>(mesh: &Mesh<T>, mut tiles: Vec<Vec<u32>>) -> (Vec<Node<T>>, Vec<Vec<u32>>) {
    let place = |(index, triangles): (usize, &Vec<u32>)| {
        let mut aabb = Aabb::empty();
        let corners = triangles.iter().flat_map(|&triangle| mesh.topology().triangles()[triangle as usize]);
        corners.for_each(|vertex| aabb.include(&mesh.reference_positions()[vertex as usize]));
        (aabb.centre(), index as u32)
    };
    let mut places: Vec<Place<T>> = memory::listed(tiles.iter().enumerate().map(place));
    let nodes = nodes_above(&mut places);
    let sorted = memory::listed(places.iter().map(|&(_, tile)| std::mem::take(&mut tiles[tile as usize])));
    (nodes, sorted)
}

/// The nodes above these tiles, level by level, so that a node's children follow one another. Tiles are numbered in the
/// order in which they are left.
fn nodes_above<T: Scalar>(places: &mut [Place<T>]) -> Vec<Node<T>> {
    let mut nodes = memory::with_room(places.len() / 8 + 1);
    // The tiles of each node, in the order of the nodes.
    let mut parts = memory::listed([(0, places)]);
    let mut first_child = 1;
    while !parts.is_empty() {
        let mut below = Vec::new();
        for (first_tile, part) in parts {
            if part.len() <= CHILD_COUNT {
                nodes.room_for(1).push(Node::new(first_tile, part.len(), true));
                continue;
            }
            // How many tiles a child can hold, if all below it are full.
            let mut capacity = CHILD_COUNT;
            while capacity * CHILD_COUNT < part.len() {
                capacity *= CHILD_COUNT;
            }
            let before = below.len();
            cut(part, capacity, first_tile, &mut below);
            let child_count = below.len() - before;
            nodes.room_for(1).push(Node::new(first_child, child_count, false));
            first_child += child_count as u32;
        }
        parts = below;
    }
    nodes
}

/// Halves a set until no part is above the capacity.
fn cut<'a, T: Scalar>(
    places: &'a mut [Place<T>],
    capacity: usize,
    first: u32,
    parts: &mut Vec<(u32, &'a mut [Place<T>])>,
) {
    if places.len() <= capacity {
        parts.room_for(1).push((first, places));
        return;
    }
    // About the middle, and so that one half is all full parts.
    let middle = (places.len() / 2).next_multiple_of(capacity);
    let mut centres = Aabb::empty();
    places.iter().for_each(|(centre, _)| centres.include(centre));
    let axis = (centres.upper - centres.lower).imax();
    places.select_nth_unstable_by(middle, |(a, i), (b, j)| {
        a[axis].partial_cmp(&b[axis]).unwrap_or(std::cmp::Ordering::Equal).then(i.cmp(j))
    });
    let (left, right) = places.split_at_mut(middle);
    cut(left, capacity, first, parts);
    cut(right, capacity, first + middle as u32, parts);
}
