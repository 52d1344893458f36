//! Which tiles of a body lie outside another body as a whole, so that no ray from them can start inside it.
//!
//! A tile whose box meets no tile's box of the other, closed body lies on one side of that body. Two such tiles whose boxes meet
//! lie on the same side. So one point tells the side of all tiles whose boxes are connected.

#[cfg(all(test, target_arch = "x86_64"))]
pub(crate) mod tests;

use crate::bvh::node::{BoxLanes, CHILD_COUNT, Node};
use crate::bvh::rays::packet::candidates::Candidates;
use crate::bvh::tree::Bvh;
use crate::bvh::walk::{Children, Visitor, Way, first_of};
use crate::math::{Aabb, Scalar, Vector3, margins};
use crate::memory::Room;
use crate::mesh::Mesh;
use crate::simd::{Kernel, LANE_COUNT, Lanes, Mask, Vectors, lanes_of, vector_in_lane};
use crate::triangle::{Ray, RayPacket};

/// The boxes of a leaf are held against those of this many leaves before it, which nearly always are its neighbours.
const LEAVES_KEPT: usize = 8;

/// Scratch memory of the search.
#[derive(Clone, Debug, Default)]
pub(crate) struct SidesScratch<T: Scalar> {
    parts: Vec<Part>,
    /// A point of each part that was connected with none before it.
    points: Vec<Vector3<T>>,
    /// Whether each of the points lies inside the other body.
    is_inside: Vec<bool>,
}

/// Some of the tiles of a leaf, all on one side of the other body or all near its surface.
#[derive(Clone, Copy, Debug)]
struct Part {
    /// The leaf's first tile.
    first: u32,
    tiles: Mask,
    /// Which of the points tells the side; [`NEAR`] where the tiles may meet the surface.
    point: u32,
}

const NEAR: u32 = u32::MAX;

/// Finds the tiles of a body in a region, without those that lie outside another body as a whole.
pub(crate) struct TilesNotOutside<'a, T: Scalar> {
    pub(crate) own: &'a Bvh<T>,
    /// The other body, closed.
    pub(crate) other: &'a Bvh<T>,
    pub(crate) mesh: &'a Mesh<T>,
    pub(crate) region: &'a Aabb<T>,
    pub(crate) tiles: &'a mut Vec<u32>,
    pub(crate) scratch: &'a mut SidesScratch<T>,
}

impl<T: Scalar> Kernel<T> for TilesNotOutside<'_, T> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let Self { own, other, mesh, region, tiles, scratch } = self;
        let leaves = LeavesIn::<T, L>::new(own, mesh.aabb(), region);
        Way::new(()).walk(&mut Dividing { leaves, sides: Sides::new(scratch), other });
        scratch.ask::<L>(other, mesh, region);
        let SidesScratch { parts, is_inside, .. } = scratch;
        for of_leaf in parts.chunk_by(|a, b| a.first == b.first) {
            let mut kept = 0;
            for part in of_leaf {
                if part.point == NEAR || is_inside[part.point as usize] {
                    kept |= part.tiles;
                }
            }
            while let Some(place) = first_of(&mut kept) {
                tiles.room_for(1).push(of_leaf[0].first + place);
            }
        }
    }
}

/// Whether any of a body's tiles in a region may meet the surface of another.
pub(crate) struct MayMeet<'a, T: Scalar> {
    pub(crate) own: &'a Bvh<T>,
    pub(crate) other: &'a Bvh<T>,
    pub(crate) mesh: &'a Mesh<T>,
    pub(crate) region: &'a Aabb<T>,
}

impl<T: Scalar> Kernel<T> for MayMeet<'_, T> {
    type Output = bool;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) -> bool {
        let Self { own, other, mesh, region } = self;
        let mut meeting = Meeting { leaves: LeavesIn::<T, L>::new(own, mesh.aabb(), region), other, may_meet: false };
        Way::new(()).walk(&mut meeting);
        meeting.may_meet
    }
}

impl<T: Scalar> SidesScratch<T> {
    /// Asks for each point whether the mesh winds around it.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn ask<L: Lanes<T>>(&mut self, tree: &Bvh<T>, mesh: &Mesh<T>, region: &Aabb<T>) {
        self.is_inside.clear();
        if self.points.is_empty() {
            return;
        }
        let (way_out, length) = way_out(region, mesh.aabb());
        let (mut packet, mut list) = (RayPacket::empty(), Candidates::new());
        let touched = [[NEAR; LANE_COUNT]; 3];
        for points in self.points.chunks(LANE_COUNT) {
            let mut rays = [Ray { origin: points[0], direction: way_out, t_max: length }; LANE_COUNT];
            for (ray, point) in rays.iter_mut().zip(points) {
                ray.origin = *point;
            }
            packet.set_rays::<L>(&rays[..points.len()]);
            let mut numbers = [0; LANE_COUNT];
            tree.windings::<L>(mesh, &packet, &touched, &mut list, &mut numbers);
            let is_inside = self.is_inside.room_for(points.len());
            for number in &numbers[..points.len()] {
                is_inside.push(*number > 0);
            }
        }
    }
}

/// The direction along an axis by which the box around a mesh is left soonest from a region, and a length that leads out of the
/// box from everywhere in the region.
fn way_out<T: Scalar>(region: &Aabb<T>, around: &Aabb<T>) -> (Vector3<T>, T) {
    let (mut best, mut shortest) = (Vector3::z(), T::INFINITY);
    for axis in 0..3 {
        let up = around.upper[axis] - region.lower[axis];
        let down = region.upper[axis] - around.lower[axis];
        let (length, sign) = if up < down { (up, T::one()) } else { (down, -T::one()) };
        if length < shortest {
            (best, shortest) = (Vector3::zeros(), length);
            best[axis] = sign;
        }
    }
    (best, shortest + around.longest_side())
}

/// The search for parts on one side.
struct Sides<'a, T: Scalar> {
    scratch: &'a mut SidesScratch<T>,
    /// The boxes of the last leaves, which of them do not meet the surface, and by box the point that tells its side.
    leaves: [(LeafBoxes<T>, Mask); LEAVES_KEPT],
    points: [[u32; CHILD_COUNT]; LEAVES_KEPT],
    next: usize,
}

impl<'a, T: Scalar> Sides<'a, T> {
    fn new(scratch: &'a mut SidesScratch<T>) -> Self {
        scratch.parts.clear();
        scratch.points.clear();
        let leaves = [(LeafBoxes::empty(), 0); LEAVES_KEPT];
        Sides { scratch, leaves, points: [[NEAR; CHILD_COUNT]; LEAVES_KEPT], next: 0 }
    }

    /// Divides some tiles of a leaf into parts.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn add<L: Lanes<T>>(&mut self, boxes: LeafBoxes<T>, tiles: Mask, first: u32, other: &Bvh<T>) {
        let touching = boxes.touching::<L>(other, tiles);
        let near = touching.unwrap_or(0);
        if near != 0 {
            self.scratch.parts.room_for(1).push(Part { first, tiles: near, point: NEAR });
        }
        let mut left = tiles & !near;
        if left == 0 {
            return;
        }
        let place = self.next;
        self.next = (self.next + 1) % LEAVES_KEPT;
        let mut points = [NEAR; CHILD_COUNT];
        while left != 0 {
            // Where not even the box around all meets anything, they are one part.
            let part = match touching {
                Some(_) => connected::<T, L>(&boxes, left.trailing_zeros() as usize, left),
                None => left,
            };
            left &= !part;
            let point = self.point_of::<L>(&boxes, part);
            self.scratch.parts.room_for(1).push(Part { first, tiles: part, point });
            for place in lanes_of(part) {
                points[place] = point;
            }
        }
        (self.leaves[place], self.points[place]) = ((boxes, tiles & !near), points);
    }

    /// Which point tells the side of connected boxes.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn point_of<L: Lanes<T>>(&mut self, boxes: &LeafBoxes<T>, connected: Mask) -> u32 {
        for place in lanes_of(connected) {
            let aabb = boxes.aabb(place);
            for ((known, clear), points) in self.leaves.iter().zip(&self.points) {
                let met = known.meeting::<L>(&aabb) & clear;
                if met != 0 {
                    return points[met.trailing_zeros() as usize];
                }
            }
        }
        let points = self.scratch.points.room_for(1);
        points.push(boxes.aabb(connected.trailing_zeros() as usize).centre());
        points.len() as u32 - 1
    }
}

/// The leaves that have tiles in a region.
struct LeavesIn<'a, T: Scalar, L> {
    tree: &'a Bvh<T>,
    region: BoxLanes<T, L>,
    clip: Aabb<T>,
    /// By how much boxes are grown, so that boxes that do not meet lie apart for certain.
    apart: T,
}

/// What lies under a node in a region.
enum Under<T: Scalar> {
    Nodes(Children),
    /// The boxes of a leaf's tiles, and which of those lie in the region.
    Tiles(LeafBoxes<T>, Children),
}

impl<'a, T: Scalar, L: Lanes<T>> LeavesIn<'a, T, L> {
    /// `around` is the box of the body that they are held against.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn new(tree: &'a Bvh<T>, around: &Aabb<T>, region: &Aabb<T>) -> Self {
        let largest = region.lower.amax().max(region.upper.amax());
        // One margin for each of the two surfaces.
        let apart = (largest + around.longest_side()) * margins::margin(2.0 * margins::SEEN_POSITION);
        Self { tree, region: BoxLanes::new(region), clip: region.grown(apart), apart }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn under(&self, node: u32) -> Under<T> {
        let mut room = None;
        let node = self.tree.node(node as usize, &mut room);
        let children = Children { first: node.first, left: node.meets(&self.region) };
        if node.is_leaf && children.left != 0 {
            Under::Tiles(LeafBoxes::new::<L>(node, &self.clip, self.apart), children)
        } else {
            Under::Nodes(if node.is_leaf { Children::NONE } else { children })
        }
    }
}

/// Divides the tiles of each leaf by their sides.
struct Dividing<'a, T: Scalar, L> {
    leaves: LeavesIn<'a, T, L>,
    sides: Sides<'a, T>,
    other: &'a Bvh<T>,
}

impl<T: Scalar, L: Lanes<T>> Visitor<T, L> for Dividing<'_, T, L> {
    type Kept = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter(&mut self, node: u32, (): &mut ()) -> Children {
        match self.leaves.under(node) {
            Under::Nodes(children) => children,
            Under::Tiles(boxes, Children { first, left }) => {
                self.sides.add::<L>(boxes, left, first, self.other);
                Children::NONE
            }
        }
    }
}

/// Holds the tiles of each leaf against those of the other body, until any meet.
struct Meeting<'a, T: Scalar, L> {
    leaves: LeavesIn<'a, T, L>,
    other: &'a Bvh<T>,
    may_meet: bool,
}

impl<T: Scalar, L: Lanes<T>> Visitor<T, L> for Meeting<'_, T, L> {
    type Kept = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter(&mut self, node: u32, (): &mut ()) -> Children {
        match self.leaves.under(node) {
            _ if self.may_meet => Children::NONE,
            Under::Nodes(children) => children,
            Under::Tiles(boxes, Children { left, .. }) => {
                self.may_meet = boxes.touching::<L>(self.other, left).unwrap_or(0) != 0;
                Children::NONE
            }
        }
    }
}

/// The boxes of a leaf's tiles, as far as they lie in a region, and a little larger.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct LeafBoxes<T: Scalar> {
    lower: [[T; CHILD_COUNT]; 3],
    upper: [[T; CHILD_COUNT]; 3],
}

impl<T: Scalar> LeafBoxes<T> {
    fn empty() -> Self {
        let zeros = [[T::zero(); CHILD_COUNT]; 3];
        Self { lower: zeros, upper: zeros }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn new<L: Lanes<T>>(leaf: &Node<T>, region: &Aabb<T>, larger: T) -> Self {
        let mut boxes = Self::empty();
        let [lower, upper] = leaf.corners::<L>();
        let larger = Vectors::splat(&Vector3::repeat(larger));
        lower.sub(larger).larger(Vectors::splat(&region.lower)).store(&mut boxes.lower);
        upper.add(larger).smaller(Vectors::splat(&region.upper)).store(&mut boxes.upper);
        boxes
    }

    /// Which of them meet a box.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn meeting<L: Lanes<T>>(&self, aabb: &Aabb<T>) -> Mask {
        Vectors::<T, L>::load(&self.lower).are_at_most(Vectors::splat(&aabb.upper))
            & Vectors::<T, L>::splat(&aabb.lower).are_at_most(Vectors::load(&self.upper))
    }

    fn aabb(&self, place: usize) -> Aabb<T> {
        Aabb { lower: vector_in_lane(&self.lower, place), upper: vector_in_lane(&self.upper, place) }
    }

    /// A box around some of them.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn around<L: Lanes<T>>(&self, some: Mask) -> Aabb<T> {
        let endless = Vectors::<T, L>::splat(&Vector3::repeat(T::INFINITY));
        Aabb {
            lower: Vectors::select(some, Vectors::load(&self.lower), endless).smallest_lanes(),
            upper: Vectors::select(some, Vectors::load(&self.upper), endless.negate()).greatest_lanes(),
        }
    }

    /// Which of the boxes in `asked` meet the box of any tile of the other body; `None` where not even the box around them does.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn touching<L: Lanes<T>>(&self, other: &Bvh<T>, asked: Mask) -> Option<Mask> {
        let around = BoxLanes::<T, L>::new(&self.around::<L>(asked));
        let mut touching = Touching { boxes: self, other, around, asked, touching: 0, are_apart: true };
        Way::new(()).walk(&mut touching);
        (!touching.are_apart).then_some(touching.touching & asked)
    }
}

/// Holds boxes against the tiles of the other body, until all that are asked about have met one.
struct Touching<'a, T: Scalar, L> {
    boxes: &'a LeafBoxes<T>,
    other: &'a Bvh<T>,
    around: BoxLanes<T, L>,
    asked: Mask,
    touching: Mask,
    are_apart: bool,
}

impl<T: Scalar, L: Lanes<T>> Visitor<T, L> for Touching<'_, T, L> {
    type Kept = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter(&mut self, node: u32, (): &mut ()) -> Children {
        let mut room = None;
        let node = self.other.node(node as usize, &mut room);
        let mut left = node.meets(&self.around);
        if !node.is_leaf {
            return Children { first: node.first, left };
        }
        self.are_apart &= left == 0;
        while let Some(place) = first_of(&mut left) {
            self.touching |= self.boxes.meeting::<L>(&node.child_box(place as usize));
        }
        Children::NONE
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn next(&mut self, (): &(), left: &mut Mask) -> Option<u32> {
        if self.touching & self.asked == self.asked { None } else { first_of(left) }
    }
}

/// The boxes among `some` that are connected with the first, which is one of them.
#[cfg_attr(not(debug_assertions), inline(always))]
fn connected<T: Scalar, L: Lanes<T>>(boxes: &LeafBoxes<T>, first: usize, some: Mask) -> Mask {
    let (mut found, mut left): (Mask, Mask) = (0, 1 << first);
    while left != 0 {
        let place = left.trailing_zeros() as usize;
        found |= 1 << place;
        left = (left | boxes.meeting::<L>(&boxes.aabb(place)) & some) & !found;
    }
    found
}
