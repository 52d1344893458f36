use crate::math::{Aabb, Scalar, Vector3};
use crate::paper_octree::tree::{Node, PaperOctree};
use crate::triangle::QueryPoint;
use std::cmp::Ordering;

impl<T: Scalar> PaperOctree<T> {
    /// Offers every triangle that may have a point within the squared distance that `visitor` last returned, at first
    /// `square`; a triangle that lives in several cells may be offered several times.
    pub(crate) fn visit_near(&self, query: &QueryPoint<T>, square: T, visitor: &mut impl FnMut(u32) -> T) {
        // Seen from the root's corner, as cells are. Three margins, since the cells' planes are rounded once a level.
        let query = QueryPoint {
            position: query.position - self.corner * query.factor,
            margin: query.margin * T::of(3.0),
            ..*query
        };
        let mut walk = Walk { cells: self, limit: query.square_of_boxes(square), query, visitor };
        walk.descend(&self.nodes[0], Vector3::zeros(), self.side);
    }
}

struct Walk<'a, T: Scalar, V> {
    cells: &'a PaperOctree<T>,
    query: QueryPoint<T>,
    /// Cells at a larger squared distance are passed over.
    limit: T,
    visitor: &'a mut V,
}

impl<T: Scalar, V: FnMut(u32) -> T> Walk<'_, T, V> {
    /// The nearest cells first.
    fn descend(&mut self, node: &Node, lower: Vector3<T>, side: T) {
        for entry in &self.cells.entries[node.first_entry as usize..node.own_end as usize] {
            let square = (self.visitor)(entry.triangle);
            self.limit = self.query.square_of_boxes(square);
        }
        let half_side = side * T::of(0.5);
        let mut children = [(T::INFINITY, 0, lower); 8];
        let mut count = 0;
        for octant in (0..8usize).filter(|octant| node.children >> octant & 1 == 1) {
            let lower =
                Vector3::from_fn(|axis, _| if octant >> axis & 1 == 0 { lower[axis] } else { lower[axis] + half_side });
            let cell = Aabb { lower, upper: lower.add_scalar(half_side) };
            children[count] = (self.query.square_to_box(&cell), node.first_child as usize + count, lower);
            count += 1;
        }
        children[..count].sort_unstable_by(|a, b| a.0.partial_cmp(&b.0).unwrap_or(Ordering::Equal));
        for (square, child, lower) in &children[..count] {
            // Written so that NaN, from coordinates near the end of the range, never skips a cell.
            if *square > self.limit {
                continue;
            }
            self.descend(&self.cells.nodes[*child], *lower, half_side);
        }
    }
}
