use crate::bvh::CHILD_COUNT;
use crate::bvh::rays::packet::answer::Answer;
use crate::bvh::rays::packet::search::Search;
use crate::math::Scalar;
use crate::mesh::Mesh;
use crate::simd::{LANE_COUNT, Lanes, Mask, lanes_of};
use crate::triangle::{HitLanes, RayPacket, TriangleLanes};

/// A triangle that a ray may meet.
#[derive(Clone, Copy)]
struct Candidate {
    triangle: u32,
    ray: u32,
}

/// A packet whose box meets more tiles than this walks the tree. The tori of the benchmarks list far fewer, the spreading rays
/// of a deep overlap several hundred.
const MOST_LISTED: usize = 64;

/// The last leaf listed may have as many tiles as a node has children.
const ROOM_FOR_TILES: usize = MOST_LISTED + CHILD_COUNT;

/// How many candidates are computed at a time.
const CANDIDATES_AT_ONCE: usize = 256;

/// Scratch memory for a packet's search, with space behind each list that may be overwritten.
#[repr(C, align(64))]
pub(crate) struct Candidates<T: Scalar> {
    lanes: TriangleLanes<T>,
    hits: HitLanes<T>,
    /// For the positions of a tile that is not loaded.
    pub(crate) room: [[T; LANE_COUNT]; 3],
    /// Where more tiles than this are listed, the packet walks the tree.
    pub(crate) most_listed: usize,
    /// Tiles that rays may meet, and of each its node and its place there: 16 · node + place.
    pub(crate) tiles: [u32; ROOM_FOR_TILES + LANE_COUNT],
    pub(crate) places: [u32; ROOM_FOR_TILES + LANE_COUNT],
    /// 16 · place in `tiles` + ray, where the ray meets the tile's box.
    pub(crate) pairs: [u32; (ROOM_FOR_TILES + 1) * LANE_COUNT],
    triangles: [Candidate; CANDIDATES_AT_ONCE + LANE_COUNT],
    /// Whether the next packet starts by walking the tree: for searches of hits, and of exits.
    pub(crate) walks: [bool; 2],
}

impl<T: Scalar> Candidates<T> {
    pub(crate) fn new() -> Self {
        Self {
            lanes: TriangleLanes::empty(),
            hits: HitLanes::empty(),
            room: [[T::zero(); LANE_COUNT]; 3],
            most_listed: MOST_LISTED,
            tiles: [0; ROOM_FOR_TILES + LANE_COUNT],
            places: [0; ROOM_FOR_TILES + LANE_COUNT],
            pairs: [0; (ROOM_FOR_TILES + 1) * LANE_COUNT],
            triangles: [Candidate { triangle: 0, ray: 0 }; CANDIDATES_AT_ONCE + LANE_COUNT],
            walks: [false; 2],
        }
    }

    /// Walks the tree where more tiles than this are listed, for tests.
    #[cfg(all(test, target_arch = "x86_64"))]
    pub(crate) fn listing(most_listed: usize) -> Self {
        Self { most_listed: most_listed.min(MOST_LISTED), ..Self::new() }
    }
}

/// Holds the rays of the listed pairs against all triangles of their tiles at once. The candidates that are left, mostly hits,
/// join the `listed` ones, and are computed once there are at least `fewest`. Gives how many are still listed.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn work_off<T: Scalar, L: Lanes<T>, A: Answer<T>>(
    search: &Search<T, L>,
    list: &mut Candidates<T>,
    pair_count: usize,
    mut listed: usize,
    fewest: usize,
    answer: &mut A,
) -> usize {
    let mut next = 0;
    while next < pair_count {
        while next < pair_count && listed <= CANDIDATES_AT_ONCE - LANE_COUNT {
            let pair = list.pairs[next] as usize;
            next += 1;
            let (index, ray) = (list.tiles[pair / LANE_COUNT] as usize, pair % LANE_COUNT);
            let tile = &search.tree.tiles[index];
            let positions = search.tree.positions_of::<L>(index, search.mesh, &mut list.room);
            let [right, left] = search.packet.sides::<L>(ray, positions, &tile.corners);
            let mut met = !(if A::EXITS_ONLY { right } else { right & left }) & tile.present;
            // Few rays meet a triangle that they could leave through; otherwise the tile's vertices stay unread.
            if !A::EXITS_ONLY || met != 0 {
                met &= !answer.excluded::<L>(ray, &search.tree.outlines[index].vertices, &tile.corners);
            }
            // None or one, nearly always: no branch for that.
            let ray = ray as u32;
            let first = tile.triangles[met.trailing_zeros() as usize % LANE_COUNT];
            list.triangles[listed] = Candidate { triangle: first, ray };
            listed += usize::from(met != 0);
            met &= met.wrapping_sub(1);
            for place in lanes_of(met) {
                list.triangles[listed] = Candidate { triangle: tile.triangles[place], ray };
                listed += 1;
            }
        }
        if listed >= fewest {
            resolve::<T, L, A>(search.mesh, search.packet, list, listed, answer);
            listed = 0;
        }
    }
    listed
}

/// Computes the hits of the candidates.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn resolve<T: Scalar, L: Lanes<T>, A: Answer<T>>(
    mesh: &Mesh<T>,
    packet: &RayPacket<T>,
    list: &mut Candidates<T>,
    count: usize,
    answer: &mut A,
) {
    let Candidates { lanes, hits, triangles: list, .. } = list;
    let triangles = mesh.topology().triangles();
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
        let [a, b, c] = &corners;
        lanes.set::<L>(packet, &rays, [mesh.gather(a), mesh.gather(b), mesh.gather(c)]);
        lanes.intersect::<L>(hits);
        for lane in lanes_of(hits.found & ((1u32 << candidates.len()) - 1) as Mask) {
            let Candidate { triangle, ray } = candidates[lane];
            answer.add(ray as usize % LANE_COUNT, triangle, hits, lane);
        }
    }
}
