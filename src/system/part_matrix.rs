//! The rows' matrix, their potential and their couplings part by part, as [`super::parts`] has forces and products.

use super::solve::check_count;
use super::{ContactSystem, SystemError};
use crate::math::Scalar;
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
    /// By rows.
    pub numbers: [f64; 9],
}

/// Room for blocks, and for the order in which they came.
#[derive(Debug, Default)]
pub(super) struct Matrix {
    found: Vec<(usize, PartBlock)>,
    sums: Vec<PartBlock>,
}

impl<T: Scalar> ContactSystem<T> {
    /// The matrix of [`add_product`](Self::add_product) part by part: what each pair adds to the rows of each of its bodies,
    /// each place once, in the order of parts, rows and columns.
    ///
    /// # Errors
    /// Those of [`parts`](Self::parts), [`SystemError::NotFinite`].
    pub fn part_blocks(&mut self, factor: f64) -> Result<&[PartBlock], SystemError> {
        super::check_range("factor", &[factor])?;
        self.parts()?;
        let Self { parts, rows, node_masses, .. } = self;
        let mut matrix = std::mem::take(&mut parts.matrix);
        let Matrix { found, sums } = &mut matrix;
        found.clear();
        sums.clear();
        rows.for_each_block(node_masses.len(), factor, |place, row, column, numbers| {
            let (row, column) = (row as u32, column as u32);
            let has_row = |part: &usize| {
                let part = &parts.parts[*part];
                parts.blocks[part.start..part.start + part.count].binary_search(&row).is_ok()
            };
            if let Some(part) = parts.of_pair(rows.rows[place].pair).find(has_row) {
                let order = found.len();
                found.room_for(1).push((order, PartBlock { part, row, column, numbers }));
            }
        });
        // Those of one place in the order in which they came.
        found.sort_unstable_by_key(|(order, block)| (block.part, block.row, block.column, *order));
        for (_, block) in &*found {
            let place = |block: &PartBlock| (block.part, block.row, block.column);
            match sums.last_mut().filter(|sum| place(sum) == place(block)) {
                Some(sum) => (0..9).for_each(|k| sum.numbers[k] += block.numbers[k]),
                None => sums.room_for(1).push(*block),
            }
        }
        self.parts.matrix = matrix;
        Ok(&self.parts.matrix.sums)
    }

    /// Like [`energy`](Self::energy), pair by pair: replaces `joules`, a number for each of [`parts`](Self::parts). The first
    /// part of a pair has all of its energy, the second none; a pair without parts can do no work.
    ///
    /// # Errors
    /// As there, and those of [`parts`](Self::parts).
    pub fn part_energies(&mut self, velocities: &[f64], joules: &mut [f64]) -> Result<(), SystemError> {
        let step = self.check_velocities("velocities", velocities)?;
        let count = self.parts()?.0.len();
        check_count("joules", joules, count)?;
        self.find_motions(velocities, step);
        joules.fill(0.0);
        for (place, row) in self.rows.rows.iter().enumerate().filter(|(_, row)| row.held.pushes) {
            if let Some(part) = self.parts.of_pair(row.pair).next() {
                row.add_energy(
                    &row.force_at(&self.rows.slip_at(place, &self.rows.response)),
                    step.dt,
                    &mut joules[part],
                );
            }
        }
        Ok(())
    }

    /// How strongly the rows that push act on the unknowns, part by part: replaces `couplings`, a number for each block of
    /// [`parts`](Self::parts). Their sums by block are what [`largest_coupling`](Self::largest_coupling) needs.
    ///
    /// # Errors
    /// Those of [`parts`](Self::parts), [`SystemError::WrongCount`].
    pub fn part_couplings(&mut self, couplings: &mut [f64]) -> Result<(), SystemError> {
        let blocks = self.parts()?.1.len();
        check_count("couplings", couplings, blocks)?;
        couplings.fill(0.0);
        let Self { rows, parts, .. } = self;
        rows.for_each_coupling(|place, entry_or_end, coupling| {
            let block = match entry_or_end {
                super::rows::Coupled::Entry(entry) => parts.entries[entry],
                super::rows::Coupled::Linear(side) => parts.rigid[place][side],
                super::rows::Coupled::Angular(side) => parts.rigid[place][side] + 1,
            };
            couplings[block] += coupling;
        });
        Ok(())
    }
}
