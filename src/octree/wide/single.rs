use super::{CHILD_COUNT, Node, TILE_SIZE, Wide};
use crate::math::margins::reaches_told_apart;
use crate::math::{Aabb, Kernel, LANE_COUNT, Lanes, Mask, Scalar, Vector3, margins};
use crate::mesh::Mesh;
use crate::ray::{Hit, Ray, ShearedRay};

/// One ray's way to where it first meets the mesh: the nearest boxes first, none beyond the nearest hit known. So many nodes
/// may wait at once.
pub(super) struct NearestOfRay<'a, T: Scalar, const MOST_WAITING: usize> {
    pub(super) cells: &'a Wide<T>,
    pub(super) mesh: &'a Mesh<T>,
    pub(super) ray: &'a Ray<T>,
}

/// A tree of no more than so many nodes has at most three levels below the root, since all but the last node of a level are
/// full, and fifteen may wait on each: less room to clear, for every ray, than any tree may need.
pub(super) const FEW_NODES: usize = 1 + 16 + 256 + 4096;
pub(super) const FEW_WAITING: usize = 3 * (CHILD_COUNT - 1);

/// A node that the ray may meet.
#[derive(Clone, Copy)]
struct Waiting<T> {
    /// Where the ray enters its box.
    entry: T,
    node: u32,
}

impl<T: Scalar, const MOST_WAITING: usize> Kernel<T> for NearestOfRay<'_, T, MOST_WAITING> {
    type Output = Option<Hit<T>>;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) -> Option<Hit<T>> {
        let Self { cells, mesh, ray } = self;
        let slabs = RaySlabs::new(ray, mesh.aabb());
        let sheared = ShearedRay::new(ray);
        let mut nearest = Nearest { end: ray.t_max, hit: None };
        let mut room = [[T::zero(); LANE_COUNT]; 3];
        let (mut entries, mut places) = ([T::zero(); CHILD_COUNT], [0; CHILD_COUNT]);
        let mut stack = [Waiting { entry: T::zero(), node: 0 }; MOST_WAITING];
        let mut moved = None;
        let (mut waiting, mut node) = (0, cells.node(0, &mut moved));
        loop {
            let (enters, met) = slabs.entering::<L>(node, nearest.end);
            // One alone, most often, needs no order.
            let mut count = 1;
            places[0] = met.trailing_zeros() as u8 % CHILD_COUNT as u8;
            if met & met.wrapping_sub(1) != 0 {
                enters.store(&mut entries);
                count = list_farthest_first(met, &entries, &mut places);
            }
            if met != 0 && !node.is_leaf {
                for &place in &places[..count - 1] {
                    let place = usize::from(place) % CHILD_COUNT;
                    stack[waiting] = Waiting { entry: entries[place], node: node.first + place as u32 };
                    waiting += 1;
                }
                node = cells.node(node.first as usize + usize::from(places[count - 1]), &mut moved);
                continue;
            }
            if met != 0 {
                for &place in places[..count].iter().rev() {
                    let place = usize::from(place) % CHILD_COUNT;
                    if count == 1 || entries[place] <= nearest.end {
                        nearest.search_tile::<L>(cells, mesh, &sheared, node.first as usize + place, &mut room);
                    }
                }
            }
            let next = loop {
                if waiting == 0 {
                    return nearest.hit;
                }
                waiting -= 1;
                if stack[waiting].entry <= nearest.end {
                    break stack[waiting].node;
                }
            };
            node = cells.node(next as usize, &mut moved);
        }
    }
}

/// The nearest hit so far, and up to where a nearer one may be.
struct Nearest<T: Scalar> {
    end: T,
    hit: Option<Hit<T>>,
}

impl<T: Scalar> Nearest<T> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn search_tile<L: Lanes<T>>(
        &mut self,
        cells: &Wide<T>,
        mesh: &Mesh<T>,
        ray: &ShearedRay<T>,
        index: usize,
        room: &mut [[T; LANE_COUNT]; 3],
    ) {
        let tile = &cells.tiles[index];
        let positions = cells.positions_of::<L>(index, mesh, room);
        let [right, left] = ray.sides::<L>(positions, &tile.corners);
        let mut met = !(right & left) & tile.present;
        while met != 0 {
            let place = met.trailing_zeros() as usize;
            met &= met - 1;
            let corners = [0, 1, 2].map(|corner| {
                let vertex = usize::from(tile.corners[corner][place]) % TILE_SIZE;
                Vector3::new(positions[0][vertex], positions[1][vertex], positions[2][vertex])
            });
            let found = ray.intersect(&corners, tile.triangles[place]);
            if let Some(hit) = found.filter(|hit| hit.t <= self.end && self.hit.is_none_or(|n| hit.is_before(&n))) {
                (self.end, self.hit) = (hit.t, Some(hit));
            }
        }
    }
}

/// The places of the boxes that are met, the farthest first; gives how many.
#[cfg_attr(not(debug_assertions), inline(always))]
fn list_farthest_first<T: Scalar>(mut met: Mask, entries: &[T; CHILD_COUNT], places: &mut [u8; CHILD_COUNT]) -> usize {
    let mut count = 0;
    while met != 0 {
        let place = met.trailing_zeros() as u8;
        met &= met - 1;
        let entry = entries[usize::from(place)];
        let mut at = count;
        while at > 0 && entries[usize::from(places[at - 1]) % CHILD_COUNT] < entry {
            places[at] = places[at - 1];
            at -= 1;
        }
        places[at] = place;
        count += 1;
    }
    count
}

/// The planes of boxes as one ray meets them: a face at `x` is met at t = x · inverse + offset. As those of a packet, but that
/// it is known which of two faces comes first.
struct RaySlabs<T: Scalar> {
    inverse: Vector3<T>,
    /// For the lower and for the upper faces, each moved outward a little.
    offsets: [Vector3<T>; 2],
    /// A ray for which the above would overflow or underflow: taken to meet every box.
    meets_all: bool,
}

impl<T: Scalar> RaySlabs<T> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn new(ray: &Ray<T>, mesh_box: &Aabb<T>) -> Self {
        let reach = |axis: usize| {
            let (below, above) = (mesh_box.lower[axis] - ray.origin[axis], mesh_box.upper[axis] - ray.origin[axis]);
            larger(below.abs(), above.abs())
        };
        let [x, y, z] = [0, 1, 2].map(|axis| ray.origin[axis].abs());
        let coordinates = larger(larger(reach(0), reach(1)), reach(2)) + larger(larger(x, y), z);
        // Products with a coordinate are rounded as coarsely as it is far from zero.
        let moved = coordinates * margins::margin(margins::BOX_FACE);
        // Where a direction has no part along an axis, the face lies far behind every end; but finitely far.
        let lengths = larger(coordinates, T::one());
        let limit = T::LARGEST * T::of(0.5) / lengths;
        let inverse = ray.direction.map(|d| (T::one() / d).clamp(-limit, limit));
        let (length, [least, most]) = (ray.direction.amax(), reaches_told_apart());
        let offset = |from: Vector3<T>| -from.component_mul(&inverse);
        Self {
            inverse,
            offsets: [offset(ray.origin.add_scalar(moved)), offset(ray.origin.add_scalar(-moved))],
            meets_all: coordinates < length * least || lengths > length * most,
        }
    }

    /// Where the ray enters each child's box, and which of them it meets, not beyond its end.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn entering<L: Lanes<T>>(&self, node: &Node<T>, end: T) -> (L, Mask) {
        let present = ((1u32 << node.count) - 1) as Mask;
        let (mut enters, mut leaves) = (L::splat(T::zero()), L::splat(end));
        if self.meets_all {
            return (enters, present);
        }
        for axis in 0..3 {
            let inverse = L::splat(self.inverse[axis]);
            let [lower, upper] = [0, 1].map(|side| L::splat(self.offsets[side][axis]));
            let is_backward = self.inverse[axis] < T::zero();
            let (near, far) = if is_backward {
                ((&node.upper[axis], upper), (&node.lower[axis], lower))
            } else {
                ((&node.lower[axis], lower), (&node.upper[axis], upper))
            };
            enters = L::load(near.0).times_add(inverse, near.1).larger(enters);
            leaves = L::load(far.0).times_add(inverse, far.1).smaller(leaves);
        }
        (enters, enters.is_at_most(leaves) & present)
    }
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn larger<T: Scalar>(a: T, b: T) -> T {
    if a > b { a } else { b }
}
