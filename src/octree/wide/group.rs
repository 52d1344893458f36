use super::node::{CHILD_COUNT, Node};
use crate::math::{Aabb, Scalar, Vector3};
use crate::mesh::Mesh;

/// The centre of a tile's box, and the tile.
type Place<T> = (Vector3<T>, u32);

/// Groups tiles, given by their triangles, into nodes of up to eight children, from the root down: a set of tiles is
/// halved along the longest side of its centres' box, the halves again, and those again. Gives the tiles in the order in
/// which the nodes lead to them, so that neighbours in space are neighbours in memory.
pub(super) fn group<T: Scalar>(mesh: &Mesh<T>, mut tiles: Vec<Vec<u32>>) -> (Vec<Node<T>>, Vec<Vec<u32>>) {
    let mut places: Vec<Place<T>> = tiles
        .iter()
        .enumerate()
        .map(|(index, triangles)| {
            let mut aabb = Aabb::empty();
            triangles.iter().flat_map(|&triangle| mesh.corners(triangle)).for_each(|corner| aabb.include(&corner));
            (aabb.centre(), index as u32)
        })
        .collect();
    let nodes = nodes_above(&mut places);
    let sorted = places.iter().map(|&(_, tile)| std::mem::take(&mut tiles[tile as usize])).collect();
    (nodes, sorted)
}

/// The nodes above these tiles, level by level, so that a node's children follow one another. Tiles are numbered in the
/// order in which they are left.
fn nodes_above<T: Scalar>(places: &mut [Place<T>]) -> Vec<Node<T>> {
    let mut nodes = Vec::with_capacity(places.len() / 4 + 1);
    // The tiles of each node, in the order of the nodes.
    let mut parts = vec![(0, places)];
    let mut first_child = 1;
    while !parts.is_empty() {
        let mut below = Vec::new();
        for (first_tile, part) in parts {
            if part.len() <= CHILD_COUNT {
                nodes.push(Node::new(first_tile, part.len(), true));
                continue;
            }
            nodes.push(Node::new(first_child, CHILD_COUNT, false));
            first_child += CHILD_COUNT as u32;
            let mut next = first_tile;
            for part in in_eight(part) {
                let first = next;
                next += part.len() as u32;
                below.push((first, part));
            }
        }
        parts = below;
    }
    nodes
}

fn in_eight<T: Scalar>(places: &mut [Place<T>]) -> impl Iterator<Item = &mut [Place<T>]> {
    let (a, b) = halves(places);
    [a, b].into_iter().flat_map(|half| <[_; 2]>::from(halves(half))).flat_map(|half| <[_; 2]>::from(halves(half)))
}

fn halves<T: Scalar>(places: &mut [Place<T>]) -> (&mut [Place<T>], &mut [Place<T>]) {
    let mut centres = Aabb::empty();
    places.iter().for_each(|(centre, _)| centres.include(centre));
    let axis = (centres.upper - centres.lower).imax();
    let middle = places.len() / 2;
    places.select_nth_unstable_by(middle, |(a, i), (b, j)| {
        a[axis].partial_cmp(&b[axis]).unwrap_or(std::cmp::Ordering::Equal).then(i.cmp(j))
    });
    places.split_at_mut(middle)
}
