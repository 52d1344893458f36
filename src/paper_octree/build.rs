use crate::math::{Aabb, Scalar, Vector3};
use crate::memory::Room;
use crate::mesh::Mesh;
use crate::paper_octree::tree::{Entry, Node, PaperOctree};

/// Cells of the deepest level are 2⁻²⁰ of the root; smaller triangles share them.
const DEEPEST_LEVEL: u8 = 20;

impl Entry {
    fn new(triangle: u32, level: u8, cell: [u32; 3]) -> Self {
        Self { path: spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2, triangle, level }
    }

    /// Which child of the cell above, at `level`, leads to this entry.
    fn octant_below(&self, level: u8) -> usize {
        (self.path >> (3 * (self.level - level - 1)) & 7) as usize
    }
}

/// Moves bit i to bit 3 i, for up to 21 bits.
fn spread(bits: u32) -> u64 {
    let mut x = u64::from(bits);
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

impl<T: Scalar> PaperOctree<T> {
    pub(crate) fn build(&mut self, mesh: &Mesh<T>) {
        let aabb = mesh.aabb();
        let side = aabb.longest_side();
        (self.corner, self.side) = (aabb.lower, side);
        self.entries.clear();
        for triangle in 0..mesh.topology().triangles().len() as u32 {
            self.insert(triangle, &Aabb::of_triangle(&mesh.corners(triangle)), side);
        }
        let count = self.entries.len();
        self.scratch.room_for(count.saturating_sub(self.scratch.len())).resize(count, Entry::default());
        self.nodes.clear();
        self.nodes.room_for(1).push(Node { subtree_end: self.entries.len() as u32, ..Node::default() });
        let mut next = 0;
        while next < self.nodes.len() {
            self.split(next);
            next += 1;
        }
    }

    /// Adds the entries of one triangle: one for each cell its box touches at its level.
    fn insert(&mut self, triangle: u32, aabb: &Aabb<T>, root_side: T) {
        let half = T::of(0.5);
        let longest = aabb.longest_side();
        let mut level = 0;
        let mut cell_side = root_side * half;
        while level < DEEPEST_LEVEL && cell_side >= longest {
            level += 1;
            cell_side *= half;
        }
        let (mut lower, mut upper) = self.cell_range(aabb, level);
        // Rounding may spread a box that just fits its cell over three: one level up it touches two again.
        while level > 0 && (0..3).any(|axis| upper[axis] - lower[axis] > 1) {
            level -= 1;
            (lower, upper) = self.cell_range(aabb, level);
        }
        for z in lower[2]..=upper[2] {
            for y in lower[1]..=upper[1] {
                for x in lower[0]..=upper[0] {
                    self.entries.room_for(1).push(Entry::new(triangle, level, [x, y, z]));
                }
            }
        }
    }

    fn cell_range(&self, aabb: &Aabb<T>, level: u8) -> ([u32; 3], [u32; 3]) {
        let cells = 1u32 << level;
        let scale = T::of(f64::from(cells));
        let cell_of = |point: &Vector3<T>| {
            std::array::from_fn(|axis| {
                let place = (point[axis] - self.corner[axis]) / self.side * scale;
                // The conversion saturates, and takes NaN (a root without extent) to 0.
                (place.to_f64() as u32).min(cells - 1)
            })
        };
        (cell_of(&aabb.lower), cell_of(&aabb.upper))
    }

    /// Sorts the entries of a node's subtree into its own and those of each octant, and adds the children.
    fn split(&mut self, index: usize) {
        let Node { first_entry, subtree_end, level, .. } = self.nodes[index];
        let range = first_entry as usize..subtree_end as usize;
        let bin = |entry: &Entry| if entry.level == level { 0 } else { 1 + entry.octant_below(level) };

        let mut bin_end = [0u32; 9];
        for entry in &self.entries[range.clone()] {
            bin_end[bin(entry)] += 1;
        }
        let mut bin_start = [first_entry; 9];
        for i in 0..9 {
            bin_start[i] = if i == 0 { first_entry } else { bin_end[i - 1] };
            bin_end[i] += bin_start[i];
        }
        let mut place = bin_start;
        for entry in &self.entries[range.clone()] {
            let bin = bin(entry);
            self.scratch[place[bin] as usize] = *entry;
            place[bin] += 1;
        }
        self.entries[range.clone()].copy_from_slice(&self.scratch[range]);

        self.nodes[index].own_end = bin_end[0];
        self.nodes[index].first_child = self.nodes.len() as u32;
        for octant in 0..8 {
            let (start, end) = (bin_start[octant + 1], bin_end[octant + 1]);
            if start < end {
                self.nodes[index].children |= 1 << octant;
                self.nodes.room_for(1).push(Node {
                    first_entry: start,
                    subtree_end: end,
                    level: level + 1,
                    ..Node::default()
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The level of a box's entries and their cells, in a root cell of side 1 at the origin.
    fn entries(lower: [f64; 3], upper: [f64; 3]) -> (u8, Vec<[u32; 3]>) {
        let mut cells = PaperOctree {
            corner: Vector3::zeros(),
            side: 1.0,
            nodes: Vec::new(),
            entries: Vec::new(),
            scratch: Vec::new(),
        };
        cells.insert(7, &Aabb { lower: lower.into(), upper: upper.into() }, 1.0);
        assert!(cells.entries.iter().all(|entry| entry.triangle == 7 && entry.level == cells.entries[0].level));
        let along =
            |path: u64, axis: usize| (0..21).map(|bit| (path >> (3 * bit + axis) & 1) << bit).sum::<u64>() as u32;
        let cell = |entry: &Entry| [0, 1, 2].map(|axis| along(entry.path, axis));
        (cells.entries[0].level, cells.entries.iter().map(cell).collect())
    }

    /// At the deepest level whose cells are as large as the box, each cell it touches; x goes fastest.
    #[test]
    fn boxes_live_in_the_cells_they_touch_at_their_level() {
        for size in [1.0, 0.7, 0.5, 0.3, 0.25, 0.11, 0.06, 0.001] {
            let starts = [0.0, 0.1, 0.25, 0.3, 0.62, 0.9].into_iter().filter(|start| start + size <= 1.0);
            for start in starts {
                let (lower, upper) =
                    ([start, 0.9 - start, 0.5 * start], [start + size, 0.91 - start, 0.5 * start + 0.5 * size]);
                let longest = (0..3).map(|axis| upper[axis] - lower[axis]).fold(0.0, f64::max);
                let level = (1..20).take_while(|&level| 0.5f64.powi(level) >= longest).last().unwrap_or(0);
                let count = 2f64.powi(level);
                let cells =
                    |axis: usize| (lower[axis] * count) as u32..=((upper[axis] * count) as u32).min(count as u32 - 1);
                let rows = cells(2).flat_map(|z| cells(1).map(move |y| [y, z]));
                let expected: Vec<_> = rows.flat_map(|[y, z]| cells(0).map(move |x| [x, y, z])).collect();
                assert_eq!(entries(lower, upper), (level as u8, expected), "{size} from {start}");
            }
        }
    }

    /// A box a little longer than a cell, which its length as a rounded number does not show: two cells of the level above,
    /// not three.
    #[test]
    fn a_box_that_rounding_spreads_over_three_cells_lives_one_level_up() {
        let before = 0.25 - 0.5f64.powi(55);
        assert_eq!(0.5 - before, 0.25);
        assert_eq!(entries([before, 0.0, 0.0], [0.5, 0.1, 0.1]), (1, vec![[0, 0, 0], [1, 0, 0]]));
    }
}
