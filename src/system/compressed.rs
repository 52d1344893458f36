//! The rows' matrix as libraries for sparse matrices take it: three arrays of numbers.

use super::rows::Rows;
use crate::memory::{self, Room};

/// A matrix in compressed sparse rows (CSR): row i has the numbers `offsets[i]` to `offsets[i + 1]` of both others. Columns
/// ascend within each row, none comes twice, and there is one offset more than rows.
#[derive(Clone, Copy, Debug)]
pub struct CompressedRows<'a> {
    /// Where each row begins, and where the last one ends.
    pub offsets: &'a [i32],
    /// The column of each number.
    pub columns: &'a [i32],
    /// The numbers.
    pub values: &'a [f64],
}

/// Memory for such a matrix.
#[derive(Debug, Default)]
pub(super) struct Compressed {
    offsets: Vec<i32>,
    columns: Vec<i32>,
    values: Vec<f64>,
    /// Scratch memory: by block of three unknowns the rows that push on it, and where those of each block end.
    pushing: Vec<u32>,
    ends: Vec<u32>,
    /// Scratch memory: the blocks in the line under way, and in which line each was last.
    line: Vec<u32>,
    seen: Vec<u32>,
}

impl Compressed {
    /// Assembles `scale` · JᵀDJ of so many nodes, in `blocks` blocks of three unknowns; false where an index would be above
    /// `most`.
    pub(super) fn assemble(&mut self, rows: &Rows, nodes: usize, blocks: usize, scale: f64, most: i32) -> bool {
        let Self { offsets, columns, values, pushing, ends, line, seen } = self;
        if 3 * blocks > most as usize {
            return false;
        }
        memory::refill_with(ends, 0, blocks + 1);
        let pushes = || (0..).zip(&rows.rows).filter(|(_, row)| row.linear.pushes).map(|(index, _)| index);
        for index in pushes() {
            rows.for_each_slot(index as usize, nodes, |_, block, _, _| ends[block + 1] += 1);
        }
        (1..=blocks).for_each(|block| ends[block] += ends[block - 1]);
        memory::refill_with(pushing, 0, ends[blocks] as usize);
        for index in pushes() {
            rows.for_each_slot(index as usize, nodes, |_, block, _, _| {
                pushing[ends[block] as usize] = index;
                ends[block] += 1;
            });
        }

        memory::refill_with(seen, u32::MAX, blocks);
        memory::refill_with(offsets, 0, 1);
        columns.clear();
        let mut begin = 0;
        for (number, &end) in (0..blocks as u32).zip(&*ends) {
            line.clear();
            for &index in &pushing[begin as usize..end as usize] {
                rows.for_each_slot(index as usize, nodes, |_, block, _, _| {
                    if std::mem::replace(&mut seen[block], number) != number {
                        line.room_for(1).push(block as u32);
                    }
                });
            }
            begin = end;
            if columns.len() + 9 * line.len() > most as usize {
                return false;
            }
            line.sort_unstable();
            for _ in 0..3 {
                let unknowns = line.iter().flat_map(|&block| (0..3).map(move |axis| (3 * block + axis) as i32));
                columns.room_for(3 * line.len()).extend(unknowns);
                offsets.room_for(1).push(columns.len() as i32);
            }
        }

        memory::refill_with(values, 0.0, columns.len());
        rows.for_each_block(nodes, scale, |_, row, column, numbers| {
            let first = offsets[3 * row] as usize;
            let length = offsets[3 * row + 1] as usize - first;
            let is_before = |other: &i32| *other < 3 * column as i32;
            let index = first + columns[first..first + length].partition_point(is_before);
            for (k, number) in numbers.into_iter().enumerate() {
                values[index + k / 3 * length + k % 3] += number;
            }
        });
        true
    }

    pub(super) fn matrix(&self) -> CompressedRows<'_> {
        let Self { offsets, columns, values, .. } = self;
        CompressedRows { offsets, columns, values }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::row::{LinearForce, Row};

    /// Two rows on two nodes each, and one that does not push.
    #[test]
    fn a_matrix_beyond_its_indices_is_refused() {
        let mut rows = Rows::default();
        for (nodes, pushes) in [([0, 2], true), ([2, 3], true), ([1, 3], false)] {
            nodes.iter().for_each(|&node| rows.add_distinct(node, 1.0, 1.0));
            let linear = LinearForce { pushes, normal: 1.0, tangential: 1.0, ..LinearForce::default() };
            rows.rows.push(Row { end: rows.entries.len(), linear, ..Row::default() });
        }
        let mut matrix = Compressed::default();
        // Seven blocks of nine numbers, and four of three unknowns.
        assert!(!matrix.assemble(&rows, 4, 4, 1.0, 7 * 9 - 1) && !matrix.assemble(&rows, 4, 40, 1.0, 7 * 9));
        assert!(matrix.assemble(&rows, 4, 4, 1.0, 7 * 9));
        let CompressedRows { offsets, columns, values } = matrix.matrix();
        assert_eq!(offsets, [0, 6, 12, 18, 18, 18, 18, 27, 36, 45, 51, 57, 63]);
        assert_eq!(columns[18..27], [0, 1, 2, 6, 7, 8, 9, 10, 11]);
        assert_eq!(values[18..27], [1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    }
}
