//! One row for each contact, and the sums over all of them.

use super::matrix::ProductCount;
use super::motions::Motions;
use super::rigid_matrix::RigidMatrix;
use super::row::{Entry, RigidEnd, Row, Slip, Spring};
use super::row_chunk::RowChunk;
use super::twist::{Factor, Inertia, V3, angular, at, linear};
use crate::math::margins;
use crate::memory::{self, Room};
use crate::threads::{Helpers, ParallelFor};
use nalgebra::Matrix3;
use std::sync::Weak;

/// All rows, with their entries in one list: a contact may act on any number of nodes.
#[derive(Debug, Default)]
pub(crate) struct Rows {
    /// A number that no other rows have.
    pub(crate) stamp: u64,
    pub(crate) rows: Vec<Row>,
    pub(super) entries: Vec<Entry>,
    /// Scratch memory: of each node its last entry.
    last_entries: Vec<u32>,
    pub(super) motions: Motions,
    /// The rows that push, as products need them, and whether they are listed since the last linearisation.
    pub(super) springs: Vec<Spring>,
    pub(super) are_listed: bool,
    /// Whether the springs are packed for products since then, and as what.
    pub(super) are_packed: bool,
    pub(super) chunks: Vec<RowChunk>,
    pub(super) rigid_matrix: RigidMatrix,
    pub(super) products: ProductCount,
    /// Threads that the host lends.
    pub(super) host: Option<Weak<dyn ParallelFor>>,
    /// Of each rigid body, along the world's axes.
    pub(super) masses: Vec<Inertia>,
    /// The matrix of the rigid bodies, where they are eliminated.
    system: Factor,
    /// How often their answer is corrected.
    corrections: usize,
    /// Work arrays, one twist for each rigid body.
    pub(super) loads: Vec<f64>,
    changes: Vec<f64>,
    pub(crate) response: Vec<f64>,
}

/// The force of a row on its first body.
pub(crate) struct RowForce {
    /// Along the row's direction.
    pub(super) along: f64,
    pub(super) across: V3,
    /// Both together.
    pub(super) whole: V3,
}

/// Velocities of nodes and of rigid bodies.
#[derive(Clone, Copy)]
pub(crate) struct Velocities<'a> {
    pub(crate) nodes: &'a [f64],
    pub(crate) twists: &'a [f64],
}

impl Rows {
    /// The host's threads, if it lends them and there `is_much` to do.
    pub(super) fn helpers(&self, is_much: bool) -> Helpers {
        self.host.as_ref().filter(|_| is_much).and_then(Weak::upgrade).map_or(Helpers::Nobody, Helpers::Host)
    }

    pub(super) fn clear(&mut self) {
        self.rows.clear();
        self.entries.clear();
        self.springs.clear();
        self.motions.clear();
    }

    /// To be called before rows are added for a host with so many nodes.
    pub(super) fn make_room(&mut self, nodes: usize) {
        let known = self.last_entries.len();
        if nodes > known {
            self.last_entries.room_for(nodes - known).resize(nodes, 0);
        }
    }

    /// Adds an entry to the row under way; a node that is in it already gets the sum. `begin`: the row's first entry.
    pub(super) fn add(&mut self, begin: usize, own: Entry) {
        let last = &mut self.last_entries[own.node as usize];
        // It may be of an earlier row, or of an earlier step.
        match self.entries.get_mut(*last as usize).filter(|entry| *last as usize >= begin && entry.node == own.node) {
            Some(entry) => (entry.along, entry.across) = (entry.along + own.along, entry.across + own.across),
            None => {
                *last = self.entries.len() as u32;
                self.entries.room_for(1).push(own);
            }
        }
    }

    /// Adds a node that is known not to be in the row under way.
    pub(super) fn add_distinct(&mut self, node: u32, along: f64, across: f64) {
        self.entries.room_for(1).push(Entry { node, along, across });
    }

    /// The slip of the row under way at these velocities; `given`: that by bodies that the host moves.
    pub(super) fn slip_under_way(&self, row: &Row, velocities: Velocities<'_>, given: V3) -> Slip {
        let [mut along, mut across] = [given; 2];
        for entry in &self.entries[self.begin(self.rows.len())..row.end] {
            let v = at(velocities.nodes, entry.node);
            along += v * entry.along;
            across += v * entry.across;
        }
        for end in row.rigid.iter().flatten() {
            let v = end.velocity(velocities.twists);
            along += v;
            across += v;
        }
        Slip { along: row.direction.dot(&along), across: row.across(&across) }
    }

    /// Finds what [`slip_at`](Self::slip_at) needs to know of the nodes' velocities.
    pub(super) fn find_motions(&mut self, velocities: &[f64]) {
        self.motions.find(&self.rows, &self.entries, velocities);
    }

    /// How the two points of a row move, at the nodes' velocities of the last `find_motions` and these of rigid bodies.
    pub(super) fn slip_at(&self, index: usize, twists: &[f64]) -> Slip {
        self.motions.slip(&self.rows[index], index, twists)
    }

    /// How much faster than before a row's two bodies are to leave each other, along its direction: the sum of what each gains.
    pub(super) fn leaving_gained(&self, index: usize, before: Velocities<'_>, free: Velocities<'_>) -> f64 {
        let row = &self.rows[index];
        let mut sides = [0.0; 2];
        for entry in &self.entries[self.begin(index)..row.end] {
            let gained = at(free.nodes, entry.node) - at(before.nodes, entry.node);
            sides[usize::from(entry.along > 0.0)] -= row.direction.dot(&gained) * entry.along;
        }
        for end in row.rigid.iter().flatten() {
            let gained = end.velocity(free.twists) - end.velocity(before.twists);
            sides[usize::from(end.sign > 0.0)] -= row.direction.dot(&gained);
        }
        sides.iter().map(|side: &f64| side.max(0.0)).sum()
    }

    pub(super) fn begin(&self, index: usize) -> usize {
        if index == 0 { 0 } else { self.rows[index - 1].end }
    }

    /// Calls `use_force(entry, its index, force)` with a row's force on its nodes, times −1.
    #[inline]
    pub(super) fn for_each_node(&self, index: usize, force: &RowForce, mut use_force: impl FnMut(&Entry, usize, V3)) {
        let (row, begin) = (&self.rows[index], self.begin(index));
        let along = row.direction * force.along;
        for (entry, at) in self.entries[begin..row.end].iter().zip(begin..) {
            use_force(entry, at, along * entry.along + force.across * entry.across);
        }
    }

    /// Adds a row's force to the nodes.
    fn scatter(&self, index: usize, force: &RowForce, nodes: &mut [f64]) {
        let nodes = nodes.as_chunks_mut::<3>().0;
        self.for_each_node(index, force, |entry, _, force| {
            let node = &mut nodes[entry.node as usize];
            (0..3).for_each(|axis| node[axis] -= force[axis]);
        });
    }

    /// Calls `use_force(row, force)` with `scale` times the linear forces of the rows, at the motions last found and these
    /// twists.
    pub(crate) fn for_each_force(&self, twists: &[f64], scale: f64, mut use_force: impl FnMut(usize, RowForce)) {
        for index in 0..self.rows.len() {
            let row = &self.rows[index];
            if row.linear.pushes {
                let whole = row.force_at(&self.slip_at(index, twists)) * scale;
                use_force(index, RowForce { along: row.direction.dot(&whole), across: row.across(&whole), whole });
            }
        }
    }

    /// Adds these forces to `nodes`, and to `loads` of rigid bodies if given.
    pub(super) fn add_forces(&self, twists: &[f64], scale: f64, nodes: &mut [f64], mut loads: Option<&mut [f64]>) {
        self.for_each_force(twists, scale, |index, force| {
            self.scatter(index, &force, nodes);
            if let Some(loads) = &mut loads {
                self.rows[index].add_rigid_loads(&force.whole, loads);
            }
        });
    }

    /// Factors M + dt · Jᵀ D J of the rigid bodies. Gives the index of one that would lose its mass to rounding, if there is one.
    pub(super) fn factor_rigid(&mut self, dt: f64) -> Option<usize> {
        self.system.reset(6 * self.masses.len());
        for (index, own) in self.masses.iter().enumerate() {
            for row in 0..3 {
                self.system.add(6 * index + row, 6 * index + row, own.mass);
                (3..6).for_each(|k| self.system.add(6 * index + 3 + row, 6 * index + k, own.about[(row, k - 3)]));
            }
            for (row, column) in (0..36).map(|k| (k / 6, k % 6)) {
                self.system.add(6 * index + row, 6 * index + column, own.added[(row, column)]);
            }
        }
        let system = &mut self.system;
        self.rigid_matrix.for_each_number(|row, column, number| system.add(row, column, number * dt));
        let (row, pivot) = self.system.factor();
        // The fraction of an answer that rounding may make wrong. Each correction leaves this fraction of the error.
        let wrong = margins::margin::<f64>(margins::ELIMINATED_PART) / pivot;
        let [most, goal] = margins::WRONG_ANSWER;
        if wrong > most {
            return Some(row / 6);
        }
        self.corrections = 0;
        let mut left = wrong;
        while left > goal {
            left *= wrong;
            self.corrections += 1;
        }
        None
    }

    /// Where rigid bodies are eliminated: stores the twists with which they answer the nodes' motions in `response`.
    pub(super) fn respond(&mut self, free: &[f64], dt: f64) {
        let [mut loads, mut changes, mut twists] =
            [&mut self.loads, &mut self.changes, &mut self.response].map(std::mem::take);
        memory::refill_with(&mut changes, 0.0, free.len());
        memory::refill(&mut twists, free.iter().copied());
        for _ in 0..=self.corrections {
            memory::refill_with(&mut loads, 0.0, free.len());
            self.add_unanswered(&changes, dt, &mut loads, |index, row| row.force_at(&self.slip_at(index, &twists)));
            self.system.solve(&mut loads);
            changes.iter_mut().zip(&loads).for_each(|(change, load)| *change += load);
            memory::refill(&mut twists, changes.iter().zip(free).map(|(change, free)| change + free));
        }
        (self.loads, self.changes, self.response) = (loads, changes, twists);
    }

    /// Stores the twists with which they answer loads in `response`.
    pub(super) fn answer(&mut self, mut loads: Vec<f64>, dt: f64) {
        let [mut left, mut changes] = [&mut self.changes, &mut self.response].map(std::mem::take);
        memory::refill(&mut changes, loads.iter().copied());
        self.system.solve(&mut changes);
        for _ in 0..self.corrections {
            memory::refill(&mut left, loads.iter().copied());
            self.add_unanswered(&changes, dt, &mut left, |_, row| row.force_by_rigid(&changes));
            self.system.solve(&mut left);
            changes.iter_mut().zip(&left).for_each(|(change, left)| *change += left);
        }
        loads.clear();
        (self.loads, self.changes, self.response) = (loads, left, changes);
    }

    /// Adds the rows' forces on rigid bodies, times dt, less the momenta that a change of their velocities takes. The forces of
    /// a pair may nearly cancel. So they are added up once for both bodies, and are opposite to the last bit.
    fn add_unanswered(&self, changes: &[f64], dt: f64, loads: &mut [f64], force: impl Fn(usize, &Row) -> V3) {
        let bodies = changes.chunks_exact(6).zip(&self.masses);
        for (load, (change, own)) in loads.chunks_exact_mut(6).zip(bodies) {
            let taken = own.momentum(change);
            (0..6).for_each(|k| load[k] -= taken[k]);
        }
        let mut indices = 0..;
        for rows in self.rows.chunk_by(|one, next| one.pair == next.pair) {
            let (mut sum, mut torque, mut last) = (V3::zeros(), V3::zeros(), None);
            for (row, index) in rows.iter().zip(&mut indices).filter(|(row, _)| row.linear.pushes) {
                let ends = row.rigid.iter().flatten();
                let Some(own) = ends.clone().min_by_key(|end| end.index) else { continue };
                let load = force(index, row) * (-own.sign * dt);
                (sum, torque, last) = (sum + load, torque + own.arm.cross(&load), Some((own, ends)));
            }
            let Some((own, ends)) = last else { continue };
            // The two bodies' arms differ by the same vector in all rows, so those of the last row will do.
            let rest = torque - own.arm.cross(&sum);
            for end in ends {
                end.add_load(&(sum * own.sign), loads);
                (0..3).for_each(|axis| loads[6 * end.index + 3 + axis] += own.sign * end.sign * rest[axis]);
            }
        }
    }

    /// Calls `use_slot(slot, block, side, weight)` for all that a row acts on. Slots number that through all rows. A block is
    /// three unknowns: those of a node, or, after all nodes, a rigid body's linear or angular velocity. `side` tells which of
    /// the row's bodies the rigid one is, `weight` how far the block moves the row at most.
    pub(crate) fn for_each_slot(
        &self,
        index: usize,
        nodes: usize,
        mut use_slot: impl FnMut(usize, usize, Option<usize>, f64),
    ) {
        let (row, begin) = (&self.rows[index], self.begin(index));
        for (entry, slot) in self.entries[begin..row.end].iter().zip(begin..) {
            use_slot(slot, entry.node as usize, None, entry.largest());
        }
        for (side, end) in row.rigid.iter().enumerate() {
            let Some(end) = end else { continue };
            let (slot, block) = (self.rigid_slot(index, side), nodes + 2 * end.index);
            use_slot(slot, block, Some(side), 1.0);
            use_slot(slot + 1, block + 1, Some(side), end.arm.norm());
        }
    }

    /// The slot of a rigid body's linear velocity; that of the angular one follows.
    fn rigid_slot(&self, index: usize, side: usize) -> usize {
        self.entries.len() + 4 * index + 2 * side
    }

    /// Calls `use_load(slot, load)` with what a row's force does to all that it acts on.
    pub(crate) fn for_each_load(&self, index: usize, force: &RowForce, mut use_load: impl FnMut(usize, V3)) {
        self.for_each_node(index, force, |_, slot, force| use_load(slot, -force));
        for (side, end) in self.rows[index].rigid.iter().enumerate() {
            let Some(end) = end else { continue };
            let mut twist = [0.0; 6];
            RigidEnd { index: 0, ..*end }.add_load(&-force.whole, &mut twist);
            let slot = self.rigid_slot(index, side);
            use_load(slot, linear(&twist));
            use_load(slot + 1, angular(&twist));
        }
    }

    /// Calls `use_coupling(slot, block, coupling)` for all that the rows that push act on, in N/m and, with angular
    /// velocities, in N.
    pub(crate) fn for_each_coupling(&self, nodes: usize, mut use_coupling: impl FnMut(usize, usize, f64)) {
        for (index, row) in self.rows.iter().enumerate().filter(|(_, row)| row.linear.pushes) {
            self.for_each_slot(index, nodes, |slot, block, _, weight| {
                use_coupling(slot, block, row.coefficient * weight);
            });
        }
    }

    /// The potentials of the rows' linear forces, at the motions and twists last found, each with the index of its pair.
    pub(crate) fn energies(&self, dt: f64) -> impl Iterator<Item = (usize, f64)> {
        self.rows.iter().enumerate().filter(|(_, row)| row.linear.pushes).flat_map(move |(index, row)| {
            let force = row.force_at(&self.slip_at(index, &self.response));
            row.energies(&force, dt).map(|energy| (row.pair, energy))
        })
    }

    /// Calls `use_block(index of the row's pair, row, column, block)` with 3 × 3 blocks whose sum is `scale` · Jᵀ D J. Rigid
    /// bodies have two blocks of unknowns each, after those of the nodes.
    pub(crate) fn for_each_block(
        &self,
        nodes: usize,
        scale: f64,
        mut use_block: impl FnMut(usize, usize, usize, [f64; 9]),
    ) {
        for index in 0..self.rows.len() {
            let row = &self.rows[index];
            if !row.linear.pushes {
                continue;
            }
            let (pair, outer) = (row.pair, row.direction * row.direction.transpose());
            let along = outer * (scale * row.linear.normal);
            let across = (Matrix3::identity() - outer) * (scale * row.linear.tangential);
            let entries = &self.entries[self.begin(index)..row.end];
            let mut emit = |row: usize, column: usize, block: Matrix3<f64>| {
                use_block(pair, row, column, std::array::from_fn(|k| block[(k / 3, k % 3)]));
            };
            for a in entries {
                for b in entries {
                    let block = along * (a.along * b.along) + across * (a.across * b.across);
                    emit(a.node as usize, b.node as usize, block);
                }
            }
            for end in row.rigid.iter().flatten() {
                for (k, jacobian) in jacobian(end).iter().enumerate() {
                    let own = nodes + 2 * end.index + k;
                    for a in entries {
                        let block = (along * a.along + across * a.across) * jacobian;
                        emit(a.node as usize, own, block);
                        emit(own, a.node as usize, block.transpose());
                    }
                    for other in row.rigid.iter().flatten() {
                        for (l, right) in self::jacobian(other).iter().enumerate() {
                            let block = jacobian.transpose() * (along + across) * right;
                            emit(own, nodes + 2 * other.index + l, block);
                        }
                    }
                }
            }
        }
    }
}

/// The derivatives of a row's slip by a rigid body's linear and angular velocity.
fn jacobian(end: &RigidEnd) -> [Matrix3<f64>; 2] {
    [Matrix3::identity() * end.sign, end.arm.cross_matrix() * -end.sign]
}
