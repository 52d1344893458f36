//! Products of the rows' matrix with a change of the velocities. A solve asks for tens of them per linearisation, so their data
//! is packed first.

use super::row::{Entry, Row, Slip, Spring};
use super::row_chunk::RowChunk;
use super::rows::{RowForce, Rows, Velocities};
use super::twist::{V3, at};
use crate::memory::{self, Room};
use crate::threads::Helpers;

impl Rows {
    /// To be called after a linearisation.
    pub(super) fn forget_products(&mut self) {
        self.are_listed = false;
        self.are_packed = false;
        self.products.linearise();
        self.rigid_matrix.gather(&self.rows);
    }

    /// Lists the springs, unless that is done. It waits for the first product: after the last linearisation there may be none.
    pub(crate) fn list_springs(&mut self) {
        let Self { rows, springs, are_listed, .. } = self;
        if *are_listed {
            return;
        }
        springs.clear();
        springs.room_for(rows.len());
        let mut begin = 0;
        for (index, Row { direction, linear, rigid, end, .. }) in rows.iter().enumerate() {
            if linear.pushes {
                springs.push(Spring {
                    direction: *direction,
                    normal: linear.normal,
                    tangential: linear.tangential,
                    row: index,
                    begin,
                    end: *end,
                    has_rigid_ends: rigid.iter().any(Option::is_some),
                });
            }
            begin = *end;
        }
        *are_listed = true;
    }

    /// Adds `scale` · Jᵀ D J · change to `nodes` and `twists`: the opposite of the forces that a change of the velocities adds.
    pub(super) fn add_product(&mut self, change: Velocities<'_>, scale: f64, nodes: &mut [f64], twists: &mut [f64]) {
        self.start_product(change.nodes);
        self.rigid_matrix.add_product(change.twists, scale, twists);
        self.add_to_rigid(scale, twists);
        self.finish_product(change.twists, scale, nodes);
    }

    /// The same where rigid bodies are eliminated and answer the nodes.
    pub(super) fn add_answered_product(&mut self, nodes: &[f64], scale: f64, dt: f64, result: &mut [f64]) {
        self.start_product(nodes);
        let count = 6 * self.masses.len();
        let mut loads = std::mem::take(&mut self.loads);
        memory::refill_with(&mut loads, 0.0, count);
        self.add_to_rigid(-dt, &mut loads);
        self.answer(loads, dt);
        let twists = std::mem::take(&mut self.response);
        self.finish_product(&twists, scale, result);
        self.response = twists;
    }

    /// Starts with the change of the nodes' velocities alone.
    fn start_product(&mut self, nodes: &[f64]) {
        let is_packed = std::mem::replace(&mut self.are_packed, false);
        if !is_packed {
            self.list_springs();
            RowChunk::divide(&mut self.chunks, &self.springs, self.rows.len());
        }
        let helpers = self.chunk_helpers();
        let Self { rows, entries, springs, chunks, products, .. } = self;
        let products = products.expected();
        helpers.for_each(chunks, |_, chunk| {
            if !is_packed {
                chunk.pack(rows, entries, springs, nodes.len() / 3, products);
            }
            chunk.start_product(nodes);
        });
        self.are_packed = true;
    }

    /// Who helps with the chunks: nobody where there is a single one.
    fn chunk_helpers(&self) -> Helpers {
        self.helpers(self.chunks.iter().filter(|chunk| !chunk.is_empty()).count() > 1)
    }

    fn finish_product(&mut self, twists: &[f64], scale: f64, nodes: &mut [f64]) {
        let helpers = self.chunk_helpers();
        let Self { rows, chunks, .. } = self;
        if !twists.is_empty() {
            helpers.for_each(chunks, |_, chunk| chunk.add_twists(rows, twists));
        }
        // In order, so that sums do not depend on threads.
        chunks.iter().for_each(|chunk| chunk.lines.finish_product(scale, nodes));
        // Last, so that a product that ends without memory does not count.
        self.products.add_one();
    }

    /// Adds `scale` times the loads of rows on rigid bodies by the change of the nodes' velocities alone.
    fn add_to_rigid(&self, scale: f64, loads: &mut [f64]) {
        self.chunks.iter().for_each(|chunk| chunk.add_to_rigid(&self.rows, scale, loads));
    }

    fn entries_of(&self, spring: &Spring) -> &[Entry] {
        &self.entries[spring.begin..spring.end]
    }

    /// How a change of the velocities moves the two points of a row; across the direction only if it has friction.
    fn slip_of(&self, spring: &Spring, change: Velocities<'_>) -> Slip {
        let rigid = if spring.has_rigid_ends { &self.rows[spring.row].rigid[..] } else { &[] };
        let rigid = rigid.iter().flatten().fold(V3::zeros(), |sum, end| sum + end.velocity(change.twists));
        let direction = spring.direction;
        if spring.tangential == 0.0 {
            let along = |sum, entry: &Entry| sum + direction.dot(&at(change.nodes, entry.node)) * entry.along;
            let along = self.entries_of(spring).iter().fold(direction.dot(&rigid), along);
            return Slip { along, across: V3::zeros() };
        }
        let [mut along, mut across] = [rigid; 2];
        for entry in self.entries_of(spring) {
            let v = at(change.nodes, entry.node);
            along += v * entry.along;
            across += v * entry.across;
        }
        Slip { along: direction.dot(&along), across: across - direction * direction.dot(&across) }
    }

    /// Calls `use_force(row, force)` with the forces against a change of the velocities, turned around: those of `scale` ·
    /// Jᵀ D J · change.
    pub(crate) fn for_each_product(
        &self,
        change: Velocities<'_>,
        scale: f64,
        mut use_force: impl FnMut(usize, RowForce),
    ) {
        for spring in &self.springs {
            let slip = self.slip_of(spring, change);
            let along = -scale * spring.normal * slip.along;
            let across = slip.across * (-scale * spring.tangential);
            use_force(spring.row, RowForce { along, across, whole: spring.direction * along + across });
        }
    }
}
