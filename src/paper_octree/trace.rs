use crate::math::{Aabb, Scalar, Vector3, margins};
use crate::paper_octree::slabs::Slabs;
use crate::paper_octree::tree::{Node, PaperOctree};
use crate::triangle::Ray;

impl<T: Scalar> PaperOctree<T> {
    /// Offers every triangle that the ray may meet up to the `t` that `visitor` last returned; a triangle that lives
    /// in several cells may be offered several times.
    pub(crate) fn visit(&self, ray: &Ray<T>, mesh_box: &Aabb<T>, visitor: &mut impl FnMut(u32) -> T) {
        let mut slabs = Slabs::new(ray, mesh_box);
        slabs.origin -= self.corner;
        slabs.margin *= T::of(margins::CELL_FACE);
        let mirror = (0..3).map(|axis| usize::from(slabs.is_mirrored(axis)) << axis).sum();
        let mut walk = Walk { cells: self, slabs, mirror, t_max: ray.t_max, visitor };
        walk.descend(&self.nodes[0], Vector3::zeros(), self.side);
    }
}

/// One ray's way through the cells, after Revelles, Ureña and Lastra 2000, "An efficient parametric algorithm for
/// octree traversal": each face plane is a value of `t`, and mirroring the axes along which the ray runs backwards puts
/// the octants in the order 0…7 for every ray. Unlike theirs, each child's interval is tested by itself, with outward
/// margins, so that a ray along a shared face visits both sides and nothing is lost to rounding.
struct Walk<'a, T: Scalar, V> {
    cells: &'a PaperOctree<T>,
    slabs: Slabs<T>,
    /// Bit i: the ray runs backwards along axis i.
    mirror: usize,
    t_max: T,
    visitor: &'a mut V,
}

impl<T: Scalar, V: FnMut(u32) -> T> Walk<'_, T, V> {
    /// Where the ray enters and leaves the first and the second half of a cell along one axis, in the ray's order.
    fn halves(&self, axis: usize, lower: T, side: T) -> [(T, T); 2] {
        let (middle, upper) = (lower + side * T::of(0.5), lower + side);
        let (from, to) = (self.slabs.at_lower(axis, lower), self.slabs.at_upper(axis, upper));
        let (middle_from, middle_to) = (self.slabs.at_lower(axis, middle), self.slabs.at_upper(axis, middle));
        if self.slabs.is_mirrored(axis) {
            [(to, middle_from), (middle_to, from)]
        } else {
            [(from, middle_to), (middle_from, to)]
        }
    }

    fn descend(&mut self, node: &Node, lower: Vector3<T>, side: T) {
        for entry in &self.cells.entries[node.first_entry as usize..node.own_end as usize] {
            self.t_max = (self.visitor)(entry.triangle);
        }
        if node.children == 0 {
            return;
        }
        let halves: [_; 3] = std::array::from_fn(|axis| self.halves(axis, lower[axis], side));
        let half_side = side * T::of(0.5);
        for in_ray_order in 0..8usize {
            let octant = in_ray_order ^ self.mirror;
            if node.children >> octant & 1 == 0 {
                continue;
            }
            let [x, y, z] = std::array::from_fn(|axis| halves[axis][in_ray_order >> axis & 1]);
            let enters = x.0.max(y.0).max(z.0);
            let leaves = x.1.min(y.1).min(z.1);
            // Written so that NaN, from coordinates near the end of the range, never skips a cell.
            if enters > leaves || leaves < T::zero() || enters > self.t_max {
                continue;
            }
            let rank = (node.children & ((1 << octant) - 1)).count_ones();
            let child_lower =
                Vector3::from_fn(|axis, _| if octant >> axis & 1 == 0 { lower[axis] } else { lower[axis] + half_side });
            let child = &self.cells.nodes[(node.first_child + rank) as usize];
            self.descend(child, child_lower, half_side);
        }
    }
}
