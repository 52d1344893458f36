use super::Wide;
use super::node::{CHILD_COUNT, Node};
use super::tile::{TILE_SIZE, Tile};
use crate::math::{Aabb, Scalar};
use crate::mesh::Mesh;

impl<T: Scalar> Wide<T> {
    /// Each triangle lies in one tile, each tile and node under one box; tiles hold the mesh's corners at their
    /// present positions, and boxes are the tightest around what lies under them.
    pub(in crate::octree) fn validate(&self, mesh: &Mesh<T>) -> Result<(), String> {
        let mut tile_of = vec![None; mesh.topology().triangles().len()];
        for (index, tile) in self.tiles.iter().enumerate() {
            tile.validate(mesh).map_err(|what| format!("tile {index}: {what}"))?;
            for &triangle in tile.triangles() {
                if let Some(other) = tile_of[triangle as usize].replace(index) {
                    return Err(format!("triangle {triangle} is in tiles {other} and {index}"));
                }
            }
        }
        if let Some(triangle) = tile_of.iter().position(Option::is_none) {
            return Err(format!("triangle {triangle} is in no tile"));
        }
        let mut owners = vec![0; mesh.topology().vertex_count()];
        for tile in &self.tiles {
            let own = (0..TILE_SIZE).filter(|place| tile.owned >> place & 1 == 1);
            own.for_each(|place| owners[tile.vertices[place] as usize] += 1);
        }
        if let Some(vertex) = mesh.topology().surface_vertices().iter().find(|&&vertex| owners[vertex as usize] != 1) {
            return Err(format!("vertex {vertex} is not one tile's own"));
        }
        self.validate_nodes()
    }

    fn validate_nodes(&self) -> Result<(), String> {
        let (mut nodes, mut tiles) = (vec![0; self.nodes.len()], vec![0; self.tiles.len()]);
        nodes[0] = 1;
        for (index, node) in self.nodes.iter().enumerate() {
            for place in 0..CHILD_COUNT {
                let child = node.first as usize + place;
                let aabb = if place >= node.count as usize {
                    Aabb::empty()
                } else if node.is_leaf {
                    tiles[child] += 1;
                    self.tiles[child].aabb
                } else if child <= index {
                    return Err(format!("node {child} comes before its parent {index}"));
                } else {
                    nodes[child] += 1;
                    around_children(&self.nodes[child])
                };
                if node.child_box(place) != aabb {
                    return Err(format!("box {place} of node {index} is not the one around its child"));
                }
            }
        }
        let not_one = |what: &str, parents: &[u32]| match parents.iter().position(|&count| count != 1) {
            Some(index) => Err(format!("{what} {index} lies under {} boxes", parents[index])),
            None => Ok(()),
        };
        not_one("node", &nodes)?;
        not_one("tile", &tiles)
    }
}

fn around_children<T: Scalar>(node: &Node<T>) -> Aabb<T> {
    let boxes = (0..node.count as usize).map(|place| node.child_box(place));
    boxes.fold(Aabb::empty(), |around, child| Aabb {
        lower: around.lower.inf(&child.lower),
        upper: around.upper.sup(&child.upper),
    })
}

impl<T: Scalar> Tile<T> {
    fn validate(&self, mesh: &Mesh<T>) -> Result<(), String> {
        let count = self.triangles().len();
        if !(1..=TILE_SIZE).contains(&count) || u32::from(self.present) != (1u32 << count) - 1 {
            return Err(format!("it has {count} triangles"));
        }
        let mut around = Aabb::empty();
        for place in 0..count {
            let triangle = self.triangles[place];
            let expected_set = self.corners.iter().fold(0, |set, corner| set | 1 << corner[place]);
            if self.vertex_sets[place] != expected_set {
                return Err(format!("the vertices of triangle {triangle} are not those of its corners"));
            }
            for corner in 0..3 {
                let vertex_place = usize::from(self.corners[corner][place]);
                let vertex = mesh.topology().triangles()[triangle as usize][corner];
                let position = mesh.positions()[vertex as usize];
                around.include(&position);
                if self.vertices[vertex_place] != vertex {
                    return Err(format!("corner {corner} of triangle {triangle} is another vertex"));
                }
                if self.is_loaded && (0..3).any(|axis| self.positions[axis][vertex_place] != position[axis]) {
                    return Err(format!("vertex {vertex} is not where the mesh has it"));
                }
            }
        }
        if self.aabb == around { Ok(()) } else { Err("its box is not that of its triangles".to_owned()) }
    }
}
