use crate::bvh::node::{CHILD_COUNT, Node};
use crate::bvh::sought::{Nearest, Sought};
use crate::bvh::tile::Tile;
use crate::bvh::tree::Bvh;
use crate::bvh::walk::{Children, Visitor, Way, first_of};
use crate::math::{Aabb, Scalar};
use crate::mesh::Mesh;
use crate::simd::{Kernel, LANE_COUNT, Lanes, Lists, Mask, Vectors, lanes_of};
use crate::triangle::{NearTriangles, PointPacket, QueryPoint};

/// A search for what is near one point or many.
trait Seeker<T: Scalar> {
    /// Boxes farther than this squared distance from the centre do not count.
    fn limit(&self) -> T;

    /// For many points: the box around them, and its squared distance to boxes beyond which these do not count.
    fn around(&self) -> Option<(&Aabb<T>, T)>;

    /// Looks at the tiles of a leaf that are left.
    fn look<L: Lanes<T>>(&mut self, tree: &Bvh<T>, mesh: &Mesh<T>, leaf: &Node<T>, tiles: &Gaps<T>, left: Mask);
}

/// The squared distances of a node's children.
#[derive(Clone, Copy)]
struct Gaps<T> {
    /// From the centre.
    squares: [T; CHILD_COUNT],
    /// From the box around many points.
    around: [T; CHILD_COUNT],
}

/// Visits the tiles near a point, the nearest child first at each node.
struct Near<'a, T: Scalar, S> {
    tree: &'a Bvh<T>,
    mesh: &'a Mesh<T>,
    centre: &'a QueryPoint<T>,
    seeker: &'a mut S,
}

impl<T: Scalar, S: Seeker<T>> Near<'_, T, S> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn walk<L: Lanes<T>>(mut self) {
        let zeros = [T::zero(); CHILD_COUNT];
        Way::new(Gaps { squares: zeros, around: zeros }).walk::<T, L>(&mut self);
    }
}

impl<T: Scalar, L: Lanes<T>, S: Seeker<T>> Visitor<T, L> for Near<'_, T, S> {
    type Kept = Gaps<T>;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter(&mut self, node: u32, gaps: &mut Gaps<T>) -> Children {
        let mut room = None;
        let node = self.tree.node(node as usize, &mut room);
        gaps.measure::<L>(node, self.centre, self.seeker.around());
        let left = node.present();
        if !node.is_leaf {
            return Children { first: node.first, left };
        }
        let left = gaps.without_far::<L, S>(left, self.seeker);
        if left != 0 {
            self.seeker.look::<L>(self.tree, self.mesh, node, gaps, left);
        }
        Children::NONE
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn next(&mut self, gaps: &Gaps<T>, left: &mut Mask) -> Option<u32> {
        *left = gaps.without_far::<L, S>(*left, self.seeker);
        (*left != 0).then(|| gaps.take_nearest::<L>(left))
    }
}

impl<T: Scalar> Gaps<T> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn measure<L: Lanes<T>>(&mut self, node: &Node<T>, centre: &QueryPoint<T>, around: Option<(&Aabb<T>, T)>) {
        let factor = L::splat(centre.factor);
        let factor = Vectors::<T, L>::new(factor, factor, factor);
        let (lower, upper) = (Vectors::load(&node.lower), Vectors::load(&node.upper).negate());
        // Scaling is exact, so it does not matter whether the product is rounded before the sum.
        let centre = Vectors::splat(&centre.position);
        let apart = lower.times_add(factor, centre.negate()).larger(upper.times_add(factor, centre));
        let apart = apart.larger(Vectors::zeros());
        apart.dot(apart).store(&mut self.squares);
        if let Some((around, _)) = around {
            let below = lower.times_add(factor, Vectors::splat(&around.upper).negate());
            let above = upper.times_add(factor, Vectors::splat(&around.lower));
            let apart = below.larger(above).larger(Vectors::zeros());
            apart.dot(apart).store(&mut self.around);
        }
    }

    /// The children that are left and not beyond the limits.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn without_far<L: Lanes<T>, S: Seeker<T>>(&self, mut left: Mask, seeker: &S) -> Mask {
        left &= L::load(&self.squares).is_at_most(L::splat(seeker.limit()));
        if let Some((_, limit)) = seeker.around() {
            left &= L::load(&self.around).is_at_most(L::splat(limit));
        }
        left
    }

    /// Takes the child that is nearest to the centre from those that are left.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn take_nearest<L: Lanes<T>>(&self, left: &mut Mask) -> u32 {
        let squares = L::select(*left, L::load(&self.squares), L::splat(T::INFINITY));
        let nearest = squares.is_at_most(L::splat(squares.smallest())) & *left;
        *left &= !(nearest & nearest.wrapping_neg());
        nearest.trailing_zeros()
    }
}

/// The search for the triangle nearest to one point.
pub(crate) struct Closest<'a, T: Scalar, S> {
    pub(crate) tree: &'a Bvh<T>,
    pub(crate) mesh: &'a Mesh<T>,
    pub(crate) query: &'a QueryPoint<T>,
    pub(crate) nearest: &'a mut Nearest<T>,
    pub(crate) sought: S,
}

impl<T: Scalar, S: Sought> Kernel<T> for Closest<'_, T, S> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let limit = self.query.square_of_boxes(self.nearest.square);
        let cylinder_limit = self.query.square_of_cylinders(self.nearest.square);
        let Self { tree, mesh, query, nearest, sought } = self;
        let mut one = One { query, nearest, limit, cylinder_limit, sought };
        Near { tree, mesh, centre: query, seeker: &mut one }.walk::<L>();
    }
}

/// One point.
struct One<'a, T: Scalar, S> {
    query: &'a QueryPoint<T>,
    nearest: &'a mut Nearest<T>,
    limit: T,
    cylinder_limit: T,
    sought: S,
}

impl<T: Scalar, S: Sought> Seeker<T> for One<'_, T, S> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn limit(&self) -> T {
        self.limit
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn around(&self) -> Option<(&Aabb<T>, T)> {
        None
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn look<L: Lanes<T>>(&mut self, tree: &Bvh<T>, mesh: &Mesh<T>, leaf: &Node<T>, tiles: &Gaps<T>, mut left: Mask) {
        while left != 0 {
            let tile = leaf.first + tiles.take_nearest::<L>(&mut left);
            self.look_at::<L>(tree, mesh, tile as usize);
            left = tiles.without_far::<L, Self>(left, self);
        }
    }
}

impl<T: Scalar, S: Sought> One<'_, T, S> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn look_at<L: Lanes<T>>(&mut self, tree: &Bvh<T>, mesh: &Mesh<T>, index: usize) {
        let has_cylinder = tree.cylinders.made_from(index) & 1 == 1;
        if has_cylinder && !tree.cylinders.of(index).is_near(self.query, self.cylinder_limit) {
            return;
        }
        let sought = tree.sought::<L, S>(self.sought, index);
        if sought == 0 {
            return;
        }
        let mut room = [[T::zero(); LANE_COUNT]; 3];
        let positions = tree.positions_of::<L>(index, mesh, &mut room);
        let triangles = NearTriangles::<T, L>::new(positions, &tree.ascending[index], self.query.factor);
        let squares = triangles.squares(&self.query.position);
        if keep_nearest::<T, L>(tree, index, sought, squares, self.nearest) {
            self.limit = self.query.square_of_boxes(self.nearest.square);
            self.cylinder_limit = self.query.square_of_cylinders(self.nearest.square);
        }
    }
}

/// Points are neighbours if they are at most this many widths of a tile away from their middle, in a scale in which the mesh has
/// a size of about 1.
const MOST_SPREAD: f64 = 8.0;

/// The search for the triangles nearest to a packet's points.
pub(crate) struct ClosestOfPacket<'a, T: Scalar, S> {
    pub(crate) tree: &'a Bvh<T>,
    pub(crate) mesh: &'a Mesh<T>,
    pub(crate) packet: &'a mut PointPacket<T>,
    pub(crate) sought: S,
}

impl<T: Scalar, S: Sought> Kernel<T> for ClosestOfPacket<'_, T, S> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let Self { tree, mesh, packet, sought } = self;
        let centre = packet.centre;
        if packet.spread::<L>() * T::of(tree.tiles.len() as f64).sqrt() <= T::of(MOST_SPREAD) {
            Near { tree, mesh, centre: &centre, seeker: &mut Many { packet, sought } }.walk::<L>();
        } else {
            packet.centre_limit = -T::one();
        }
        if packet.centre_limit < T::zero() {
            for lane in lanes_of(packet.present) {
                let (query, mut nearest) = (packet.query(lane), nearest_of(packet, lane));
                L::outlined(Closest { tree, mesh, query: &query, nearest: &mut nearest, sought });
                keep(packet, lane, &nearest);
            }
        }
    }
}

/// What is known of one of the points.
#[cfg_attr(not(debug_assertions), inline(always))]
fn nearest_of<T: Scalar>(packet: &PointPacket<T>, lane: usize) -> Nearest<T> {
    let known = (packet.found >> lane & 1 == 1).then_some(packet.triangle[lane]);
    Nearest { square: packet.square[lane], triangle: known }
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn keep<T: Scalar>(packet: &mut PointPacket<T>, lane: usize, nearest: &Nearest<T>) {
    if let Some(triangle) = nearest.triangle {
        (packet.square[lane], packet.triangle[lane]) = (nearest.square, triangle);
        packet.found |= 1 << lane;
    }
}

/// The points of a packet.
struct Many<'a, T: Scalar, S> {
    packet: &'a mut PointPacket<T>,
    sought: S,
}

impl<T: Scalar, S: Sought> Seeker<T> for Many<'_, T, S> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn limit(&self) -> T {
        self.packet.centre_limit
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn around(&self) -> Option<(&Aabb<T>, T)> {
        Some((&self.packet.around, self.packet.greatest_limit))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn look<L: Lanes<T>>(&mut self, tree: &Bvh<T>, mesh: &Mesh<T>, leaf: &Node<T>, tiles: &Gaps<T>, mut left: Mask) {
        // The nearest first, whose triangles bound how near the others must be.
        let place = tiles.take_nearest::<L>(&mut left) as usize;
        let first = leaf.first as usize;
        let near = self.packet.near::<L>(&leaf.child_box(place));
        let mut looks = near.count_ones();
        let made = tree.cylinders.made_from(first);
        let bounds = self.bounds_to::<L>(tree, first + place, made >> place);
        self.look_at::<L>(tree, mesh, first + place, near, bounds);
        left = tiles.without_far::<L, Self>(left, self);
        let looked_at = 1 + left.count_ones();
        // Then all bounds without a branch, so that none has to wait for another.
        let (mut near, mut found) = ([0; CHILD_COUNT], 0);
        while let Some(place) = first_of(&mut left) {
            let place = place as usize;
            near[place] = self.packet.near::<L>(&leaf.child_box(place));
            self.bounds_to::<L>(tree, first + place, made >> place).store(&mut self.packet.tile_bounds[place]);
            looks += near[place].count_ones();
            found |= Mask::from(near[place] != 0) << place;
        }
        while let Some(place) = first_of(&mut found) {
            let place = place as usize;
            let bounds = L::load(&self.packet.tile_bounds[place]);
            self.look_at::<L>(tree, mesh, first + place, near[place], bounds);
        }
        self.packet.count_looks(looked_at, looks);
    }
}

impl<T: Scalar, S: Sought> Many<'_, T, S> {
    /// Lower bounds of the squared distances to a tile; the lowest bit of `made` says whether it has a cylinder.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn bounds_to<L: Lanes<T>>(&self, tree: &Bvh<T>, index: usize, made: Mask) -> L {
        let is_made = made & 1 == 1;
        if is_made { tree.cylinders.of(index).squares::<L>(self.packet) } else { L::splat(T::zero()) }
    }

    /// Looks at a tile for the points near its box that may be near enough by these lower bounds.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn look_at<L: Lanes<T>>(&mut self, tree: &Bvh<T>, mesh: &Mesh<T>, index: usize, near: Mask, bounds: L) {
        let packet = &mut *self.packet;
        let near = near & bounds.is_at_most(L::load(&packet.cylinder_limit));
        if near == 0 {
            return;
        }
        let sought = tree.sought::<L, S>(self.sought, index);
        if sought == 0 {
            return;
        }
        let mut room = [[T::zero(); LANE_COUNT]; 3];
        let positions = tree.positions_of::<L>(index, mesh, &mut room);
        let triangles = NearTriangles::<T, L>::new(positions, &tree.ascending[index], packet.centre.factor);
        // Here too all first, and only then which are nearer.
        let mut smallest = [T::INFINITY; LANE_COUNT];
        for lane in lanes_of(near) {
            let squares = L::select(sought, triangles.squares(&packet.point(lane)), L::splat(T::INFINITY));
            squares.store(&mut packet.squares[lane]);
            smallest[lane] = squares.smallest();
        }
        packet.keep_nearer::<L>(near, sought, &smallest, &tree.tiles[index].triangles);
    }
}

impl<T: Scalar> Bvh<T> {
    /// Finds the triangle nearest to the point.
    pub(crate) fn find_closest(
        &self,
        mesh: &Mesh<T>,
        query: &QueryPoint<T>,
        sought: impl Sought,
        nearest: &mut Nearest<T>,
    ) {
        crate::simd::dispatch::<T, _>(Closest { tree: self, mesh, query, nearest, sought });
    }

    /// The same on some lanes.
    #[cfg(all(test, target_arch = "x86_64"))]
    pub(crate) fn find_closest_with<L: Lanes<T>>(
        &self,
        mesh: &Mesh<T>,
        query: &QueryPoint<T>,
        nearest: &mut Nearest<T>,
    ) {
        L::outlined(Closest { tree: self, mesh, query, nearest, sought: crate::bvh::All });
    }

    /// Finds the nearest triangles of a packet's points.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn find_closest_of_packet<L: Lanes<T>>(
        &self,
        mesh: &Mesh<T>,
        sought: impl Sought,
        packet: &mut PointPacket<T>,
    ) {
        L::outlined(ClosestOfPacket { tree: self, mesh, packet, sought });
    }

    /// Which of a tile's triangles are sought.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sought<L: Lanes<T>, S: Sought>(&self, sought: S, tile: usize) -> Mask {
        let Tile { present, corners, .. } = &self.tiles[tile];
        let mut own = 0;
        for place in lanes_of(sought.excluded::<T, L>(&self.outlines[tile].vertices)) {
            own |= L::Lists::with_corner(corners, place as u8);
        }
        present & !own
    }
}

/// Keeps the nearest of a tile's triangles that are sought, if it is nearer than what is known; gives whether it is.
#[cfg_attr(not(debug_assertions), inline(always))]
fn keep_nearest<T: Scalar, L: Lanes<T>>(
    tree: &Bvh<T>,
    index: usize,
    sought: Mask,
    squares: L,
    nearest: &mut Nearest<T>,
) -> bool {
    let tile = &tree.tiles[index];
    let squares = L::select(sought, squares, L::splat(T::INFINITY));
    let smallest = squares.smallest();
    if smallest > nearest.square {
        return false;
    }
    for place in lanes_of(squares.is_at_most(L::splat(smallest)) & sought) {
        nearest.keep_nearer(smallest, tile.triangles[place]);
    }
    true
}
