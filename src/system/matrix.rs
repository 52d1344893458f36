//! The rows' matrix on nodes, assembled. Where many rows act on few nodes, as those of fine skins do in coarse cages, products
//! with it take a small fraction of the time that they take row by row.

use super::coupling::RigidCoupling;
use super::lines::{Four, Lines};
use super::row::{Entry, Row, Spring};
use crate::memory::{self, Room};
use crate::simd::{Kernel, Lanes, dispatch};

/// Rows with more entries than this, such as a push on a whole body, stay out of the matrix: the number of blocks grows with
/// the square of the entries.
const LONGEST: usize = 32;

/// How long things take beside one another. In each product: a spring, each of its entries without friction and with it, a
/// block, and a block between a node and a rigid body, which has twice the numbers and is used twice. Once, to assemble: a
/// spring, an entry, each two entries of a spring, and a block. The second number of springs, and of their entries when
/// assembled, is for those on rigid bodies, which have to answer first.
mod work {
    pub(super) const SPRING: [usize; 2] = [24, 190];
    pub(super) const ENTRY: [usize; 2] = [10, 16];
    pub(super) const BLOCK: usize = 15;
    pub(super) const COUPLING: usize = 120;
    pub(super) const SPRING_ONCE: [usize; 2] = [0, 1000];
    pub(super) const ENTRY_ONCE: [usize; 2] = [40, 340];
    pub(super) const TWO_ENTRIES_ONCE: usize = 44;
    pub(super) const BLOCK_ONCE: usize = 100;
}

/// Looking for blocks takes time too. Where they were too many, their number for each entry is remembered; each linearisation
/// forgets this fraction of it, until they are looked for again.
const FORGOTTEN: f64 = 0.03;

/// How many products solves ask for: since the last linearisation, and before.
#[derive(Debug, Default)]
pub(super) struct ProductCount {
    now: usize,
    before: Option<usize>,
}

impl ProductCount {
    /// Where nothing is known yet.
    const TYPICAL: usize = 30;

    pub(super) fn add_one(&mut self) {
        self.now += 1;
    }

    pub(super) fn linearise(&mut self) {
        if self.now > 0 {
            self.before = Some(self.before.map_or(self.now, |before| (before + self.now).div_ceil(2)));
            self.now = 0;
        }
    }

    /// How many there will be until the next linearisation: a mean, because later solves of a step ask for fewer than the first.
    pub(super) fn expected(&self) -> usize {
        self.before.unwrap_or(Self::TYPICAL)
    }
}

/// Blocks of lines on and above the diagonal. Each is symmetric, a sum of normal · d dᵀ + tangential · (1 − d dᵀ), and stands
/// for its mirror too.
#[derive(Debug, Default)]
pub(super) struct NodeMatrix {
    /// Where the blocks of each line end; the first of them is the diagonal one.
    lines: Vec<u32>,
    /// The line of each block's mirror.
    columns: Vec<u32>,
    /// The blocks by columns, in N s/m.
    blocks: Vec<[Four; 3]>,
    /// Scratch memory for their sums: xx, xy, xz, none; yy, yz, zz, and what is to be added to the diagonal.
    sums: Vec<[Four; 2]>,
    /// Scratch memory: of each line where its entries end, and its block in the line under way.
    ends: Vec<u32>,
    block_of_line: Vec<u32>,
    /// The springs in the matrix, with where their entries end, and these, by ascending line.
    taken: Vec<(u32, u32)>,
    entries: Vec<Entry>,
    /// By line, each entry's spring among the taken ones, and its own index.
    by_line: Vec<(u32, u32)>,
    /// How many they were for each entry when they were too many to assemble.
    blocks_per_entry: f64,
}

impl NodeMatrix {
    /// Assembles the matrix, and the springs' coupling to rigid bodies, if that is less work than this many products row by
    /// row; else gives false.
    pub(super) fn assemble(
        &mut self,
        springs: &[Spring],
        rows: &[Row],
        lines: &Lines,
        products: usize,
        coupling: &mut RigidCoupling,
    ) -> bool {
        self.lines.clear();
        self.columns.clear();
        coupling.clear_blocks();
        self.taken.clear();
        self.taken.room_for(springs.len());
        let (mut by_rows, mut once, mut end) = (0, 0, 0_u32);
        for (spring, index) in springs.iter().zip(0..).filter(|(spring, _)| is_short(spring)) {
            let count = spring.end - spring.begin;
            let [rubs, is_coupled] = [spring.tangential != 0.0, spring.has_rigid_ends].map(usize::from);
            by_rows += work::SPRING[is_coupled] + work::ENTRY[rubs] * count;
            once += work::SPRING_ONCE[is_coupled] + work::ENTRY_ONCE[is_coupled] * count;
            once += work::TWO_ENTRIES_ONCE * count * (count + 1) / 2;
            end += count as u32;
            self.taken.push((index, end));
        }
        // The work that is left for the blocks of each product.
        let products = products.max(1);
        let left = by_rows.saturating_sub(once / products);
        let of_block = work::BLOCK + work::BLOCK_ONCE / products;
        if left == 0 || self.blocks_per_entry * f64::from(end) > (left / of_block) as f64 {
            self.blocks_per_entry *= 1.0 - FORGOTTEN;
            return false;
        }
        let taken = self.taken.iter().map(|&(index, _)| index);
        let couplings = coupling.find_blocks(taken, springs, rows, lines);
        let left = left.saturating_sub(work::COUPLING * couplings);
        self.order(lines);
        if !self.find_blocks(left / of_block, lines.count()) {
            // As if the other lines had as many each.
            let done = self.lines.len() as f64 / lines.count() as f64;
            let all = self.columns.len() as f64 / done + (couplings * work::COUPLING / work::BLOCK) as f64;
            self.blocks_per_entry = all / f64::from(end);
            coupling.clear_blocks();
            self.lines.clear();
            return false;
        }
        memory::refill_with(&mut self.sums, [[0.0; 4]; 2], self.columns.len());
        dispatch::<f64, _>(AddUp { matrix: self, springs });
        memory::refill(&mut self.blocks, self.sums.iter().map(block));
        coupling.add_up(springs, rows, lines);
        true
    }

    /// Sorts the entries of the springs taken: by line, and by spring and line.
    fn order(&mut self, lines: &Lines) {
        let Self { ends, taken, entries, by_line, .. } = self;
        memory::refill_with(ends, 0, lines.count() + 1);
        for entry in taken.iter().flat_map(|&(index, _)| lines.entries_of(index)) {
            ends[entry.node as usize + 1] += 1;
        }
        (1..ends.len()).for_each(|line| ends[line] += ends[line - 1]);
        let count = ends[lines.count()] as usize;
        memory::refill_with(by_line, (0, 0), count);
        for (&(index, _), spring) in taken.iter().zip(0..) {
            for at in lines.range(index) {
                let end = &mut ends[lines.entries[at as usize].node as usize];
                by_line[*end as usize] = (spring, at);
                *end += 1;
            }
        }
        // Taken line by line, the entries of each spring come in order. Until all are there, a spring's end moves on.
        let mut begin = 0;
        for (_, end) in &mut *taken {
            begin = std::mem::replace(end, begin);
        }
        memory::refill_with(entries, Entry { node: 0, along: 0.0, across: 0.0 }, count);
        for (spring, at) in by_line {
            let (_, end) = &mut taken[*spring as usize];
            entries[*end as usize] = lines.entries[*at as usize];
            *at = std::mem::replace(end, *end + 1);
        }
    }

    /// The blocks there are, without their numbers; false where they are more than `most`.
    fn find_blocks(&mut self, most: usize, count: usize) -> bool {
        let Self { lines, columns, ends, block_of_line, taken, entries, by_line, .. } = self;
        memory::refill_with(block_of_line, u32::MAX, count);
        lines.room_for(count);
        let mut begin = 0;
        for (number, &end) in (0..count as u32).zip(&*ends) {
            let first = columns.len() as u32;
            columns.room_for(count).push(number);
            for &(spring, at) in &by_line[begin..end as usize] {
                for entry in &entries[at as usize + 1..taken[spring as usize].1 as usize] {
                    // It may be a block of an earlier line.
                    let block = &mut block_of_line[entry.node as usize];
                    if *block == u32::MAX || *block < first {
                        *block = columns.len() as u32;
                        columns.push(entry.node);
                    }
                }
            }
            lines.push(columns.len() as u32);
            if columns.len() > most {
                return false;
            }
            begin = end as usize;
        }
        true
    }

    /// Adds the product to the sums of lines.
    pub(super) fn add_product(&self, lines: &mut Lines) {
        dispatch::<f64, _>(Product { matrix: self, lines });
    }
}

pub(super) fn is_short(spring: &Spring) -> bool {
    spring.end - spring.begin <= LONGEST
}

/// A block by columns.
fn block([[xx, xy, xz, _], [yy, yz, zz, more]]: &[Four; 2]) -> [Four; 3] {
    [[xx + more, *xy, *xz, 0.0], [*xy, yy + more, *yz, 0.0], [*xz, *yz, zz + more, 0.0]]
}

/// The numbers of the blocks.
struct AddUp<'a> {
    matrix: &'a mut NodeMatrix,
    springs: &'a [Spring],
}

impl Kernel<f64> for AddUp<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes<f64>>(self) {
        let NodeMatrix { lines, columns, sums, ends, block_of_line, taken, entries, by_line, .. } = self.matrix;
        let (mut first, mut begin) = (0, 0);
        for (&last, &end) in lines.iter().zip(&*ends) {
            for block in first..last {
                block_of_line[columns[block as usize] as usize] = block;
            }
            for &(spring, at) in &by_line[begin as usize..end as usize] {
                let (index, entries_end) = taken[spring as usize];
                let Spring { direction: d, normal, tangential, .. } = &self.springs[index as usize];
                let own = &entries[at as usize];
                let (along, across) = (normal * own.along, tangential * own.across);
                let outer = [[d.x * d.x, d.x * d.y, d.x * d.z, 0.0], [d.y * d.y, d.y * d.z, d.z * d.z, 1.0]];
                for entry in &entries[at as usize..entries_end as usize] {
                    let same = across * entry.across;
                    let more = along * entry.along - same;
                    let by = [more, more, more, same];
                    let sum = &mut sums[block_of_line[entry.node as usize] as usize];
                    for axis in 0..4 {
                        sum[0][axis] += more * outer[0][axis];
                        sum[1][axis] += by[axis] * outer[1][axis];
                    }
                }
            }
            (first, begin) = (last, end);
        }
    }
}

struct Product<'a> {
    matrix: &'a NodeMatrix,
    lines: &'a mut Lines,
}

impl Kernel<f64> for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes<f64>>(self) {
        let NodeMatrix { lines, columns, blocks, .. } = self.matrix;
        let Lines { change, result, .. } = self.lines;
        let mut first = 0;
        for (line, &last) in lines.iter().enumerate() {
            let own = change[line];
            let mut sum = times(&blocks[first], &own);
            let others = first + 1..last as usize;
            for (block, &column) in blocks[others.clone()].iter().zip(&columns[others]) {
                let other = times(block, &change[column as usize]);
                let mirrored = times(block, &own);
                let to = &mut result[column as usize];
                for axis in 0..4 {
                    sum[axis] += other[axis];
                    to[axis] += mirrored[axis];
                }
            }
            for axis in 0..4 {
                result[line][axis] += sum[axis];
            }
            first = last as usize;
        }
    }
}

#[inline(always)]
fn times(block: &[Four; 3], v: &Four) -> Four {
    let mut sum = [0.0; 4];
    for axis in 0..4 {
        sum[axis] = block[0][axis] * v[0] + block[1][axis] * v[1] + block[2][axis] * v[2];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::system::twist::V3;

    const NODES: usize = 12;

    /// Rows of so many entries each, with numbers that follow no pattern.
    fn rows(lengths: &[usize], is_rubbing: bool) -> (Vec<Spring>, Vec<Entry>) {
        let (mut springs, mut entries) = (Vec::new(), Vec::new());
        let mut random = Random::new(1);
        let mut number = || 0.5 * random.signed();
        for (row, &length) in lengths.iter().enumerate() {
            let begin = entries.len();
            for k in 0..length {
                let node = ((5 * row + 11 * k) % NODES) as u32;
                entries.push(Entry { node, along: number(), across: number() });
            }
            let direction = V3::new(number(), number(), number()).normalize();
            let (normal, tangential) = (1.0 + number(), if is_rubbing { 0.6 + number() } else { 0.0 });
            let end = entries.len();
            springs.push(Spring { direction, normal, tangential, row, begin, end, has_rigid_ends: false });
        }
        (springs, entries)
    }

    /// Row by row, from the definition.
    fn expected(springs: &[Spring], entries: &[Entry], change: &[f64], scale: f64) -> Vec<f64> {
        let mut result = vec![0.0; change.len()];
        for spring in springs {
            let own = &entries[spring.begin..spring.end];
            let (mut along, mut across) = (V3::zeros(), V3::zeros());
            for entry in own {
                let v = V3::from_column_slice(&change[3 * entry.node as usize..][..3]);
                along += v * entry.along;
                across += v * entry.across;
            }
            let d = spring.direction;
            let push = d * (scale * spring.normal * d.dot(&along));
            let pull = (across - d * d.dot(&across)) * (scale * spring.tangential);
            for entry in own {
                for axis in 0..3 {
                    result[3 * entry.node as usize + axis] += push[axis] * entry.along + pull[axis] * entry.across;
                }
            }
        }
        result
    }

    #[test]
    fn the_product_is_that_of_the_rows_but_long_ones() {
        for is_rubbing in [false, true] {
            let mut lengths = vec![8; 60];
            lengths[7] = LONGEST + 1;
            lengths[20] = 1;
            let (springs, entries) = rows(&lengths, is_rubbing);
            let change: Vec<f64> = (0..3 * NODES).map(|k| (k as f64).sin()).collect();
            let (mut matrix, mut lines) = (NodeMatrix::default(), Lines::default());
            for _ in 0..2 {
                lines.find(&springs, &entries, NODES);
                assert!(matrix.assemble(&springs, &[], &lines, 1000, &mut RigidCoupling::default()));
                let mut result = vec![0.0; change.len()];
                lines.start_product(&change);
                matrix.add_product(&mut lines);
                lines.finish_product(0.7, &mut result);
                let taken: Vec<Spring> = springs.iter().filter(|spring| spring.row != 7).copied().collect();
                let expected = expected(&taken, &entries, &change, 0.7);
                let error = result.iter().zip(&expected).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
                assert!(error < 1e-13 * expected.iter().fold(0.0, |most: f64, x| most.max(x.abs())), "{error}");
            }
        }
    }

    #[test]
    fn few_rows_on_many_nodes_or_few_products_are_not_worth_it() {
        let mut lines = Lines::default();
        for (lengths, products, is_worth_it) in
            [(vec![8], 1000, false), (vec![8; 60], 1, false), (vec![8; 60], 1000, true)]
        {
            let (springs, entries) = rows(&lengths, false);
            lines.find(&springs, &entries, NODES);
            let mut matrix = NodeMatrix::default();
            assert_eq!(matrix.assemble(&springs, &[], &lines, products, &mut RigidCoupling::default()), is_worth_it);
            lines.start_product(&[1.0; 3 * NODES]);
            matrix.add_product(&mut lines);
            assert_eq!(lines.result.iter().any(|sum| sum.iter().any(|x| *x != 0.0)), is_worth_it);
        }
    }

    #[test]
    fn where_there_were_too_many_blocks_it_is_tried_again() {
        let (mut matrix, mut lines) = (NodeMatrix::default(), Lines::default());
        let mut assemble = |length: usize| {
            let (springs, entries) = rows(&vec![8; length], false);
            lines.find(&springs, &entries, NODES);
            matrix.assemble(&springs, &[], &lines, 1000, &mut RigidCoupling::default())
        };
        assert!(!assemble(1) && !assemble(60));
        assert!((0..100).any(|_| assemble(60)));
    }
}
