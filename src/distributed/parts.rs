//! Forces and products part by part, a part being what one pair does to one of its bodies. A part does not depend on other
//! pairs, so sums of parts in a fixed order have the same bits, whichever process found the pairs. What a contact system has too
//! fails as it does there.

use super::part_matrix::{Matrix, PartBlock};
use crate::math::{Scalar, margins};
use crate::memory::{self, Room};
use crate::system::hooks::{RowForce, Rows, Velocities};
use crate::system::{ContactSystem, Surface, SystemError, check_count, check_range, check_within};
use std::ops::Range;

/// What a pair does to one of its bodies: where its blocks lie among those of all parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// The body that it acts on.
    pub body: u32,
    /// What it touches: itself too.
    pub other: Surface,
    /// The first of its blocks.
    pub start: usize,
    /// How many blocks it has.
    pub count: usize,
}

/// The parts of a contact system's present rows, found anew where these have changed.
#[derive(Debug, Default)]
pub struct Parts {
    /// The stamp of the rows that the parts were found for.
    stamp: u64,
    parts: Vec<Part>,
    /// The blocks of all parts, one part after the other.
    blocks: Vec<u32>,
    /// By part the place of its pair, ascending.
    pairs: Vec<usize>,
    /// By slot of the rows where its block stands in `blocks`.
    slots: Vec<usize>,
    /// Scratch memory for the matrix.
    matrix: Matrix,
    /// Scratch memory: pair, side and block, each once; and those of each slot.
    places: Vec<(usize, usize, u32)>,
    of_slots: Vec<(usize, (usize, usize, u32))>,
}

/// A step's rows in parts. They stay until the step ends or [`detect_again`](ContactSystem::detect_again) finds more.
#[derive(Debug)]
pub struct PartsOf<'a, T: Scalar> {
    found: &'a mut Parts,
    system: &'a mut ContactSystem<T>,
}

impl Parts {
    /// The rows of a system's step, part by part.
    ///
    /// # Errors
    /// [`SystemError::NoStep`], [`SystemError::Eliminated`] where there are rigid bodies and they are not kept.
    pub fn of<'a, T: Scalar>(&'a mut self, system: &'a mut ContactSystem<T>) -> Result<PartsOf<'a, T>, SystemError> {
        system.check_has_blocks()?;
        if self.stamp != system.rows.stamp {
            self.find(system);
            self.stamp = system.rows.stamp;
        }
        Ok(PartsOf { found: self, system })
    }

    fn find<T: Scalar>(&mut self, system: &ContactSystem<T>) {
        let Self { parts, blocks, pairs, slots, places, of_slots, .. } = self;
        parts.clear();
        pairs.clear();
        blocks.clear();
        places.clear();
        of_slots.clear();
        let (rows, nodes) = (&system.rows, system.node_masses.len());
        let pair_of = |pair: usize| system.loads.now[pair].key;
        for (place, row) in rows.rows.iter().enumerate() {
            let first = system.nodes_of(pair_of(row.pair).0);
            rows.for_each_slot(place, nodes, |slot, block, rigid, _| {
                let is_second = match rigid {
                    Some(side) => (side == 1) != (row.order < 0.0),
                    None => !first.contains(&(block as u32)),
                };
                of_slots.room_for(1).push((slot, (row.pair, usize::from(is_second), block as u32)));
            });
        }
        memory::append(places, of_slots.iter().map(|(_, place)| *place));
        places.sort_unstable();
        places.dedup();
        for of_part in places.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let (pair, side, _) = of_part[0];
            let (first, second) = pair_of(pair);
            let (body, other) = match second {
                Surface::Body(second) if side == 1 => (second, Surface::Body(first)),
                surface => (first, surface),
            };
            parts.room_for(1).push(Part { body, other, start: blocks.len(), count: of_part.len() });
            pairs.room_for(1).push(pair);
            memory::append(blocks, of_part.iter().map(|&(.., block)| block));
        }
        memory::refill_with(slots, 0, of_slots.iter().map(|(slot, _)| slot + 1).max().unwrap_or(0));
        for (slot, place) in of_slots {
            slots[*slot] = places.binary_search(place).unwrap_or_default();
        }
    }

    /// Adds what a row's force does to all that it acts on.
    fn add(&self, rows: &Rows, place: usize, force: &RowForce, numbers: &mut [f64]) {
        rows.for_each_load(place, force, |slot, load| {
            let block = 3 * self.slots[slot];
            (0..3).for_each(|axis| numbers[block + axis] += load[axis]);
        });
    }
}

impl<'a, T: Scalar> PartsOf<'a, T> {
    /// What the rows act on, pair by pair: the parts, and the blocks of three unknowns of each, numbered as
    /// [`for_each_block`](ContactSystem::for_each_block) says, in ascending order.
    pub fn lists(self) -> (&'a [Part], &'a [u32]) {
        (&self.found.parts, &self.found.blocks)
    }

    /// Like [`add_forces`](ContactSystem::add_forces), part by part: replaces `forces`, three numbers for each block.
    pub fn forces(&mut self, velocities: &[f64], forces: &mut [f64]) -> Result<(), SystemError> {
        let Self { found, system } = self;
        let step = system.check_velocities(velocities)?;
        check_count("forces", forces.len(), 3 * found.blocks.len())?;
        system.find_motions(velocities, step);
        forces.fill(0.0);
        let rows = &system.rows;
        rows.for_each_force(&rows.response, 1.0, |place, force| found.add(rows, place, &force, forces));
        Ok(())
    }

    /// Like [`add_product`](ContactSystem::add_product), part by part: replaces `result`, three numbers for each block.
    pub fn products(&mut self, factor: f64, change: &[f64], result: &mut [f64]) -> Result<(), SystemError> {
        let Self { found, system } = self;
        system.check_unknowns("change", change, margins::LARGEST_FACTOR)?;
        check_range("factor", &[factor])?;
        check_count("result", result.len(), 3 * found.blocks.len())?;
        result.fill(0.0);
        let (nodes, twists) = change.split_at(3 * system.node_masses.len());
        system.rows.list_springs();
        let (rows, change) = (&system.rows, Velocities { nodes, twists });
        rows.for_each_product(change, factor, |place, force| found.add(rows, place, &force, result));
        Ok(())
    }

    /// The matrix of [`add_product`](ContactSystem::add_product) part by part: what each pair adds to the rows of each of its
    /// bodies, each place once, in the order of parts, rows and columns.
    ///
    /// # Errors
    /// [`SystemError::NotFinite`].
    pub fn matrix(self, factor: f64) -> Result<&'a [PartBlock], SystemError> {
        check_range("factor", &[factor])?;
        let (nodes, rows) = (self.system.node_masses.len(), &self.system.rows);
        let Parts { parts, blocks, pairs, matrix, .. } = self.found;
        matrix.start();
        rows.for_each_block(nodes, factor, |pair, row, column, numbers| {
            let has_row = |part: &usize| {
                let part = &parts[*part];
                blocks[part.start..part.start + part.count].binary_search(&(row as u32)).is_ok()
            };
            if let Some(part) = of_pair(pairs, pair).find(has_row) {
                matrix.add(PartBlock { part, row: row as u32, column: column as u32, numbers });
            }
        });
        Ok(matrix.sums())
    }

    /// Like [`energy`](ContactSystem::energy), pair by pair: replaces `joules`, a number for each part. The first part of a pair
    /// has all of its energy, the second none; a pair without parts can do no work.
    pub fn energies(&mut self, velocities: &[f64], joules: &mut [f64]) -> Result<(), SystemError> {
        let Self { found, system } = self;
        let step = system.check_velocities(velocities)?;
        check_count("joules", joules.len(), found.parts.len())?;
        system.find_motions(velocities, step);
        joules.fill(0.0);
        for (pair, energy) in system.rows.energies(step.dt) {
            of_pair(&found.pairs, pair).take(1).for_each(|part| joules[part] += energy);
        }
        Ok(())
    }

    /// How strongly the rows that push act on the unknowns, part by part: replaces `couplings`, a number for each block. Their
    /// sums by block are what [`largest_coupling`] needs.
    ///
    /// # Errors
    /// [`SystemError::WrongCount`].
    pub fn couplings(&mut self, couplings: &mut [f64]) -> Result<(), SystemError> {
        let Self { found, system } = self;
        check_count("couplings", couplings.len(), found.blocks.len())?;
        couplings.fill(0.0);
        let add = |slot: usize, _, coupling: f64| couplings[found.slots[slot]] += coupling;
        system.rows.for_each_coupling(system.node_masses.len(), add);
        Ok(())
    }
}

/// The indices of a pair's parts; none if it has no unknowns.
fn of_pair(pairs: &[usize], pair: usize) -> Range<usize> {
    let first = pairs.partition_point(|&other| other < pair);
    first..first + pairs[first..].partition_point(|&other| other == pair)
}

/// By the sums of [couplings](PartsOf::couplings), a number for each block of three unknowns, a bound on the largest eigenvalue λ
/// of M⁻¹ K, in 1/s², and the largest damping time τ of rows that push, in s. Both zero without contact. Where scenes share
/// bodies the larger of all systems count, and steps are stable up to √(τ² + 4 / λ) − τ.
///
/// # Errors
/// [`SystemError::NoStep`], [`SystemError::WrongCount`], [`SystemError::NotFinite`].
pub fn largest_coupling<T: Scalar>(system: &ContactSystem<T>, sums: &[f64]) -> Result<[f64; 2], SystemError> {
    system.step.ok_or(SystemError::NoStep)?;
    check_count("sums", sums.len(), system.node_masses.len() + 2 * system.rigid_count)?;
    check_within("sums", sums, margins::LARGEST_FACTOR)?;
    Ok(system.largest_with(sums))
}
