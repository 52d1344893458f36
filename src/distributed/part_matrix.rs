//! The rows' matrix part by part, each place once.

use crate::memory::Room;

/// A 3 × 3 block of the rows' matrix, which one pair adds to the unknowns of one of its bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartBlock {
    /// The part that its row of blocks is of.
    pub part: usize,
    /// Its row in blocks of three unknowns.
    pub row: u32,
    /// Its column in blocks of three unknowns: of either body of the pair.
    pub column: u32,
    /// Its nine numbers by rows.
    pub numbers: [f64; 9],
}

/// Blocks in the order in which they came, and their sums.
#[derive(Debug, Default)]
pub(super) struct Matrix {
    found: Vec<(usize, PartBlock)>,
    sums: Vec<PartBlock>,
}

impl Matrix {
    pub(super) fn start(&mut self) {
        self.found.clear();
        self.sums.clear();
    }

    pub(super) fn add(&mut self, block: PartBlock) {
        let order = self.found.len();
        self.found.room_for(1).push((order, block));
    }

    /// The sums by place, in the order of parts, rows and columns; blocks of one place are added in the order in which they came.
    pub(super) fn sums(&mut self) -> &[PartBlock] {
        let Self { found, sums } = self;
        found.sort_unstable_by_key(|(order, block)| (block.part, block.row, block.column, *order));
        for (_, block) in &*found {
            let place = |block: &PartBlock| (block.part, block.row, block.column);
            match sums.last_mut().filter(|sum| place(sum) == place(block)) {
                Some(sum) => (0..9).for_each(|k| sum.numbers[k] += block.numbers[k]),
                None => sums.room_for(1).push(*block),
            }
        }
        sums
    }
}
