use crate::bvh::hierarchy;
use crate::bvh::node::Node;
use crate::bvh::posed::Posed;
use crate::bvh::tile::{Outline, TILE_SIZE, Tile};
use crate::bvh::tile_cylinder::TileCylinders;
use crate::bvh::vertex_runs::VertexRuns;
use crate::math::{Aabb, Scalar};
use crate::memory;
use crate::mesh::Mesh;
use crate::simd::{LANE_COUNT, Lanes};

/// Tiles and the nodes above them, in flat arrays.
#[derive(Clone, Debug)]
pub(crate) struct Bvh<T: Scalar> {
    /// In the order in which the nodes lead to them.
    pub(crate) tiles: Vec<Tile<T>>,
    /// The outline of each tile.
    pub(crate) outlines: Vec<Outline<T>>,
    /// By tile the places of its triangles' corners, in ascending order of the vertices' numbers: for distances.
    pub(crate) ascending: Vec<[[u8; TILE_SIZE]; 3]>,
    /// Children come after their parent; the first is the root.
    pub(crate) nodes: Vec<Node<T>>,
    pub(crate) cylinders: TileCylinders<T>,
    pub(crate) runs: VertexRuns<T>,
    /// What poses need, made with the first one.
    pub(crate) posed: Option<Box<[Posed<T>; 1]>>,
    /// Whether all boxes are the tightest.
    pub(crate) is_tight: bool,
    /// Counts the changes of positions: tiles loaded before are out of date.
    pub(crate) loading: u64,
}

impl<T: Scalar> Bvh<T> {
    pub(crate) fn new(mesh: &Mesh<T>) -> Self {
        let topology = mesh.topology();
        let clusters = mesh.clusters();
        let nodes = hierarchy::nodes_above(clusters.len());
        let (mut tiles, mut outlines) = (memory::with_room(clusters.len()), memory::with_room(clusters.len()));
        let mut is_owned = memory::filled(false, topology.vertex_count());
        for cluster in clusters.iter() {
            let (mut tile, outline) = Tile::new(topology.triangles(), cluster);
            tile.own_vertices(&outline.vertices, &mut is_owned);
            tiles.push(tile);
            outlines.push(outline);
        }
        let ascending = memory::listed(tiles.iter().zip(&outlines).map(|(tile, outline)| tile.ascending(outline)));
        let runs = VertexRuns::new(mesh, &nodes, &outlines);
        let cylinders = TileCylinders::new(tiles.len());
        let (posed, is_tight, loading) = (None, false, 0);
        let mut tree = Self { tiles, outlines, ascending, nodes, cylinders, runs, posed, is_tight, loading };
        tree.refit(mesh, None);
        tree.load(mesh, None, true);
        tree
    }

    pub(crate) fn tile_count(&self) -> u32 {
        self.tiles.len() as u32
    }

    pub(crate) fn vertices_of(&self, tile: u32) -> &[u32] {
        &self.outlines[tile as usize].vertices
    }

    pub(crate) fn triangles_of(&self, tile: u32) -> &[u32] {
        self.tiles[tile as usize].triangles()
    }

    /// Whether the positions that a tile holds are the present ones.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn is_loaded(&self, tile: usize) -> bool {
        self.tiles[tile].loaded_at == self.loading
    }

    /// The positions of a tile's vertices, loaded or not; `room` is for those that are not.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn positions_of<'a, L: Lanes<T>>(
        &'a self,
        tile: usize,
        mesh: &Mesh<T>,
        room: &'a mut [[T; LANE_COUNT]; 3],
    ) -> &'a [[T; LANE_COUNT]; 3] {
        if self.is_loaded(tile) {
            return &self.tiles[tile].positions;
        }
        // Few rays leave the region for which tiles were loaded.
        mesh.gather::<L>(&self.outlines[tile].vertices).store(room);
        room
    }

    /// A node with its boxes where they are now; `room` is for one that no region has reached.
    #[inline(always)]
    pub(crate) fn node<'a>(&'a self, index: usize, room: &'a mut Option<Node<T>>) -> &'a Node<T> {
        let node = &self.nodes[index];
        if node.is_placed { node } else { room.insert(self.moved(index)) }
    }

    /// The box of a node's child where it is now.
    #[inline(always)]
    pub(crate) fn child_box(&self, index: usize, place: usize) -> Aabb<T> {
        let node = &self.nodes[index];
        if node.is_placed { node.child_box(place) } else { self.moved(index).child_box(place) }
    }

    #[cold]
    fn moved(&self, index: usize) -> Node<T> {
        let mut node = self.nodes[index].clone();
        if let Some([posed]) = self.posed.as_deref()
            && let Some(pose) = &posed.pose
        {
            posed.move_boxes(pose, index, &mut node);
        }
        node
    }
}
