use super::leaving::Directions;
use super::node::BoxLanes;
use super::trace::STACK_SIZE;
use super::{CHILD_COUNT, Wide};
use crate::math::{Aabb, LANE_COUNT, Lanes, Mask, Scalar, Vector3, Vectors};
use crate::mesh::Mesh;
use crate::ray::{Hit, HitLanes, RayPacket, TriangleLanes};

/// Where each ray of a packet meets a mesh first.
#[derive(Clone, Debug)]
// Whole rows of sixteen lie on lines of the cache.
#[repr(C, align(64))]
pub(crate) struct PacketHits<T: Scalar> {
    pub(crate) triangle: [u32; LANE_COUNT],
    pub(crate) t: [T; LANE_COUNT],
    pub(crate) weights: [[T; LANE_COUNT]; 3],
    /// Which rays have a hit; places of the others hold nothing of use.
    pub(crate) found: Mask,
    /// Which rays meet the triangle from inside.
    pub(crate) exits: Mask,
}

impl<T: Scalar> PacketHits<T> {
    pub(crate) fn empty() -> Self {
        let zeros = [T::zero(); LANE_COUNT];
        Self { found: 0, exits: 0, triangle: [0; LANE_COUNT], t: zeros, weights: [zeros; 3] }
    }
}

impl<T: Scalar> PacketHits<T> {
    /// The hit of one ray.
    pub(crate) fn get(&self, lane: usize) -> Option<Hit<T>> {
        (self.found >> lane & 1 == 1).then(|| Hit {
            triangle: self.triangle[lane],
            t: self.t[lane],
            weights: [0, 1, 2].map(|corner| self.weights[corner][lane]),
            is_exit: self.exits >> lane & 1 == 1,
        })
    }

    pub(crate) fn set(&mut self, lane: usize, hit: &Hit<T>) {
        let bit = 1 << lane;
        self.found |= bit;
        self.exits = if hit.is_exit { self.exits | bit } else { self.exits & !bit };
        (self.triangle[lane], self.t[lane]) = (hit.triangle, hit.t);
        (0..3).for_each(|corner| self.weights[corner][lane] = hit.weights[corner]);
    }
}

/// A triangle that a ray may meet.
#[derive(Clone, Copy)]
struct Candidate {
    triangle: u32,
    ray: u32,
}

/// So many tiles are held against the rays at a time, and so many candidates computed.
const TILES_AT_ONCE: usize = 64;
const CANDIDATES_AT_ONCE: usize = 256;

/// Room for what is found on the way of a packet; with space behind each list that may be overwritten.
#[repr(C, align(64))]
pub(crate) struct Candidates<T: Scalar> {
    lanes: TriangleLanes<T>,
    hits: HitLanes<T>,
    /// For the positions of a tile that is not loaded.
    room: [[T; LANE_COUNT]; 3],
    /// Tiles that the box around the packet meets.
    tiles: [u32; TILES_AT_ONCE + LANE_COUNT],
    /// 16 · place in `tiles` + ray, where the ray meets the tile's box.
    pairs: [u32; (TILES_AT_ONCE + 1) * LANE_COUNT],
    triangles: [Candidate; CANDIDATES_AT_ONCE + LANE_COUNT],
}

impl<T: Scalar> Candidates<T> {
    pub(crate) fn new() -> Self {
        Self {
            lanes: TriangleLanes::empty(),
            hits: HitLanes::empty(),
            room: [[T::zero(); LANE_COUNT]; 3],
            tiles: [0; TILES_AT_ONCE + LANE_COUNT],
            pairs: [0; (TILES_AT_ONCE + 1) * LANE_COUNT],
            triangles: [Candidate { triangle: 0, ray: 0 }; CANDIDATES_AT_ONCE + LANE_COUNT],
        }
    }
}

/// What is wanted of the hits.
trait Answer<T: Scalar> {
    /// Whether only hits from inside count.
    const EXITS_ONLY: bool;

    /// Which of a tile's triangles do not count for a ray, given the tile's vertices and each triangle's set of them.
    fn excluded<L: Lanes<T>>(&self, ray: usize, vertices: &[u32; LANE_COUNT], sets: &[Mask; LANE_COUNT]) -> Mask;

    /// Takes note of the hit in one of the lanes.
    fn add(&mut self, ray: usize, triangle: u32, hits: &HitLanes<T>, lane: usize);
}

/// The nearest hit of each ray.
struct Nearest<'a, T: Scalar> {
    t_max: &'a [T; LANE_COUNT],
    hits: &'a mut PacketHits<T>,
}

impl<T: Scalar> Answer<T> for Nearest<'_, T> {
    const EXITS_ONLY: bool = false;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn excluded<L: Lanes<T>>(&self, _: usize, _: &[u32; LANE_COUNT], _: &[Mask; LANE_COUNT]) -> Mask {
        0
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn add(&mut self, ray: usize, triangle: u32, found: &HitLanes<T>, lane: usize) {
        let (hits, t, bit) = (&mut *self.hits, found.t[lane], 1 << ray);
        let is_first = hits.found & bit == 0;
        let is_nearer = t < hits.t[ray] || (t == hits.t[ray] && triangle < hits.triangle[ray]);
        if t <= self.t_max[ray] && (is_first || is_nearer) {
            hits.found |= bit;
            hits.exits = hits.exits & !bit | (found.exits >> lane & 1) << ray;
            hits.triangle[ray] = triangle;
            hits.t[ray] = t;
            for corner in 0..3 {
                hits.weights[corner][ray] = found.weights[corner][lane];
            }
        }
    }
}

/// Which rays leave the mesh before their end.
struct Hidden<'a, T: Scalar> {
    end: &'a [T; LANE_COUNT],
    touched: &'a [[u32; 3]; LANE_COUNT],
    hidden: Mask,
}

impl<T: Scalar> Answer<T> for Hidden<'_, T> {
    const EXITS_ONLY: bool = true;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn excluded<L: Lanes<T>>(&self, ray: usize, vertices: &[u32; LANE_COUNT], sets: &[Mask; LANE_COUNT]) -> Mask {
        let [a, b, c] = self.touched[ray];
        let first = L::equal(vertices, a);
        if b == a && c == a {
            return if first == 0 { 0 } else { L::holding(sets, lowest(first)) };
        }
        let (second, third) = (L::equal(vertices, b), L::equal(vertices, c));
        if first == 0 || second == 0 || third == 0 {
            return 0;
        }
        L::holding(sets, lowest(first) | lowest(second) | lowest(third))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn add(&mut self, ray: usize, _: u32, found: &HitLanes<T>, lane: usize) {
        let leaves = found.exits >> lane & 1 == 1 && found.t[lane] < self.end[ray];
        self.hidden |= Mask::from(leaves) << ray;
    }
}

/// The first of the places of a vertex: the last vertex of a tile is repeated, but triangles name its first place.
#[cfg_attr(not(debug_assertions), inline(always))]
fn lowest(places: Mask) -> Mask {
    places & places.wrapping_neg()
}

#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn nearest<T: Scalar, L: Lanes<T>>(
    cells: &Wide<T>,
    mesh: &Mesh<T>,
    packet: &RayPacket<T>,
    list: &mut Candidates<T>,
    hits: &mut PacketHits<T>,
) {
    hits.found = 0;
    let answer = &mut Nearest { t_max: &packet.t_max, hits };
    search::<T, L, _>(cells, mesh, packet, packet.present, &packet.t_max, list, answer);
}

#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn hidden<T: Scalar, L: Lanes<T>>(
    cells: &Wide<T>,
    mesh: &Mesh<T>,
    packet: &RayPacket<T>,
    asked: Mask,
    end: &[T; LANE_COUNT],
    touched: &[[u32; 3]; LANE_COUNT],
    list: &mut Candidates<T>,
) -> Mask {
    let mut answer = Hidden { end, touched, hidden: 0 };
    search::<T, L, _>(cells, mesh, packet, asked, end, list, &mut answer);
    answer.hidden & asked
}

/// The box around the packet chooses nodes and tiles, then each tile's box chooses among the rays, and those are held
/// against all its triangles at once. What is left are mostly hits; these are computed sixteen at a time.
#[cfg_attr(not(debug_assertions), inline(always))]
fn search<T: Scalar, L: Lanes<T>, A: Answer<T>>(
    cells: &Wide<T>,
    mesh: &Mesh<T>,
    packet: &RayPacket<T>,
    asked: Mask,
    end: &[T; LANE_COUNT],
    list: &mut Candidates<T>,
    answer: &mut A,
) {
    if asked == 0 {
        return;
    }
    let slabs = PacketSlabs::<T, L>::new(packet, end, mesh.aabb());
    let around = slabs.box_around(packet, asked, mesh.aabb());
    let directions = Directions::<T, L>::new(packet, asked, &around);
    let around = BoxLanes::new(&around);
    let mut stack = [0u32; STACK_SIZE];
    let mut waiting = 1;
    while waiting > 0 {
        let mut tile_count = 0;
        while waiting > 0 && tile_count <= TILES_AT_ONCE - CHILD_COUNT {
            waiting -= 1;
            let node = &cells.nodes[stack[waiting] as usize];
            let met = node.meets::<L>(&around);
            if node.is_leaf {
                tile_count = L::append(&mut list.tiles, tile_count, node.first, met);
            } else {
                waiting = L::append(&mut stack, waiting, node.first, met);
            }
        }
        let mut pair_count = 0;
        for (place, &tile) in list.tiles[..tile_count].iter().enumerate() {
            let tile = tile as usize;
            if A::EXITS_ONLY && !directions.may_leave(cells, tile, mesh, &mut list.room) {
                continue;
            }
            let rays = slabs.meeting(&cells.outlines[tile].aabb) & asked;
            pair_count = L::append(&mut list.pairs, pair_count, (place * LANE_COUNT) as u32, rays);
        }
        let (mut next, mut listed) = (0, 0);
        while next < pair_count {
            while next < pair_count && listed <= CANDIDATES_AT_ONCE - LANE_COUNT {
                let pair = list.pairs[next] as usize;
                next += 1;
                let (index, ray) = (list.tiles[pair / LANE_COUNT] as usize, pair % LANE_COUNT);
                let tile = &cells.tiles[index];
                let positions = cells.positions_of::<L>(index, mesh, &mut list.room);
                let [right, left] = packet.sides::<L>(ray, positions, &tile.corners);
                let mut met = !(if A::EXITS_ONLY { right } else { right & left })
                    & tile.present
                    & !answer.excluded::<L>(ray, &cells.outlines[index].vertices, &tile.vertex_sets);
                // None or one, nearly always: no branch for that.
                let ray = ray as u32;
                let first = tile.triangles[met.trailing_zeros() as usize % LANE_COUNT];
                list.triangles[listed] = Candidate { triangle: first, ray };
                listed += usize::from(met != 0);
                met &= met.wrapping_sub(1);
                while met != 0 {
                    list.triangles[listed] = Candidate { triangle: tile.triangles[met.trailing_zeros() as usize], ray };
                    listed += 1;
                    met &= met - 1;
                }
            }
            resolve::<T, L, A>(mesh, packet, list, listed, answer);
            listed = 0;
        }
    }
}

/// Computes the hits of the candidates.
#[cfg_attr(not(debug_assertions), inline(always))]
fn resolve<T: Scalar, L: Lanes<T>, A: Answer<T>>(
    mesh: &Mesh<T>,
    packet: &RayPacket<T>,
    list: &mut Candidates<T>,
    count: usize,
    answer: &mut A,
) {
    let Candidates { lanes, hits, triangles: list, .. } = list;
    let (triangles, positions) = (mesh.topology().triangles(), mesh.positions());
    for candidates in list[..count].chunks(LANE_COUNT) {
        // Lanes behind the last repeat the first.
        let (mut rays, mut corners) = ([0; LANE_COUNT], [[0; LANE_COUNT]; 3]);
        for lane in 0..LANE_COUNT {
            let Candidate { triangle, ray } = *candidates.get(lane).unwrap_or(&candidates[0]);
            rays[lane] = ray as u8 % LANE_COUNT as u8;
            for (corner, vertex) in triangles[triangle as usize].into_iter().enumerate() {
                corners[corner][lane] = vertex;
            }
        }
        lanes.set::<L>(packet, &rays, positions, &corners);
        lanes.intersect::<L>(hits);
        let mut found = hits.found & ((1u32 << candidates.len()) - 1) as Mask;
        while found != 0 {
            let lane = found.trailing_zeros() as usize;
            found &= found - 1;
            let Candidate { triangle, ray } = candidates[lane];
            answer.add(ray as usize % LANE_COUNT, triangle, hits, lane);
        }
    }
}

/// The planes of boxes as sixteen rays meet them: a face at `x` is met at t = x · inverse + offset.
struct PacketSlabs<T: Scalar, L: Lanes<T>> {
    origin: Vectors<T, L>,
    inverse: Vectors<T, L>,
    /// For the lower and for the upper faces, each moved outward a little.
    offsets: [Vectors<T, L>; 2],
    end: L,
    /// How coarsely distances from the origins to the mesh are rounded, and a little more.
    margin: L,
    /// Rays so short that what follows would overflow: taken to meet every box.
    meet_all: Mask,
}

impl<T: Scalar, L: Lanes<T>> PacketSlabs<T, L> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn new(packet: &RayPacket<T>, end: &[T; LANE_COUNT], mesh_box: &Aabb<T>) -> Self {
        let (origin, inverse) = (Vectors::<T, L>::load(&packet.origin), Vectors::load(&packet.inverse));
        let below = Vectors::splat(&mesh_box.lower).sub(origin).magnitude();
        let above = Vectors::splat(&mesh_box.upper).sub(origin).magnitude();
        let reach = below.larger(above).largest();
        let rounding = L::splat(T::ROUNDING_UNIT * T::of(16.0));
        // Products with a coordinate are rounded as coarsely as it is far from zero.
        let coordinates = reach.add(origin.magnitude().largest());
        let moved = coordinates.mul(rounding);
        let moved = Vectors::new(moved, moved, moved);
        // Where a direction has no part along an axis, the face lies far behind every end; but finitely far.
        let limit = L::splat(T::LARGEST * T::of(0.5)).div(coordinates.larger(L::splat(T::one())));
        let limit = Vectors::new(limit, limit, limit);
        let inverse = inverse.smaller(limit).larger(limit.negate());
        let offsets = [origin.add(moved).times(inverse).negate(), origin.sub(moved).times(inverse).negate()];
        let longest = Vectors::<T, L>::load(&packet.direction).magnitude().largest();
        let is_long = coordinates.is_at_most(longest.mul(L::splat(T::LARGEST * T::of(0.25))));
        Self { origin, inverse, offsets, end: L::load(end), margin: reach.mul(rounding), meet_all: !is_long }
    }

    /// Bit i: ray i meets this box, not beyond its end.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn meeting(&self, aabb: &Aabb<T>) -> Mask {
        let at_lower = Vectors::splat(&aabb.lower).times_add(self.inverse, self.offsets[0]);
        let at_upper = Vectors::splat(&aabb.upper).times_add(self.inverse, self.offsets[1]);
        let (enters, leaves) = (at_lower.smaller(at_upper), at_lower.larger(at_upper));
        let enters = enters.largest().larger(L::splat(T::zero()));
        let leaves = leaves.x.smaller(leaves.y).smaller(leaves.z).smaller(self.end);
        enters.is_at_most(leaves) | self.meet_all
    }

    /// A box that holds all of the rays that may count, and what triangles near them the tests may accept.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn box_around(&self, packet: &RayPacket<T>, asked: Mask, mesh_box: &Aabb<T>) -> Aabb<T> {
        let end = self.origin.add(Vectors::load(&packet.direction).scaled(self.end));
        let is_finite = end.magnitude().are_at_most(Vectors::splat(&Vector3::repeat(T::LARGEST)));
        if asked & !is_finite != 0 {
            return *mesh_box;
        }
        // The end is rounded as coarsely as its coordinates are.
        let largest = self.origin.magnitude().largest().larger(end.magnitude().largest());
        let grown = self.margin.add(largest.mul(L::splat(T::ROUNDING_UNIT * T::of(4.0))));
        let grown = Vectors::new(grown, grown, grown);
        let (lower, upper) = (self.origin.smaller(end).sub(grown), self.origin.larger(end).add(grown));
        let endless = Vectors::splat(&Vector3::repeat(T::INFINITY));
        Aabb {
            lower: Vectors::select(asked, lower, endless).smallest_lanes(),
            upper: Vectors::select(asked, upper, endless.negate()).greatest_lanes(),
        }
    }
}
