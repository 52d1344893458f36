use super::MeshError;

/// Which vertices form which triangles, checked once: closed, manifold and consistently oriented.
#[derive(Debug)]
pub struct Topology {
    vertex_count: usize,
    triangles: Vec<[u32; 3]>,
    /// The triangles around vertex v are `around[around_start[v]..around_start[v + 1]]`, in ascending order.
    around: Vec<u32>,
    around_start: Vec<u32>,
    surface_vertices: Vec<u32>,
    edges: Vec<Edge>,
}

/// Where two triangles meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// Its ends, the smaller number first.
    pub vertices: [u32; 2],
    /// Its two triangles.
    pub triangles: [u32; 2],
}

impl Topology {
    /// Checks the triangles and finds the neighbourhoods. Vertices that no triangle uses are allowed: the inner
    /// nodes of a volume mesh need not be sorted out. So are sheets that touch in one vertex: each edge still has an
    /// inside and an outside, and rays need no more.
    pub fn new(vertex_count: usize, triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        check_indices(vertex_count, triangles)?;
        let edges = find_edges(triangles)?;
        let (around, around_start) = triangles_around_vertices(vertex_count, triangles);
        Ok(Self {
            vertex_count,
            triangles: triangles.to_vec(),
            surface_vertices: (0..vertex_count as u32)
                .filter(|&v| around_start[v as usize] < around_start[v as usize + 1])
                .collect(),
            around,
            around_start,
            edges,
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

    /// Every edge once, in ascending order of its vertices.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
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

/// Every edge must belong to exactly two triangles that run through it in opposite directions.
fn find_edges(triangles: &[[u32; 3]]) -> Result<Vec<Edge>, MeshError> {
    let mut edges = Vec::with_capacity(triangles.len() * 3 / 2);
    let mut halves: Vec<(u32, u32, bool, usize)> = Vec::with_capacity(triangles.len() * 3);
    for (triangle, corners) in triangles.iter().enumerate() {
        for i in 0..3 {
            let (from, to) = (corners[i], corners[(i + 1) % 3]);
            halves.push((from.min(to), from.max(to), from > to, triangle));
        }
    }
    halves.sort_unstable();
    for shared in halves.chunk_by(|e, f| (e.0, e.1) == (f.0, f.1)) {
        let edge = [shared[0].0, shared[0].1];
        match *shared {
            [(.., backward, s), (.., forward, t)] if backward == forward => {
                return Err(MeshError::InconsistentOrientation { triangles: [s, t], edge });
            }
            [(.., s), (.., t)] => edges.push(Edge { vertices: edge, triangles: [s as u32, t as u32] }),
            [(.., triangle)] => return Err(MeshError::Open { triangle, edge }),
            _ => return Err(MeshError::NonManifold { edge, triangle_count: shared.len() }),
        }
    }
    Ok(edges)
}

fn triangles_around_vertices(vertex_count: usize, triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<u32>) {
    let mut start = vec![0u32; vertex_count + 1];
    for &vertex in triangles.as_flattened() {
        start[vertex as usize + 1] += 1;
    }
    for vertex in 0..vertex_count {
        start[vertex + 1] += start[vertex];
    }
    let mut around = vec![0u32; triangles.len() * 3];
    let mut next = start.clone();
    for (triangle, corners) in triangles.iter().enumerate() {
        for &vertex in corners {
            around[next[vertex as usize] as usize] = triangle as u32;
            next[vertex as usize] += 1;
        }
    }
    (around, start)
}
