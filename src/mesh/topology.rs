use super::MeshError;
use super::edges::{self, Border, Edge, NO_TRIANGLE, Side};
use crate::math::Scalar;
use crate::memory::{self, Room};
use crate::simd::{LANE_COUNT, Lanes, Lists};
use std::sync::OnceLock;

/// Which vertices form which triangles, checked once: closed unless that is not asked for, manifold and consistently
/// oriented.
#[derive(Debug)]
pub struct Topology {
    vertex_count: usize,
    triangles: Vec<[u32; 3]>,
    /// The triangles around vertex v are `around[around_start[v]..around_start[v + 1]]`, in ascending order.
    around: Vec<u32>,
    around_start: Vec<u32>,
    /// The ring of vertex v is `rings[ring_start[v]..ring_start[v + 1]]`.
    rings: Vec<u32>,
    ring_start: Vec<u32>,
    surface_vertices: Vec<u32>,
    /// Found when [`edge_list`](Self::edge_list) is first called.
    edges: OnceLock<Vec<Edge>>,
    /// Found when [`across`](Self::across) is first called.
    neighbours: OnceLock<Vec<[u32; 3]>>,
    components: Vec<u32>,
    is_open: bool,
}

/// Most vertices have six triangles around them, and so a ring of seven.
pub(crate) const RING_LENGTH: usize = 7;

impl Topology {
    /// Checks the triangles and finds the neighbourhoods. Vertices that no triangle uses are allowed: the inner
    /// nodes of a volume mesh need not be sorted out. So are sheets that touch in one vertex: each edge still has an
    /// inside and an outside, and rays need no more.
    pub fn new(vertex_count: usize, triangles: &[[u32; 3]], border: Border) -> Result<Self, MeshError> {
        check_indices(vertex_count, triangles)?;
        let (around, around_start) = triangles_around_vertices(vertex_count, triangles);
        let (neighbours, is_open) = edges::check(triangles, &around, &around_start, border)?;
        let (rings, ring_start) = rings(triangles, &around, &around_start);
        Ok(Self {
            vertex_count,
            triangles: memory::listed(triangles.iter().copied()),
            rings,
            ring_start,
            surface_vertices: memory::listed(
                (0..vertex_count as u32).filter(|&v| around_start[v as usize] < around_start[v as usize + 1]),
            ),
            around,
            around_start,
            edges: OnceLock::new(),
            neighbours: OnceLock::new(),
            components: components(&neighbours).1,
            is_open,
        })
    }

    /// How many vertices there are, used by triangles or not.
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// The corners of every triangle, counter-clockwise seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The triangles that have `vertex` as a corner, in ascending order.
    pub fn triangles_around(&self, vertex: u32) -> &[u32] {
        let vertex = vertex as usize;
        &self.around[self.around_start[vertex] as usize..self.around_start[vertex + 1] as usize]
    }

    /// By vertex, of sixteen, the first of [`triangles_around`](Self::triangles_around).
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn first_triangles<T: Scalar, L: Lanes<T>>(&self, vertices: &[u32; LANE_COUNT]) -> [u32; LANE_COUNT] {
        L::Lists::gather_indices(&self.around, &L::Lists::gather_indices(&self.around_start, vertices))
    }

    /// The vertices around `vertex` in the order of the triangles there: each two that follow one another form a triangle
    /// with it. A closed fan ends with the vertex it starts with; between two fans stands `vertex` itself, and behind
    /// the last, so often that the ring has [`RING_LENGTH`] entries at least. The first triangle is the first of
    /// [`triangles_around`](Self::triangles_around).
    pub(crate) fn ring(&self, vertex: u32) -> &[u32] {
        let vertex = vertex as usize;
        &self.rings[self.ring_start[vertex] as usize..self.ring_start[vertex + 1] as usize]
    }

    /// All rings, and where each starts.
    pub(crate) fn rings(&self) -> (&[u32], &[u32]) {
        (&self.rings, &self.ring_start)
    }

    /// Whether the surface has a border.
    pub fn is_open(&self) -> bool {
        self.is_open
    }

    /// Every edge between two triangles once, in ascending order of its vertices.
    pub fn edges(&self) -> impl Iterator<Item = Edge> {
        let mut sides = Vec::new();
        let mut vertices = 0..self.vertex_count() as u32;
        let (mut vertex, mut next) = (0, 0);
        std::iter::from_fn(move || {
            loop {
                if let Some(edge) = edges::next_edge(vertex, &sides, &mut next) {
                    return Some(edge);
                }
                (vertex, next) = (vertices.next()?, 0);
                edges::list_sides(vertex, self.triangles(), self.triangles_around(vertex), &mut sides);
            }
        })
    }

    /// The edges of which a vertex is the smaller end. `sides` is scratch memory.
    pub(crate) fn edges_from(&self, vertex: u32, sides: &mut Vec<Side>) -> impl Iterator<Item = Edge> {
        edges::list_sides(vertex, self.triangles(), self.triangles_around(vertex), sides);
        let (sides, mut next) = (&*sides, 0);
        std::iter::from_fn(move || edges::next_edge(vertex, sides, &mut next))
    }

    /// Each triangle's neighbours across its edges, in no order; [`NO_TRIANGLE`] at a border.
    pub(crate) fn neighbours(&self) -> Vec<[u32; 3]> {
        let mut neighbours = memory::filled([NO_TRIANGLE; 3], self.triangles().len());
        self.edges().for_each(|edge| edges::join(&mut neighbours, edge.triangles));
        neighbours
    }

    /// The neighbours of a triangle across some of its edges, each of which starts at one of the corners.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn across(&self, triangle: u32, edges: [bool; 3]) -> impl Iterator<Item = u32> {
        let corners = self.triangles[triangle as usize];
        let is_across = move |&other: &u32| {
            other != NO_TRIANGLE && {
                let [a, b, c] = self.triangles[other as usize];
                (0..3).any(|k| {
                    let [from, to] = [corners[k], corners[(k + 1) % 3]];
                    edges[k] && ((a == to && b == from) || (b == to && c == from) || (c == to && a == from))
                })
            }
        };
        self.neighbours.get_or_init(|| self.neighbours())[triangle as usize].into_iter().filter(is_across)
    }

    /// [`edges`](Self::edges) as a list, which is kept from then on.
    pub(crate) fn edge_list(&self) -> &[Edge] {
        self.edges.get_or_init(|| {
            let mut list = memory::with_room(self.triangles.len() * 3 / 2);
            self.edges().for_each(|edge| list.room_for(1).push(edge));
            list
        })
    }

    /// The first triangle of each part of the surface that is connected across edges, in ascending order.
    pub fn components(&self) -> &[u32] {
        &self.components
    }

    /// The component of every triangle, by its place in [`components`](Self::components).
    pub(crate) fn component_of_triangles(&self) -> Vec<u32> {
        components(&self.neighbours()).0
    }

    /// The vertices that at least one triangle uses, in ascending order.
    pub fn surface_vertices(&self) -> &[u32] {
        &self.surface_vertices
    }
}

fn check_indices(vertex_count: usize, triangles: &[[u32; 3]]) -> Result<(), MeshError> {
    if triangles.is_empty() {
        return Err(MeshError::Empty);
    }
    let count = vertex_count.max(triangles.len());
    if count >= u32::MAX as usize / 3 {
        return Err(MeshError::TooLarge { count });
    }
    for (triangle, &corners) in triangles.iter().enumerate() {
        if let Some(&index) = corners.iter().find(|&&index| index as usize >= vertex_count) {
            return Err(MeshError::IndexOutOfRange { triangle, index, vertex_count });
        }
        let [a, b, c] = corners;
        if a == b || b == c || c == a {
            return Err(MeshError::DegenerateTriangle { triangle, corners });
        }
    }
    Ok(())
}

fn triangles_around_vertices(vertex_count: usize, triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<u32>) {
    let mut start = memory::filled(0u32, vertex_count + 1);
    for &vertex in triangles.as_flattened() {
        start[vertex as usize + 1] += 1;
    }
    for vertex in 0..vertex_count {
        start[vertex + 1] += start[vertex];
    }
    let mut around = memory::filled(0u32, triangles.len() * 3);
    let mut next = memory::listed(start.iter().copied());
    for (triangle, corners) in triangles.iter().enumerate() {
        for &vertex in corners {
            around[next[vertex as usize] as usize] = triangle as u32;
            next[vertex as usize] += 1;
        }
    }
    (around, start)
}

fn rings(triangles: &[[u32; 3]], around: &[u32], around_start: &[u32]) -> (Vec<u32>, Vec<u32>) {
    // A ring has one vertex more than triangles, but where the surface touches itself in a vertex.
    let lengths = around_start.windows(2).map(|ends| RING_LENGTH.max((ends[1] - ends[0]) as usize + 1));
    let mut rings = memory::with_room(lengths.sum());
    let mut start = memory::with_room(around_start.len());
    // The two other corners of each triangle around a vertex, in the triangle's order; and the same sorted by the first of the
    // two, which differs from triangle to triangle, so that the time of a large fan does not grow with its square.
    let mut sides: Vec<[u32; 2]> = Vec::new();
    let mut by_first: Vec<([u32; 2], usize)> = Vec::new();
    let mut is_done: Vec<bool> = Vec::new();
    start.push(0);
    for vertex in 0..around_start.len() - 1 {
        let own = &around[around_start[vertex] as usize..around_start[vertex + 1] as usize];
        let vertex = vertex as u32;
        sides.clear();
        memory::append(&mut sides, own.iter().map(|&triangle| edges::others(triangles[triangle as usize], vertex)));
        let ring = rings.len();
        memory::refill(&mut by_first, sides.iter().enumerate().map(|(place, &side)| (side, place)));
        by_first.sort_unstable();
        memory::refill_with(&mut is_done, false, sides.len());
        for start in 0..sides.len() {
            if is_done[start] {
                continue;
            }
            if rings.len() > ring {
                rings.room_for(1).push(vertex);
            }
            rings.room_for(1).push(sides[start][0]);
            let mut next = Some(start);
            while let Some(place) = next {
                is_done[place] = true;
                let last = sides[place][1];
                rings.room_for(1).push(last);
                let following = by_first.binary_search_by_key(&last, |(side, _)| side[0]);
                next = following.ok().map(|at| by_first[at].1).filter(|&place| !is_done[place]);
            }
        }
        let length = rings.len().max(ring + RING_LENGTH);
        rings.room_for(length - rings.len()).resize(length, vertex);
        start.push(rings.len() as u32);
    }
    // Rings of surfaces that touch themselves in vertices are longer than was reckoned; what was reserved for growing is freed.
    if rings.capacity() > rings.len() {
        rings = memory::listed(rings.iter().copied());
    }
    (rings, start)
}

/// The component of every triangle, given those across its edges, and the first triangle of each component.
fn components(neighbours: &[[u32; 3]]) -> (Vec<u32>, Vec<u32>) {
    let triangle_count = neighbours.len();
    let mut component_of = memory::filled(u32::MAX, triangle_count);
    let mut firsts = Vec::new();
    let mut waiting = Vec::new();
    for first in 0..triangle_count as u32 {
        if component_of[first as usize] != u32::MAX {
            continue;
        }
        let component = firsts.len() as u32;
        firsts.room_for(1).push(first);
        component_of[first as usize] = component;
        waiting.room_for(1).push(first);
        while let Some(triangle) = waiting.pop() {
            for neighbour in neighbours[triangle as usize].into_iter().filter(|&neighbour| neighbour != NO_TRIANGLE) {
                if std::mem::replace(&mut component_of[neighbour as usize], component) == u32::MAX {
                    waiting.room_for(1).push(neighbour);
                }
            }
        }
    }
    (component_of, firsts)
}
