use crate::bvh::{Bvh, CHILD_COUNT, Node, TILE_SIZE};
use crate::math::margins::{self, reaches_told_apart};
use crate::math::{Aabb, Scalar, Vector3};
use crate::mesh::Mesh;
use crate::simd::{Kernel, LANE_COUNT, Lanes, Mask};
use crate::triangle::{Hit, ProjectedTriangles, Ray, ShearedRay};

/// One ray's way to where it first meets the mesh: the nearest boxes first, none beyond the nearest hit known. So many nodes
/// may wait at once.
pub(crate) struct NearestOfRay<'a, T: Scalar, R, F, const MOST_WAITING: usize> {
    pub(crate) cells: &'a Bvh<T>,
    pub(crate) mesh: &'a Mesh<T>,
    // Made a ray only here, and its hit used here: numbers that are read right after they were written in other pieces keep
    // the processor waiting.
    pub(crate) ray: R,
    pub(crate) then: F,
}

/// A tree of no more than so many nodes has at most three levels below the root, since all but the last node of a level are
/// full, and fifteen may wait on each: less room to clear, for every ray, than any tree may need.
pub(crate) const FEW_NODES: usize = 1 + 16 + 256 + 4096;
pub(crate) const FEW_WAITING: usize = 3 * (CHILD_COUNT - 1) + 1;

/// A node that the ray may meet.
#[derive(Clone, Copy)]
struct Waiting<T> {
    /// Where the ray enters its box.
    entry: T,
    node: u32,
}

impl<T, R, F, O, const MOST_WAITING: usize> Kernel<T> for NearestOfRay<'_, T, R, F, MOST_WAITING>
where
    T: Scalar,
    R: Into<Ray<T>>,
    F: FnOnce(Option<Hit<T>>) -> O,
{
    type Output = O;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) -> O {
        let Self { cells, mesh, ray, then } = self;
        let ray = &ray.into();
        let slabs = RaySlabs::new(ray, mesh.aabb());
        let sheared = ShearedRay::new(ray);
        let mut nearest = Nearest { end: ray.t_max, hit: None };
        let mut room = [[T::zero(); LANE_COUNT]; 3];
        let mut entries = [T::zero(); CHILD_COUNT];
        let mut stack = [Waiting { entry: T::zero(), node: 0 }; MOST_WAITING];
        let mut moved = None;
        // The root.
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let Waiting { entry, node } = stack[waiting];
            if entry > nearest.end {
                continue;
            }
            let node = cells.node(node as usize, &mut moved);
            let (enters, mut met) = slabs.entering::<L>(node, nearest.end);
            enters.store(&mut entries);
            if node.is_leaf {
                // The nearest tile first, the others as they come.
                let mut place = nearest_of(met, &entries);
                while met != 0 {
                    met &= !(1 << place);
                    if nearest.search_tile::<L>(cells, mesh, &sheared, (node.first + place) as usize, &mut room) {
                        met &= enters.is_at_most(L::splat(nearest.end));
                    }
                    place = met.trailing_zeros();
                }
            } else {
                // The nearest on top.
                let bottom = waiting;
                while met != 0 {
                    let place = met.trailing_zeros();
                    met &= met - 1;
                    let entry = entries[place as usize % CHILD_COUNT];
                    let mut at = waiting;
                    while at > bottom && stack[at - 1].entry < entry {
                        stack[at] = stack[at - 1];
                        at -= 1;
                    }
                    stack[at] = Waiting { entry, node: node.first + place };
                    waiting += 1;
                }
            }
        }
        then(nearest.hit)
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
        cells: &Bvh<T>,
        mesh: &Mesh<T>,
        ray: &ShearedRay<T>,
        index: usize,
        room: &mut [[T; LANE_COUNT]; 3],
    ) -> bool {
        let tile = &cells.tiles[index];
        let positions = cells.positions_of::<L>(index, mesh, room);
        let (may_meet, vertices) = ray.may_meet::<L>(positions, &tile.corners);
        let mut met = may_meet & tile.present;
        if met == 0 {
            return false;
        }
        let mut is_nearer = false;
        let triangles = ProjectedTriangles::new::<L>(vertices, &tile.corners);
        while met != 0 {
            let place = met.trailing_zeros() as usize % TILE_SIZE;
            met &= met - 1;
            let found = triangles.intersect(place, tile.triangles[place]);
            if let Some(hit) = found.filter(|hit| hit.t <= self.end && self.hit.is_none_or(|n| hit.is_before(&n))) {
                (self.end, self.hit, is_nearer) = (hit.t, Some(hit), true);
            }
        }
        is_nearer
    }
}

/// The place of the box that is entered first, of those that are met.
#[cfg_attr(not(debug_assertions), inline(always))]
fn nearest_of<T: Scalar>(mut met: Mask, entries: &[T; CHILD_COUNT]) -> u32 {
    let mut nearest = met.trailing_zeros();
    met &= met.wrapping_sub(1);
    while met != 0 {
        let place = met.trailing_zeros();
        met &= met - 1;
        if entries[place as usize % CHILD_COUNT] < entries[nearest as usize % CHILD_COUNT] {
            nearest = place;
        }
    }
    nearest
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
