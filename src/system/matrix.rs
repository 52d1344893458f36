//! The rows' matrix on nodes, assembled. Where many rows act on few nodes, as those of fine skins do in coarse cages, products
//! with it take a small part of the time that they take row by row.

use super::coupling::RigidCoupling;
use super::row::{Entry, Row, Spring};
use crate::math::{Kernel, Lanes, dispatch};
use crate::memory::{self, Room};

/// Rows with more entries than this, such as a push on a whole body, stay out of the matrix: the number of blocks grows with
/// the square of the entries.
const LONGEST: usize = 32;

/// The cost of a block between a node and a rigid body, in blocks between nodes: it has twice the numbers and is used twice.
const WORK_OF_COUPLING: usize = 4;

/// Three numbers, padded to four.
type Four = [f64; 4];

const UNITS: [Four; 3] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

/// Blocks of nodes on and above the diagonal. Each is symmetric, a sum of normal · d dᵀ + tangential · (1 − d dᵀ), and stands
/// for its mirror too.
#[derive(Debug, Default)]
pub(super) struct NodeMatrix {
    /// Whether it belongs to the current linearisation.
    pub(super) is_current: bool,
    /// The node of each line, in ascending order, and where its blocks end; the first of them is the diagonal one.
    lines: Vec<(u32, u32)>,
    /// The line of each block's mirror.
    columns: Vec<u32>,
    /// The blocks by columns, in N s/m.
    blocks: Vec<[Four; 3]>,
    /// The springs that are not in the matrix.
    pub(super) apart: Vec<u32>,
    /// Room: of each node its line; of each line where its entries end, and where its block is in the line under way.
    line_of: Vec<u32>,
    ends: Vec<u32>,
    places: Vec<u32>,
    /// Springs, where their entries end, and those, by ascending line.
    taken: Vec<(u32, u32)>,
    entries: Vec<Entry>,
    /// Among the taken springs and their entries, by line.
    by_line: Vec<(u32, u32)>,
    /// Of each line, in a product.
    change: Vec<Four>,
    result: Vec<Four>,
}

impl NodeMatrix {
    /// Makes it, and the coupling to rigid bodies, that of the springs, or leaves them all apart where products row by row are
    /// cheaper.
    pub(super) fn assemble(
        &mut self,
        (springs, rows, entries): (&[Spring], &[Row], &[Entry]),
        nodes: usize,
        coupling: &mut RigidCoupling,
    ) {
        self.lines.clear();
        self.columns.clear();
        self.blocks.clear();
        self.apart.clear();
        self.apart.room_for(springs.len());
        self.taken.clear();
        self.taken.room_for(springs.len());
        let (mut work_by_rows, mut end) = (0, 0);
        for (spring, place) in springs.iter().zip(0..) {
            let count = spring.end - spring.begin;
            if count > LONGEST {
                self.apart.push(place);
            } else {
                // Across the direction there is as much again, and rigid bodies have to answer first.
                let work = count * if spring.tangential == 0.0 { 1 } else { 2 };
                work_by_rows += if spring.has_rigid_ends { 2 * work } else { work };
                end += count as u32;
                self.taken.push((place, end));
            }
        }
        self.find_lines(springs, entries, nodes);
        let taken = self.taken.iter().map(|&(place, _)| place);
        let couplings = coupling.find_blocks(taken, springs, rows, entries, nodes);
        let work_by_blocks = WORK_OF_COUPLING * couplings;
        if work_by_blocks <= work_by_rows && self.find_blocks(work_by_rows - work_by_blocks) {
            self.blocks.room_for(self.columns.len()).resize(self.columns.len(), [[0.0; 4]; 3]);
            dispatch::<f64, _>(AddUp { matrix: self, springs });
            coupling.add_up(springs, rows, entries);
        } else {
            coupling.clear_blocks();
            self.lines.clear();
            self.apart.clear();
            self.apart.extend(0..springs.len() as u32);
        }
        self.is_current = true;
    }

    fn find_lines(&mut self, springs: &[Spring], entries: &[Entry], nodes: usize) {
        let Self { lines, line_of, ends, taken, entries: own, by_line, .. } = self;
        let of = |place: u32| &entries[springs[place as usize].begin..springs[place as usize].end];
        memory::refill_with(line_of, 0, nodes);
        for &(place, _) in &*taken {
            for entry in of(place) {
                line_of[entry.node as usize] += 1;
            }
        }
        ends.clear();
        let mut sum = 0;
        for (count, node) in line_of.iter_mut().zip(0..) {
            if *count > 0 {
                ends.room_for(1).push(sum);
                sum += *count;
                *count = lines.len() as u32;
                lines.room_for(1).push((node, 0));
            }
        }
        own.clear();
        own.room_for(sum as usize);
        memory::refill_with(by_line, (0, 0), sum as usize);
        for (&(place, _), spring) in taken.iter().zip(0..) {
            let begin = own.len();
            for entry in of(place) {
                let line = line_of[entry.node as usize];
                let mut at = own.len();
                own.push(Entry { node: line, ..*entry });
                while at > begin && own[at - 1].node > line {
                    own.swap(at, at - 1);
                    at -= 1;
                }
            }
            for (entry, at) in own[begin..].iter().zip(begin as u32..) {
                let end = &mut ends[entry.node as usize];
                by_line[*end as usize] = (spring, at);
                *end += 1;
            }
        }
    }

    /// The blocks there are, without their numbers; false where they are more than `most`.
    fn find_blocks(&mut self, most: usize) -> bool {
        let Self { lines, columns, ends, places, taken, entries, by_line, .. } = self;
        memory::refill_with(places, u32::MAX, lines.len());
        let mut begin = 0;
        for (number, (line, &end)) in lines.iter_mut().zip(&*ends).enumerate() {
            let first = columns.len() as u32;
            columns.room_for(1).push(number as u32);
            for &(spring, at) in &by_line[begin..end as usize] {
                for entry in &entries[at as usize + 1..taken[spring as usize].1 as usize] {
                    // Of the lines before it may be that of an earlier one.
                    let place = &mut places[entry.node as usize];
                    if *place == u32::MAX || *place < first {
                        *place = columns.len() as u32;
                        columns.room_for(1).push(entry.node);
                    }
                }
            }
            line.1 = columns.len() as u32;
            if columns.len() > most {
                return false;
            }
            begin = end as usize;
        }
        true
    }

    /// Adds `scale` times the product.
    pub(super) fn add_product(&mut self, change: &[f64], scale: f64, result: &mut [f64]) {
        let Self { lines, change: own, result: sums, .. } = self;
        memory::refill(
            own,
            lines.iter().map(|&(node, _)| {
                let place = &change[3 * node as usize..][..3];
                [place[0] * scale, place[1] * scale, place[2] * scale, 0.0]
            }),
        );
        memory::refill_with(sums, [0.0; 4], lines.len());
        dispatch::<f64, _>(Product { matrix: self });
        for (&(node, _), sum) in self.lines.iter().zip(&self.result) {
            let place = &mut result[3 * node as usize..][..3];
            (0..3).for_each(|axis| place[axis] += sum[axis]);
        }
    }
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
        let NodeMatrix { lines, columns, blocks, ends, places, taken, entries, by_line, .. } = self.matrix;
        let (mut first, mut begin) = (0, 0);
        for (&(_, last), &end) in lines.iter().zip(&*ends) {
            for place in first..last {
                places[columns[place as usize] as usize] = place;
            }
            for &(spring, at) in &by_line[begin as usize..end as usize] {
                let (place, entries_end) = taken[spring as usize];
                let Spring { direction: d, normal, tangential, .. } = &self.springs[place as usize];
                let own = &entries[at as usize];
                let (along, across) = (normal * own.along, tangential * own.across);
                let outer = [d.x, d.y, d.z].map(|by| [d.x * by, d.y * by, d.z * by, 0.0]);
                for entry in &entries[at as usize..entries_end as usize] {
                    let same = across * entry.across;
                    let more = along * entry.along - same;
                    let block = &mut blocks[places[entry.node as usize] as usize];
                    for (column, (outer, unit)) in block.iter_mut().zip(outer.iter().zip(&UNITS)) {
                        for axis in 0..4 {
                            column[axis] += more * outer[axis] + same * unit[axis];
                        }
                    }
                }
            }
            (first, begin) = (last, end);
        }
    }
}

struct Product<'a> {
    matrix: &'a mut NodeMatrix,
}

impl Kernel<f64> for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes<f64>>(self) {
        let NodeMatrix { lines, columns, blocks, change, result, .. } = self.matrix;
        let mut first = 0;
        for (line, &(_, last)) in lines.iter().enumerate() {
            let own = change[line];
            let mut sum = times(&blocks[first], &own);
            let others = first + 1..last as usize;
            for (block, &column) in blocks[others.clone()].iter().zip(&columns[others]) {
                let other = times(block, &change[column as usize]);
                let mirrored = times(block, &own);
                let place = &mut result[column as usize];
                for axis in 0..4 {
                    sum[axis] += other[axis];
                    place[axis] += mirrored[axis];
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
        for (place, &length) in lengths.iter().enumerate() {
            let begin = entries.len();
            for k in 0..length {
                let node = ((5 * place + 11 * k) % NODES) as u32;
                entries.push(Entry { node, along: number(), across: number() });
            }
            let direction = V3::new(number(), number(), number()).normalize();
            let (normal, tangential) = (1.0 + number(), if is_rubbing { 0.6 + number() } else { 0.0 });
            let end = entries.len();
            springs.push(Spring { direction, normal, tangential, place, begin, end, has_rigid_ends: false });
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
    fn the_product_is_that_of_the_rows_and_long_rows_stay_apart() {
        for is_rubbing in [false, true] {
            let mut lengths = vec![8; 60];
            lengths[7] = LONGEST + 1;
            lengths[20] = 1;
            let (springs, entries) = rows(&lengths, is_rubbing);
            let change: Vec<f64> = (0..3 * NODES).map(|k| (k as f64).sin()).collect();
            let mut matrix = NodeMatrix::default();
            for _ in 0..2 {
                matrix.assemble((&springs, &[], &entries), NODES, &mut RigidCoupling::default());
                assert_eq!(matrix.apart, [7]);
                let mut result = vec![0.0; change.len()];
                matrix.add_product(&change, 0.7, &mut result);
                let taken: Vec<Spring> = springs.iter().filter(|spring| spring.place != 7).copied().collect();
                let expected = expected(&taken, &entries, &change, 0.7);
                let error = result.iter().zip(&expected).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
                assert!(error < 1e-13 * expected.iter().fold(0.0, |most: f64, x| most.max(x.abs())), "{error}");
            }
        }
    }

    #[test]
    fn few_rows_on_many_nodes_are_not_assembled() {
        let (springs, entries) = rows(&[8], false);
        let mut matrix = NodeMatrix::default();
        matrix.assemble((&springs, &[], &entries), NODES, &mut RigidCoupling::default());
        assert_eq!(matrix.apart, [0]);
        let mut result = vec![0.0; 3 * NODES];
        matrix.add_product(&vec![1.0; 3 * NODES], 1.0, &mut result);
        assert!(result.iter().all(|x| *x == 0.0));
    }
}
