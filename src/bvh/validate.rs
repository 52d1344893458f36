use crate::bvh::node::CHILD_COUNT;
use crate::bvh::tile::{Outline, TILE_SIZE, Tile};
use crate::bvh::tree::Bvh;
use crate::math::{Aabb, Scalar};
use crate::mesh::Mesh;

impl<T: Scalar> Bvh<T> {
    /// Each triangle lies in one tile, each tile and node under one box; tiles hold the mesh's corners at their
    /// present positions, and boxes are the tightest around what lies under them.
    pub(crate) fn validate(&self, mesh: &Mesh<T>) -> Result<(), String> {
        let mut tile_of = vec![None; mesh.topology().triangles().len()];
        for (index, (tile, outline)) in self.tiles.iter().zip(&self.outlines).enumerate() {
            tile.validate(outline, self.is_loaded(index), mesh).map_err(|what| format!("tile {index}: {what}"))?;
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
        for (tile, outline) in self.tiles.iter().zip(&self.outlines) {
            let own = (0..TILE_SIZE).filter(|place| tile.owned >> place & 1 == 1);
            own.for_each(|place| owners[outline.vertices[place] as usize] += 1);
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
                    self.outlines[child].aabb
                } else if child <= index {
                    return Err(format!("node {child} comes before its parent {index}"));
                } else {
                    nodes[child] += 1;
                    self.nodes[child].around_children()
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

impl<T: Scalar> Tile<T> {
    fn validate(&self, outline: &Outline<T>, is_loaded: bool, mesh: &Mesh<T>) -> Result<(), String> {
        let count = self.triangles().len();
        if !(1..=TILE_SIZE).contains(&count) || u32::from(self.present) != (1u32 << count) - 1 {
            return Err(format!("it has {count} triangles"));
        }
        let mut around = Aabb::empty();
        for place in 0..count {
            let triangle = self.triangles[place];
            for corner in 0..3 {
                let vertex_place = usize::from(self.corners[corner][place]);
                let vertex = mesh.topology().triangles()[triangle as usize][corner];
                let position = mesh.positions()[vertex as usize];
                around.include(&position);
                if outline.vertices[vertex_place] != vertex {
                    return Err(format!("corner {corner} of triangle {triangle} is another vertex"));
                }
                if is_loaded && (0..3).any(|axis| self.positions[axis][vertex_place] != position[axis]) {
                    return Err(format!("vertex {vertex} is not where the mesh has it"));
                }
            }
        }
        if outline.aabb == around { Ok(()) } else { Err("its box is not that of its triangles".to_owned()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vector3;
    use crate::shapes;

    /// What is said about an octree that was whole before.
    fn said_after(change: impl FnOnce(&mut Bvh<f64>, &Mesh<f64>)) -> Result<(), String> {
        // So many triangles that nodes have nodes under them.
        let mesh = shapes::fan(300).mesh::<f64>();
        let mut tree = Bvh::new(&mesh);
        assert!(tree.nodes.len() > 2 && !tree.nodes[0].is_leaf);
        tree.validate(&mesh).expect("it is whole");
        change(&mut tree, &mesh);
        tree.validate(&mesh)
    }

    fn assert_said(part: &str, change: impl FnOnce(&mut Bvh<f64>, &Mesh<f64>)) {
        let what = said_after(change).expect_err(part);
        assert!(what.contains(part), "{what:?} does not say {part:?}");
    }

    fn forget_last_triangle(tree: &mut Bvh<f64>, index: usize, mesh: &Mesh<f64>) {
        let (tile, outline) = (&mut tree.tiles[index], &mut tree.outlines[index]);
        tile.present >>= 1;
        outline.aabb = Aabb::empty();
        let corners: Vec<Vector3<f64>> = tile.triangles().iter().flat_map(|&triangle| mesh.corners(triangle)).collect();
        corners.iter().for_each(|corner| outline.aabb.include(corner));
    }

    #[test]
    fn faults_of_a_tile_are_told() {
        assert_said("it has 0 triangles", |tree, _| tree.tiles[3].present = 0);
        assert_said("tile 3: it has", |tree, mesh| {
            forget_last_triangle(tree, 3, mesh);
            tree.tiles[3].present <<= 1;
        });
        assert_said("is another vertex", |tree, _| tree.outlines[3].vertices[2] ^= 1);
        assert_said("is not where the mesh has it", |tree, _| tree.tiles[3].positions[1][2] += 1.0);
        assert_said("its box is not that of its triangles", |tree, _| tree.outlines[3].aabb.upper.y += 1.0);
        let unloaded = said_after(|tree, _| {
            (tree.tiles[3].loaded_at, tree.tiles[3].positions[1][2]) = (0, 42.0);
        });
        assert_eq!(unloaded, Ok(()), "positions that are not loaded do not count");
    }

    #[test]
    fn triangles_and_vertices_of_no_tile_or_of_two_are_told() {
        assert_said("is in tiles 0 and 1", |tree, _| {
            tree.tiles[1] = tree.tiles[0].clone();
            tree.outlines[1] = tree.outlines[0].clone();
        });
        assert_said("is in no tile", |tree, mesh| forget_last_triangle(tree, 3, mesh));
        assert_said("is not one tile's own", |tree, _| tree.tiles[3].owned = 0);
        assert_said("is not one tile's own", |tree, _| tree.tiles.iter_mut().for_each(|tile| tile.owned |= 1));
    }

    #[test]
    fn faults_of_nodes_are_told() {
        assert_said("box 1 of node 0 is not the one around its child", |tree, _| tree.nodes[0].lower[2][1] -= 1.0);
        assert_said("box 15 of node 0", |tree, _| {
            tree.nodes[0].set_box(15, &Aabb::of_triangle(&[Vector3::zeros(); 3]))
        });
        assert_said("node 0 comes before its parent 0", |tree, _| tree.nodes[0].first = 0);
        assert_said("lies under 0 boxes", |tree, _| {
            let root = &mut tree.nodes[0];
            root.count -= 1;
            root.set_box(root.count as usize, &Aabb::empty());
        });
        assert_said("tile ", |tree, _| {
            // The last child of the root, which must be told of its new box.
            let (last, place) = (tree.nodes.len() - 1, tree.nodes[0].count as usize - 1);
            let leaf = &mut tree.nodes[last];
            leaf.count -= 1;
            leaf.set_box(leaf.count as usize, &Aabb::empty());
            let around = tree.nodes[last].around_children();
            tree.nodes[0].set_box(place, &around);
        });
    }
}
