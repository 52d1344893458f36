use super::Classic;
use crate::math::{Aabb, Scalar, Vector3};
use crate::mesh::Mesh;

impl<T: Scalar> Classic<T> {
    /// Each triangle lives at one level, in one to eight cells that cover its box, at a level that is large enough;
    /// nodes cover all entries once, children continue their parents.
    pub(in crate::octree) fn validate(&self, mesh: &Mesh<T>) -> Result<(), String> {
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
        let middle = (cell.lower + cell.upper) * T::of(0.5);
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
        let margin = self.side * T::ROUNDING_UNIT * T::of(64.0);
        let side = first.longest_side();
        if side + margin < aabb.longest_side() {
            return Err(format!("triangle {triangle} is larger than its cells at level {level}"));
        }
        let mut union = Aabb::empty();
        for (_, cell) in cells {
            union.include(&cell.lower);
            union.include(&cell.upper);
        }
        let covered = (0..3).all(|axis| {
            union.lower[axis] <= aabb.lower[axis] + margin && aabb.upper[axis] <= union.upper[axis] + margin
        });
        if covered { Ok(()) } else { Err(format!("the cells of triangle {triangle} do not cover its box")) }
    }
}
