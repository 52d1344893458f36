use crate::bvh::node::Node;
use crate::bvh::tile::Outline;
use crate::math::{Aabb, Scalar, Vector3};
use crate::memory::{self, Room};
use crate::mesh::Mesh;
use crate::simd::{LANE_COUNT, Lanes};

/// If the vertices of a leaf lie in more runs than this, their numbering is too random for the runs to tell where the leaf is.
const MOST_RUNS: usize = 3 * LANE_COUNT;

const ASCENDING: [u32; LANE_COUNT] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

/// Boxes around runs of sixteen consecutive vertices of the mesh, and the runs in which the vertices of each leaf lie. Vertices
/// are nearly always numbered along the surface. Then one pass over the positions tells which leaves are far from a region,
/// without a look at their tiles.
#[derive(Clone, Debug)]
pub(crate) struct VertexRuns<T: Scalar> {
    lower: Vec<Vector3<T>>,
    upper: Vec<Vector3<T>>,
    /// The runs of each leaf, sixteen at a time, the last repeated.
    of_leaves: Vec<[u32; LANE_COUNT]>,
    /// Where in `of_leaves` the runs of each node begin, and where the last ones end.
    starts: Vec<u32>,
}

impl<T: Scalar> VertexRuns<T> {
    /// For the leaves among the nodes; their boxes are yet to be renewed.
    pub(crate) fn new(mesh: &Mesh<T>, nodes: &[Node<T>], outlines: &[Outline<T>]) -> Self {
        let (mut of_leaves, mut starts) = (Vec::new(), memory::with_room(nodes.len() + 1));
        let mut runs = Vec::new();
        for node in nodes {
            starts.push(of_leaves.len() as u32);
            runs.clear();
            if node.is_leaf {
                let vertices = outlines[node.tiles()].iter().flat_map(|outline| outline.vertices);
                memory::append(&mut runs, vertices.map(|vertex| vertex / LANE_COUNT as u32));
                runs.sort_unstable();
                runs.dedup();
            }
            if runs.len() <= MOST_RUNS {
                for some in runs.chunks(LANE_COUNT) {
                    of_leaves.room_for(1).push(std::array::from_fn(|i| some[i.min(some.len() - 1)]));
                }
            }
        }
        starts.push(of_leaves.len() as u32);
        let count = mesh.topology().vertex_count().div_ceil(LANE_COUNT);
        let [lower, upper] = [(); 2].map(|()| memory::filled(Vector3::zeros(), count));
        Self { lower, upper, of_leaves, starts }
    }

    /// Renews the boxes, if any leaf uses them.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn renew<L: Lanes<T>>(&mut self, positions: &[Vector3<T>]) {
        if self.of_leaves.is_empty() {
            return;
        }
        for (run, (lower, upper)) in self.lower.iter_mut().zip(&mut self.upper).enumerate() {
            let left = &positions[run * LANE_COUNT..];
            (*lower, *upper) = match left.first_chunk::<{ LANE_COUNT + 1 }>() {
                Some(some) => L::bounds(some, &ASCENDING),
                None => L::bounds(left, &ASCENDING.map(|i| i.min(left.len() as u32 - 1))),
            };
        }
    }

    /// A box that holds all vertices of a leaf; `None` if its vertices lie in too many runs.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn around<L: Lanes<T>>(&self, leaf: usize) -> Option<Aabb<T>> {
        let mut around = Aabb::empty();
        let runs = &self.of_leaves[self.starts[leaf] as usize..self.starts[leaf + 1] as usize];
        for some in runs {
            around.lower = around.lower.inf(&L::bounds(&self.lower, some).0);
            around.upper = around.upper.sup(&L::bounds(&self.upper, some).1);
        }
        (!runs.is_empty()).then_some(around)
    }
}
