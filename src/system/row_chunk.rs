use super::coupling::RigidCoupling;
use super::lines::Lines;
use super::matrix::{NodeMatrix, is_short};
use super::row::{Entry, Row, Spring};
use super::row_by_row::RowByRow;
use crate::memory::Room;
use std::ops::Range;

// What chose these numbers: docs/architecture.md, *Tuned constants*.

/// Rows are divided into chunks of at least so many, and at most so many chunks. They do not depend on the number of threads, so
/// sums over them do not either.
const FEWEST_ROWS: usize = 1024;
const CHUNKS: usize = 8;

/// Rows that follow one another, packed for products.
#[derive(Debug, Default)]
pub(super) struct RowChunk {
    /// Those of the springs that are its rows.
    springs: Range<usize>,
    pub(super) lines: Lines,
    matrix: NodeMatrix,
    pub(super) apart: RowByRow,
    pub(super) coupling: RigidCoupling,
}

impl RowChunk {
    /// Divides the springs, which are in the order of their rows. Chunks that are not needed stay, without any.
    pub(super) fn divide(chunks: &mut Vec<Self>, springs: &[Spring], rows: usize) {
        let count = (rows / FEWEST_ROWS).clamp(1, CHUNKS);
        if chunks.len() < count {
            chunks.room_for(count - chunks.len()).resize_with(count, Self::default);
        }
        for (number, chunk) in chunks.iter_mut().enumerate() {
            let [begin, end] = [number, number + 1]
                .map(|number| springs.partition_point(|spring| spring.row < rows * number.min(count) / count));
            chunk.springs = begin..end;
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.springs.is_empty()
    }

    /// Packs its springs, in the matrix or row by row; `entries` are those of all rows.
    pub(super) fn pack(&mut self, rows: &[Row], entries: &[Entry], springs: &[Spring], nodes: usize, products: usize) {
        let Self { springs: own, lines, matrix, apart, coupling } = self;
        let springs = &springs[own.clone()];
        lines.find(springs, entries, nodes);
        let is_assembled = matrix.assemble(springs, rows, lines, products, coupling);
        apart.clear(springs.len());
        for (spring, index) in springs.iter().zip(0..) {
            if !(is_assembled && is_short(spring)) {
                apart.add(spring, lines.range(index));
            }
        }
    }

    /// Starts a product with the change of the nodes' velocities.
    pub(super) fn start_product(&mut self, nodes: &[f64]) {
        self.lines.start_product(nodes);
        self.matrix.add_product(&mut self.lines);
        self.apart.start_product(&mut self.lines);
    }

    /// Adds `scale` times the loads on rigid bodies by that change.
    pub(super) fn add_to_rigid(&self, rows: &[Row], scale: f64, loads: &mut [f64]) {
        self.coupling.add_to_rigid(&self.lines, scale, loads);
        self.apart.add_to_rigid(rows, scale, loads);
    }

    /// Adds to the nodes what a change of the rigid bodies' velocities does.
    pub(super) fn add_twists(&mut self, rows: &[Row], twists: &[f64]) {
        self.apart.finish_product(rows, twists, &mut self.lines);
        self.coupling.add_to_lines(twists, &mut self.lines);
    }
}
