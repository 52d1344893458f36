use super::{CHILD_COUNT, Child, Node, Tile};
use crate::math::{Aabb, Scalar, Vector3};
use crate::mesh::Mesh;

/// The centre of a tile's box, and the tile.
type Place<T> = (Vector3<T>, u32);

/// Groups tiles into nodes of up to eight children, from the root down: a set of tiles is halved along the longest
/// side of its centres' box, the halves again, and those again.
pub(super) fn group<T: Scalar>(mesh: &Mesh<T>, tiles: &[Tile<T>]) -> Vec<Node<T>> {
    let mut places: Vec<Place<T>> = tiles
        .iter()
        .enumerate()
        .map(|(index, tile)| {
            let mut aabb = Aabb::empty();
            tile.vertices.iter().for_each(|&vertex| aabb.include(&mesh.positions()[vertex as usize]));
            (aabb.lower + (aabb.upper - aabb.lower) * T::of(0.5), index as u32)
        })
        .collect();
    let mut nodes = Vec::with_capacity(tiles.len() / 4 + 1);
    add_node(&mut places, &mut nodes);
    nodes
}

/// Adds the node of these tiles and all below it; gives its index.
fn add_node<T: Scalar>(places: &mut [Place<T>], nodes: &mut Vec<Node<T>>) -> u32 {
    let index = nodes.len();
    nodes.push(Node::new(&[]));
    let mut children = Vec::with_capacity(CHILD_COUNT);
    if places.len() <= CHILD_COUNT {
        children.extend(places.iter().map(|&(_, tile)| Child::Tile(tile)));
    } else {
        for part in in_eight(places) {
            children.push(match part {
                [(_, tile)] => Child::Tile(*tile),
                _ => Child::Node(add_node(part, nodes)),
            });
        }
    }
    nodes[index] = Node::new(&children);
    index as u32
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
