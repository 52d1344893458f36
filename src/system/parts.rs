//! Forces and products part by part, a part being what one pair does to one of its bodies. A part does not depend on other
//! pairs, so sums of parts in a fixed order have the same bits, whichever process found the pairs.

use super::loads::{PairLoads, Surface};
use super::part_matrix::Matrix;
use super::row::RigidEnd;
use super::rows::{RowForce, Rows, Velocities};
use super::{ContactSystem, RigidUnknowns, SystemError};
use crate::math::{Scalar, margins};
use crate::memory;
use crate::memory::Room;

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

/// The parts of the present rows, made when they are first asked for.
#[derive(Debug, Default)]
pub(super) struct Parts {
    is_current: bool,
    pub(super) parts: Vec<Part>,
    pub(super) blocks: Vec<u32>,
    /// Of each part the place of its pair, in ascending order.
    pairs: Vec<usize>,
    /// Of each entry of the rows, its block's place among all.
    pub(super) entries: Vec<usize>,
    /// Of each row's rigid bodies, the first of its two blocks.
    pub(super) rigid: Vec<[usize; 2]>,
    /// Scratch memory for the matrix.
    pub(super) matrix: Matrix,
    /// Scratch memory: pair, side and block.
    places: Vec<(usize, usize, u32)>,
}

impl Parts {
    /// To be called when the rows have changed.
    pub(super) fn forget(&mut self) {
        self.is_current = false;
    }

    /// `side` tells to which body of a pair a row's entry belongs.
    fn find(&mut self, rows: &Rows, loads: &PairLoads, nodes: u32, side: impl Fn(u32, u32) -> usize) {
        if self.is_current {
            return;
        }
        let Self { parts, blocks, pairs, entries, rigid, places, .. } = self;
        parts.clear();
        pairs.clear();
        blocks.clear();
        entries.clear();
        rigid.clear();
        places.clear();
        let of_entry = |row: usize, node: u32| {
            let pair = rows.rows[row].pair;
            (pair, side(loads.now[pair].key.0, node), node)
        };
        let of_rigid = |row: usize, end: &RigidEnd, k: usize| {
            let row = &rows.rows[row];
            let side = if row.order < 0.0 { 1 - k } else { k };
            (row.pair, side, nodes + 2 * end.place as u32)
        };
        let ends = |row: usize| rows.rows[row].rigid.iter().enumerate().filter_map(|(k, end)| Some((k, end.as_ref()?)));
        for row in 0..rows.rows.len() {
            for entry in &rows.entries[rows.begin(row)..rows.rows[row].end] {
                places.room_for(1).push(of_entry(row, entry.node));
            }
            for (k, end) in ends(row) {
                let (pair, side, block) = of_rigid(row, end, k);
                places.room_for(2).extend([(pair, side, block), (pair, side, block + 1)]);
            }
        }
        places.sort_unstable();
        places.dedup();
        for of_part in places.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let (pair, side, _) = of_part[0];
            let (first, second) = loads.now[pair].key;
            let (body, other) = match second {
                Surface::Body(second) if side == 1 => (second, Surface::Body(first)),
                surface => (first, surface),
            };
            parts.room_for(1).push(Part { body, other, start: blocks.len(), count: of_part.len() });
            pairs.room_for(1).push(pair);
            memory::append(blocks, of_part.iter().map(|&(.., block)| block));
        }
        let place = |of: (usize, usize, u32)| places.binary_search(&of).unwrap_or_default();
        for row in 0..rows.rows.len() {
            let own = &rows.entries[rows.begin(row)..rows.rows[row].end];
            memory::append(entries, own.iter().map(|entry| place(of_entry(row, entry.node))));
            let mut both = [0; 2];
            ends(row).for_each(|(k, end)| both[k] = place(of_rigid(row, end, k)));
            rigid.room_for(1).push(both);
        }
        self.is_current = true;
    }

    /// The indices of a pair's parts; none if it has no unknowns.
    pub(super) fn of_pair(&self, pair: usize) -> std::ops::Range<usize> {
        let first = self.pairs.partition_point(|&other| other < pair);
        first..first + self.pairs[first..].partition_point(|&other| other == pair)
    }

    /// Adds a row's force to what its pair does, as [`Rows::scatter`] adds it to the unknowns.
    fn scatter(&self, rows: &Rows, place: usize, force: &RowForce, numbers: &mut [f64]) {
        let row = &rows.rows[place];
        rows.for_each_node(place, force, |_, entry, force| {
            let block = 3 * self.entries[entry];
            (0..3).for_each(|axis| numbers[block + axis] -= force[axis]);
        });
        for (end, block) in row.rigid.iter().zip(self.rigid[place]) {
            if let Some(end) = end {
                let twist = &mut numbers[3 * block..3 * block + 6];
                RigidEnd { place: 0, ..*end }.add_load(&-force.whole, twist);
            }
        }
    }
}

impl<T: Scalar> ContactSystem<T> {
    /// What the rows of this step act on, pair by pair: the parts, and the blocks of three unknowns of each, numbered as
    /// [`for_each_block`](Self::for_each_block) says, in ascending order. They stay until the step ends or
    /// [`detect_again`](Self::detect_again) finds more.
    ///
    /// # Errors
    /// [`SystemError::NoStep`], [`SystemError::Eliminated`] where there are rigid bodies and they are not kept.
    pub fn parts(&mut self) -> Result<(&[Part], &[u32]), SystemError> {
        self.step.ok_or(SystemError::NoStep)?;
        if self.rigid_unknowns == RigidUnknowns::Eliminated && !self.rows.masses.is_empty() {
            return Err(SystemError::Eliminated);
        }
        let Self { parts, rows, loads, bodies, node_masses, .. } = self;
        let side = |first: u32, node: u32| {
            let place = bodies.binary_search_by_key(&first, |body| body.number).ok();
            let nodes = place.and_then(|place| bodies[place].nodes());
            usize::from(!nodes.is_some_and(|nodes| nodes.contains(&node)))
        };
        parts.find(rows, loads, node_masses.len() as u32, side);
        Ok((&parts.parts, &parts.blocks))
    }

    /// Like [`add_forces`](Self::add_forces), part by part: replaces `forces`, three numbers for each block of
    /// [`parts`](Self::parts).
    ///
    /// # Errors
    /// As there, and those of [`parts`](Self::parts).
    pub fn part_forces(&mut self, velocities: &[f64], forces: &mut [f64]) -> Result<(), SystemError> {
        let step = self.check_velocities("velocities", velocities)?;
        let blocks = self.parts()?.1.len();
        super::solve::check_count("forces", forces, 3 * blocks)?;
        self.find_motions(velocities, step);
        forces.fill(0.0);
        let add = |place: usize, force: RowForce| self.parts.scatter(&self.rows, place, &force, forces);
        self.rows.for_each_force(&self.rows.response, 1.0, add);
        Ok(())
    }

    /// Like [`add_product`](Self::add_product), part by part: replaces `result`, three numbers for each block of
    /// [`parts`](Self::parts).
    ///
    /// # Errors
    /// As there, and those of [`parts`](Self::parts).
    pub fn part_products(&mut self, factor: f64, change: &[f64], result: &mut [f64]) -> Result<(), SystemError> {
        self.check_unknowns("change", change, margins::LARGEST_FACTOR)?;
        super::check_range("factor", &[factor])?;
        let blocks = self.parts()?.1.len();
        super::solve::check_count("result", result, 3 * blocks)?;
        result.fill(0.0);
        let (nodes, twists) = change.split_at(3 * self.node_masses.len());
        self.rows.list_springs();
        let add = |place: usize, force: RowForce| self.parts.scatter(&self.rows, place, &force, result);
        self.rows.for_each_product(Velocities { nodes, twists }, factor, add);
        Ok(())
    }
}
