use crate::math::{Aabb, Scalar, Vector3, margins};
use crate::mesh::Mesh;
use crate::paper_octree::tree::PaperOctree;

impl<T: Scalar> PaperOctree<T> {
    /// Each triangle lives at one level, in one to eight cells that cover its box, at a level that is large enough;
    /// nodes cover all entries once, children continue their parents.
    pub(crate) fn validate(&self, mesh: &Mesh<T>) -> Result<(), String> {
        let mut cells_of = vec![Vec::new(); mesh.topology().triangles().len()];
        let mut entries_seen = 0;
        let root = Aabb { lower: Vector3::zeros(), upper: Vector3::repeat(self.side) };
        self.validate_node(0, root, &mut |triangle, level, cell| {
            entries_seen += 1;
            cells_of[triangle as usize].push((level, cell));
        })?;
        if entries_seen != self.entries.len() {
            return Err(format!("{entries_seen} of {} entries belong to nodes", self.entries.len()));
        }
        for (triangle, cells) in cells_of.iter().enumerate() {
            self.validate_triangle(mesh, triangle as u32, cells)?;
        }
        Ok(())
    }

    fn validate_node(
        &self,
        index: usize,
        cell: Aabb<T>,
        entry: &mut impl FnMut(u32, u8, Aabb<T>),
    ) -> Result<(), String> {
        let node = &self.nodes[index];
        let own = node.first_entry as usize..node.own_end as usize;
        for place in own {
            entry(self.entries[place].triangle, node.level, cell);
        }
        let mut expected = node.own_end;
        // Halves first: the sum of both corners may be beyond the precision.
        let middle = cell.lower + (cell.upper - cell.lower) * T::of(0.5);
        let octants = (0..8usize).filter(|octant| node.children >> octant & 1 == 1);
        for (rank, octant) in octants.enumerate() {
            let child_index = node.first_child as usize + rank;
            let child = self.nodes.get(child_index).ok_or(format!("node {index} has a child beyond the last node"))?;
            if child_index <= index || child.first_entry != expected || child.level != node.level + 1 {
                return Err(format!("node {child_index} does not continue its parent {index}"));
            }
            expected = child.subtree_end;
            let upper_half = |axis: usize| octant >> axis & 1 == 1;
            let child_cell = Aabb {
                lower: Vector3::from_fn(|axis, _| if upper_half(axis) { middle[axis] } else { cell.lower[axis] }),
                upper: Vector3::from_fn(|axis, _| if upper_half(axis) { cell.upper[axis] } else { middle[axis] }),
            };
            self.validate_node(child_index, child_cell, entry)?;
        }
        if expected != node.subtree_end {
            return Err(format!("the children of node {index} leave out entries"));
        }
        Ok(())
    }

    fn validate_triangle(&self, mesh: &Mesh<T>, triangle: u32, cells: &[(u8, Aabb<T>)]) -> Result<(), String> {
        let aabb = Aabb::of_triangle(&mesh.corners(triangle).map(|corner| corner - self.corner));
        let Some(&(level, first)) = cells.first() else {
            return Err(format!("triangle {triangle} is in no cell"));
        };
        if cells.len() > 8 || cells.iter().any(|cell| cell.0 != level) {
            return Err(format!("triangle {triangle} is in {} cells or at several levels", cells.len()));
        }
        // Planes are rounded once per level on the way down.
        let margin = self.side * margins::margin(margins::CELL_PLANE);
        let side = first.longest_side();
        if side + margin < aabb.longest_side() {
            return Err(format!("triangle {triangle} is larger than its cells at level {level}"));
        }
        let union = cells.iter().fold(Aabb::empty(), |union, (_, cell)| union.union(cell)).grown(margin);
        let covered = union.contains(&aabb.lower) && union.contains(&aabb.upper);
        if covered { Ok(()) } else { Err(format!("the cells of triangle {triangle} do not cover its box")) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cuboid::CUBOID_FACES;
    use crate::shapes;

    /// A ball of 320 triangles, drawn out to one side so that they are of many sizes.
    fn ball() -> Mesh<f64> {
        let radius = |x: f64| 0.1 + 0.5 * (1.0 + x).powi(2);
        shapes::sphere(2).map(|point| point.map(|x| x * radius(point[0]))).mesh()
    }

    fn assert_said(part: &str, change: impl FnOnce(&mut PaperOctree<f64>)) {
        let mesh = ball();
        let mut cells = PaperOctree::new(&mesh);
        cells.validate(&mesh).expect("it is whole");
        change(&mut cells);
        let what = cells.validate(&mesh).expect_err(part);
        assert!(what.contains(part), "{what:?} does not say {part:?}");
    }

    /// Found by fuzzing: with coordinates this large, the sum of two corners of a cell is beyond double precision.
    #[test]
    fn cells_of_the_largest_positions_are_found_whole() {
        let far = [-1.371_505_903_715_674_6e304, -1.068_201_699_677_931e308];
        let positions = [
            [-0.03125, -0.03125, -2.1875],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 0.0, 1.0],
            [far[0], -0.03125, -0.03125],
            [far[1], -0.03125, -0.03125],
        ];
        let mesh = Mesh::open(&positions, &CUBOID_FACES).expect("all is finite");
        assert_eq!(PaperOctree::new(&mesh).validate(&mesh), Ok(()));
    }

    /// The places of the entries at one level.
    fn entries_at(cells: &PaperOctree<f64>, level: u8) -> Vec<usize> {
        let nodes = cells.nodes.iter().filter(|node| node.level == level);
        nodes.flat_map(|node| node.first_entry as usize..node.own_end as usize).collect()
    }

    /// Levels that hold triangles.
    fn levels(cells: &PaperOctree<f64>) -> Vec<u8> {
        (0..20).filter(|&level| !entries_at(cells, level).is_empty()).collect()
    }

    #[test]
    fn faults_of_nodes_are_told() {
        assert_said("entries belong to nodes", |cells| cells.entries.push(cells.entries[0]));
        assert_said("leave out entries", |cells| cells.nodes[0].subtree_end -= 1);
        assert_said("does not continue its parent 0", |cells| cells.nodes[1].level += 1);
        assert_said("does not continue its parent 0", |cells| cells.nodes[1].first_entry += 1);
        assert_said("node 0 does not continue its parent 0", |cells| cells.nodes[0].first_child = 0);
        assert_said("has a child beyond the last node", |cells| cells.nodes[0].first_child = cells.nodes.len() as u32);
    }

    #[test]
    fn triangles_in_wrong_cells_are_told() {
        assert_said("triangle 0 is in no cell", |cells| {
            cells.entries.iter_mut().filter(|entry| entry.triangle == 0).for_each(|entry| entry.triangle = 1);
        });
        assert_said("at several levels", |cells| {
            let levels = levels(cells);
            assert!(levels.len() > 1);
            for level in levels {
                let place = entries_at(cells, level)[0];
                cells.entries[place].triangle = 0;
            }
        });
        assert_said("triangle 0 is in ", |cells| {
            let level = levels(cells).into_iter().max_by_key(|&level| entries_at(cells, level).len()).expect("some");
            cells.entries.iter_mut().filter(|entry| entry.triangle == 0).for_each(|entry| entry.triangle = 1);
            let places = entries_at(cells, level);
            places.into_iter().take(9).for_each(|place| cells.entries[place].triangle = 0);
        });
    }

    /// Cells of one position of the mesh, held against another.
    #[test]
    fn cells_of_other_positions_are_told() {
        let mut mesh = ball();
        let cells = PaperOctree::new(&mesh);
        let rest = mesh.positions().to_vec();
        let mut said_of = |map: &dyn Fn(&Vector3<f64>) -> Vector3<f64>| {
            mesh.set_positions_with(rest.len(), |vertex| map(&rest[vertex])).expect("finite");
            cells.validate(&mesh).expect_err("they do not fit")
        };
        assert!(said_of(&|point| point * 8.0).contains("is larger than its cells at level"));
        for axis in 0..3 {
            for by in [-0.5, 0.5] {
                let shift = Vector3::from_fn(|a, _| if a == axis { by } else { 0.0 });
                assert!(said_of(&|point| point + shift).contains("do not cover its box"));
            }
        }
    }
}
