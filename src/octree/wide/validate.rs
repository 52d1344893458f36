use super::{Child, TILE_SIZE, Tile, Wide};
use crate::math::{Aabb, Scalar};
use crate::mesh::Mesh;

impl<T: Scalar> Wide<T> {
    /// Each triangle lies in one tile, each tile and node under one box; tiles hold the mesh's corners at their
    /// present positions, and boxes are the tightest around what lies under them.
    pub(in crate::octree) fn validate(&self, mesh: &Mesh<T>) -> Result<(), String> {
        let mut tile_of = vec![None; mesh.topology().triangles().len()];
        for (index, tile) in self.tiles.iter().enumerate() {
            tile.validate(mesh).map_err(|what| format!("tile {index}: {what}"))?;
            for &triangle in &tile.triangles[..tile.triangle_count as usize] {
                if let Some(other) = tile_of[triangle as usize].replace(index) {
                    return Err(format!("triangle {triangle} is in tiles {other} and {index}"));
                }
            }
        }
        if let Some(triangle) = tile_of.iter().position(Option::is_none) {
            return Err(format!("triangle {triangle} is in no tile"));
        }
        self.validate_nodes()
    }

    fn validate_nodes(&self) -> Result<(), String> {
        let mut seen: Vec<Child> = vec![Child::Node(0)];
        for (index, node) in self.nodes.iter().enumerate() {
            for (place, &child) in node.children.iter().enumerate() {
                seen.push(child);
                let aabb = match child {
                    Child::Node(child) if child as usize <= index => {
                        return Err(format!("node {child} comes before its parent {index}"));
                    }
                    Child::Node(child) => self.nodes[child as usize].aabb(),
                    Child::Tile(tile) => self.tiles[tile as usize].aabb(),
                    Child::None => Aabb::empty(),
                };
                let stored: (Vec<T>, Vec<T>) =
                    (0..3).map(|axis| (node.lower[axis][place], node.upper[axis][place])).unzip();
                if stored.0 != aabb.lower.as_slice() || stored.1 != aabb.upper.as_slice() {
                    return Err(format!("box {place} of node {index} is not the one around its child"));
                }
            }
        }
        let nodes = (0..self.nodes.len() as u32).map(Child::Node);
        for child in nodes.chain((0..self.tiles.len() as u32).map(Child::Tile)) {
            let parents = seen.iter().filter(|&&other| other == child).count();
            if parents != 1 {
                return Err(format!("{child:?} lies under {parents} boxes"));
            }
        }
        Ok(())
    }
}

impl<T: Scalar> Tile<T> {
    fn validate(&self, mesh: &Mesh<T>) -> Result<(), String> {
        let count = self.triangle_count as usize;
        if !(1..=TILE_SIZE).contains(&count) {
            return Err(format!("it has {count} triangles"));
        }
        let mut around = Aabb::empty();
        for place in 0..count {
            let triangle = self.triangles[place];
            let expected_mask = self.corners[place].iter().fold(0, |mask, corner| mask | 1 << corner);
            if self.vertex_masks[place] != expected_mask {
                return Err(format!("the mask of triangle {triangle} is not that of its corners"));
            }
            for (corner, &vertex_place) in self.corners[place].iter().enumerate() {
                let vertex_place = vertex_place as usize;
                let vertex = mesh.topology().triangles()[triangle as usize][corner];
                let position = mesh.positions()[vertex as usize];
                around.include(&position);
                if self.vertices[vertex_place] != vertex {
                    return Err(format!("corner {corner} of triangle {triangle} is another vertex"));
                }
                if (0..3).any(|axis| self.positions[axis][vertex_place] != position[axis]) {
                    return Err(format!("vertex {vertex} is not where the mesh has it"));
                }
            }
        }
        if self.aabb() == around { Ok(()) } else { Err("its box is not that of its triangles".to_owned()) }
    }
}
