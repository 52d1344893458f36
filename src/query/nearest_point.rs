#[cfg(all(test, target_arch = "x86_64"))]
pub(crate) mod tests;

use crate::bvh::{All, Beyond, Nearest, Sought};
use crate::math::{Scalar, Vector3};
use crate::memory;
use crate::mesh::Mesh;
use crate::query::octree::Tree;
use crate::query::point_order::{BLOCK, PointOrder};
use crate::query::tracer::Tracer;
use crate::simd::{Kernel, LANE_COUNT, Lanes, Mask, Vectors, dispatch, lanes_of, vector_in_lane};
use crate::triangle::{ClosestPoint, MeshScale, PointPacket, QueryPoint, TrianglePoint, TrianglePoints, ascending};

impl<T: Scalar> Tracer<'_, T> {
    /// The point of the surface that is nearest to `point`, if it is at most `bound` away (which may be infinite); of
    /// several, the one on the triangle with the smallest index. `None` too where the point or the bound is NaN, or the
    /// point infinite. It is the same to the bit as [`closest_point_of_all`](Self::closest_point_of_all).
    ///
    /// The distance is right to within 64 rounding units of the reach, the largest coordinate difference between the
    /// point and the mesh's box, however thin the triangles; on a shared edge or vertex all triangles there agree to the bit.
    /// Scaling mesh, point and bound by a power of two scales it exactly.
    pub fn closest_point(&self, point: &Vector3<T>, bound: T) -> Option<ClosestPoint<T>> {
        self.closest_point_of(point, bound, All)
    }

    fn closest_point_of(&self, point: &Vector3<T>, bound: T, sought: impl Sought) -> Option<ClosestPoint<T>> {
        let query = QueryPoint::new(point, &MeshScale::new(self.mesh().aabb()))?;
        let mut nearest = Nearest::within(&query, bound);
        match self.tree {
            Tree::Bvh(tree) => tree.find_closest(self.mesh(), &query, sought, &mut nearest),
            Tree::PaperOctree(tree) => tree.visit_near(&query, nearest.square, &mut |triangle| {
                if sought.includes(self.mesh().topology().triangles()[triangle as usize]) {
                    nearest.keep_nearer(self.square_to(&query, triangle), triangle);
                }
                nearest.square
            }),
        }
        self.resolved(&query, &nearest, bound)
    }

    /// [`closest_point`](Self::closest_point) by testing every triangle, without the octree: slow, and the standard it is
    /// held to.
    pub fn closest_point_of_all(&self, point: &Vector3<T>, bound: T) -> Option<ClosestPoint<T>> {
        let query = QueryPoint::new(point, &MeshScale::new(self.mesh().aabb()))?;
        let mut nearest = Nearest::within(&query, bound);
        for triangle in 0..self.mesh().topology().triangles().len() as u32 {
            nearest.keep_nearer(self.square_to(&query, triangle), triangle);
        }
        self.resolved(&query, &nearest, bound)
    }

    /// [`closest_point`](Self::closest_point) of each of many points, each with a bound of its own, into `found`, which is
    /// cleared first.
    ///
    /// # Panics
    /// Where there are not as many bounds as points.
    pub fn closest_points(&self, points: &[Vector3<T>], bounds: &[T], found: &mut Vec<Option<ClosestPoint<T>>>) {
        assert_eq!(points.len(), bounds.len(), "each point has a bound");
        memory::refill_with(found, None, points.len());
        dispatch::<T, _>(ClosestPoints { tracer: self, points, bounds, sought: All, found });
    }

    /// The same without the triangles that have a vertex of one part of the surface, given the part of each vertex. `found` has
    /// as many elements as there are points.
    pub(crate) fn closest_points_beyond(
        &self,
        (parts, part): (&[u32], u32),
        points: &[Vector3<T>],
        bounds: &[T],
        found: &mut [Option<ClosestPoint<T>>],
    ) {
        dispatch::<T, _>(ClosestPoints { tracer: self, points, bounds, sought: Beyond { parts, part }, found });
    }

    /// The point of one triangle that is nearest to a point.
    pub(crate) fn closest_on(&self, triangle: u32, point: &Vector3<T>) -> Option<ClosestPoint<T>> {
        Some(self.on_triangle(&QueryPoint::new(point, &MeshScale::new(self.mesh().aabb()))?, triangle))
    }

    fn on_triangle(&self, query: &QueryPoint<T>, triangle: u32) -> ClosestPoint<T> {
        let (corners, places) = self.ascending_corners(triangle);
        TrianglePoint::new(query, &corners).resolved(query, triangle, &corners, places)
    }

    /// The squared distance of one triangle.
    fn square_to(&self, query: &QueryPoint<T>, triangle: u32) -> T {
        TrianglePoint::new(query, &self.ascending_corners(triangle).0).square
    }

    /// The corners of a triangle in ascending order of their vertices, and their places in it.
    fn ascending_corners(&self, triangle: u32) -> ([Vector3<T>; 3], [usize; 3]) {
        let corners = self.mesh().corners(triangle);
        let places = ascending(self.mesh().topology().triangles()[triangle as usize]);
        (places.map(|place| corners[place]), places)
    }

    fn resolved(&self, query: &QueryPoint<T>, nearest: &Nearest<T>, bound: T) -> Option<ClosestPoint<T>> {
        let found = self.on_triangle(query, nearest.triangle?);
        // Squares are rounded: the root decides.
        (found.distance <= bound).then_some(found)
    }
}

/// How far up to sixteen points are from a surface, and scratch memory for finding out.
#[derive(Clone, Debug)]
pub(crate) struct PointDistances<T: Scalar> {
    packet: PointPacket<T>,
    /// Whether `packet` holds the answers: the points were asked about together.
    are_of_packet: bool,
    pub(crate) distances: [T; LANE_COUNT],
    nearest: PacketPoints<T>,
}

impl<T: Scalar> PointDistances<T> {
    pub(crate) fn new() -> Self {
        let (packet, nearest) = (PointPacket::empty(), PacketPoints::empty());
        Self { packet, are_of_packet: false, distances: [T::zero(); LANE_COUNT], nearest }
    }

    /// The triangle that a lane's distance is to, where it was found within the bound.
    pub(crate) fn triangle(&self, lane: usize) -> Option<u32> {
        (self.are_of_packet && self.packet.found >> lane & 1 == 1).then(|| self.packet.triangle[lane])
    }
}

/// The nearest points on the triangles that the search for a packet has found.
#[derive(Clone, Debug)]
struct PacketPoints<T: Scalar> {
    points: TrianglePoints<T>,
    /// By lane the places of its triangle's corners, in ascending order of their vertices.
    places: [[usize; 3]; LANE_COUNT],
}

impl<T: Scalar> PacketPoints<T> {
    fn empty() -> Self {
        Self { points: TrianglePoints::empty(), places: [[0; 3]; LANE_COUNT] }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn set<L: Lanes<T>>(&mut self, mesh: &Mesh<T>, packet: &PointPacket<T>, factors: [T; 2]) {
        // Lanes without a triangle take the first one.
        let triangles = mesh.topology().triangles();
        let mut corners = [[0; LANE_COUNT]; 3];
        for lane in 0..LANE_COUNT {
            let has_one = packet.found >> lane & 1 == 1;
            let vertices = triangles[if has_one { packet.triangle[lane] as usize } else { 0 }];
            self.places[lane] = ascending(vertices);
            for corner in 0..3 {
                corners[corner][lane] = vertices[self.places[lane][corner]];
            }
        }
        let a = mesh.gather::<L>(&corners[0]);
        let b = mesh.gather::<L>(&corners[1]);
        let c = mesh.gather::<L>(&corners[2]);
        self.points.set::<L>(&packet.position, [a, b, c], factors);
    }

    /// The nearest point of one lane, if it is at most `bound` away.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn get(&self, packet: &PointPacket<T>, lane: usize, bound: T) -> Option<ClosestPoint<T>> {
        // Squares are rounded: the root decides.
        let is_found = packet.found >> lane & 1 == 1 && self.points.distance[lane] <= bound;
        is_found.then(|| self.points.get(lane, packet.triangle[lane], self.places[lane]))
    }
}

impl<T: Scalar> Tracer<'_, T> {
    /// How far the points in `asked` are from the surface, given upper bounds of their distances.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn distances_of_packet<L: Lanes<T>>(
        &self,
        points: &[[T; LANE_COUNT]; 3],
        asked: Mask,
        bounds: &[T; LANE_COUNT],
        room: &mut PointDistances<T>,
    ) {
        let PointDistances { packet, are_of_packet, distances, .. } = room;
        *distances = *bounds;
        *are_of_packet = false;
        if asked == 0 {
            return;
        }
        let scale = MeshScale::new(self.mesh().aabb());
        if let Tree::Bvh(tree) = self.tree
            && packet.set_lanes::<L>(points, asked, bounds, &scale)
        {
            tree.find_closest_of_packet::<L>(self.mesh(), All, packet);
            let found = packet.found & asked;
            let squares = L::load(&packet.square);
            let roots = squares.sqrt().mul(L::splat(scale.factors[1]));
            L::select(found, roots.smaller(L::load(bounds)), L::load(bounds)).store(distances);
            *are_of_packet = true;
            return;
        }
        for lane in lanes_of(asked) {
            if let Some(nearest) = self.closest_point(&vector_in_lane(points, lane), bounds[lane]) {
                distances[lane] = nearest.distance;
            }
        }
    }

    /// How far each of up to sixteen points is from one triangle, into `distances`; `room` is scratch memory.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn distances_to_triangles<L: Lanes<T>>(
        &self,
        points: &[[T; LANE_COUNT]; 3],
        triangles: &[u32; LANE_COUNT],
        distances: &mut [T; LANE_COUNT],
        room: &mut PointDistances<T>,
    ) {
        let factors = MeshScale::new(self.mesh().aabb()).factors;
        let PointDistances { packet, nearest, .. } = room;
        Vectors::<T, L>::load(points).scaled(L::splat(factors[0])).store(&mut packet.position);
        (packet.triangle, packet.found) = (*triangles, Mask::MAX);
        nearest.set::<L>(self.mesh(), packet, factors);
        *distances = nearest.points.distance;
    }
}

/// [`Tracer::closest_points`].
struct ClosestPoints<'a, 'b, T: Scalar, S> {
    tracer: &'a Tracer<'b, T>,
    points: &'a [Vector3<T>],
    bounds: &'a [T],
    sought: S,
    found: &'a mut [Option<ClosestPoint<T>>],
}

impl<T: Scalar, S: Sought> Kernel<T> for ClosestPoints<'_, '_, T, S> {
    type Output = ();

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run<L: Lanes<T>>(self) {
        let mesh = self.tracer.mesh();
        let scale = MeshScale::new(mesh.aabb());
        let (mut packet, mut nearest) = (PointPacket::empty(), PacketPoints::empty());
        let blocks = self.points.chunks(BLOCK).zip(self.bounds.chunks(BLOCK));
        for ((points, bounds), found) in blocks.zip(self.found.chunks_mut(BLOCK)) {
            for places in PointOrder::new(points).places().chunks(LANE_COUNT) {
                if let Tree::Bvh(tree) = self.tracer.tree
                    && packet.set::<L>(points, bounds, places, &scale)
                {
                    tree.find_closest_of_packet::<L>(mesh, self.sought, &mut packet);
                    nearest.set::<L>(mesh, &packet, scale.factors);
                    for (lane, &place) in places.iter().enumerate() {
                        found[place as usize] = nearest.get(&packet, lane, bounds[place as usize]);
                    }
                } else {
                    for place in places.iter().map(|&place| place as usize) {
                        found[place] = self.tracer.closest_point_of(&points[place], bounds[place], self.sought);
                    }
                }
            }
        }
    }
}
