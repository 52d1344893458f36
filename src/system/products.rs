//! Products of the rows' matrix with a change of the velocities. A solve asks for tens of them each time that rows are held, so
//! what they need lies side by side.

use super::body::at;
use super::row::{Entry, RigidEnd, Slip, Spring};
use super::rows::{RowForce, Rows, Velocities};
use super::twist::V3;
use crate::memory::{self, Room};

impl Rows {
    /// Takes note of how rows are held now, for the products until they are held anew.
    pub(super) fn gather_springs(&mut self) {
        let Self { rows, springs, matrix, .. } = self;
        matrix.is_current = false;
        springs.clear();
        springs.room_for(rows.len());
        let mut begin = 0;
        for (place, row) in rows.iter().enumerate() {
            let (direction, end) = (row.direction, row.end);
            let has_rigid_ends = row.rigid.iter().any(Option::is_some);
            if row.held.pushes {
                let (normal, tangential) = (row.held.normal, row.held.tangential);
                springs.push(Spring { direction, normal, tangential, place, begin, end, has_rigid_ends });
            }
            begin = end;
        }
    }

    /// Adds `scale` · Jᵀ D J · change of the springs that are assembled. [`add_product`](Self::add_product) adds the others'.
    pub(super) fn add_assembled(&mut self, change: &[f64], scale: f64, result: &mut [f64]) {
        if !self.matrix.is_current {
            self.matrix.assemble(&self.springs, &self.entries, change.len() / 3);
        }
        self.matrix.add_product(change, scale, result);
    }

    fn rigid_ends(&self, spring: &Spring) -> &[Option<RigidEnd>] {
        if spring.has_rigid_ends { &self.rows[spring.place].rigid } else { &[] }
    }

    fn entries_of(&self, spring: &Spring) -> &[Entry] {
        &self.entries[spring.begin..spring.end]
    }

    /// How a change of the velocities moves the two points of a row; across the direction only where that counts.
    fn slip_of(&self, spring: &Spring, change: Velocities<'_>) -> Slip {
        let direction = spring.direction;
        let rigid =
            self.rigid_ends(spring).iter().flatten().fold(V3::zeros(), |sum, end| sum + end.velocity(change.twists));
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
    pub(super) fn for_each_product(
        &self,
        change: Velocities<'_>,
        scale: f64,
        mut use_force: impl FnMut(usize, RowForce),
    ) {
        for spring in &self.springs {
            let slip = self.slip_of(spring, change);
            let along = -scale * spring.normal * slip.along;
            let across = slip.across * (-scale * spring.tangential);
            use_force(spring.place, RowForce { along, across, whole: spring.direction * along + across });
        }
    }

    /// Adds `scale` · Jᵀ D J · change: the forces that rows exert against a change of the velocities, turned around; on rigid
    /// bodies too where `twists` has room for them. Of springs that are not assembled.
    pub(super) fn add_product(
        &self,
        change: Velocities<'_>,
        scale: f64,
        nodes: &mut [f64],
        mut twists: Option<&mut [f64]>,
    ) {
        for &place in &self.matrix.apart {
            let spring = &self.springs[place as usize];
            let slip = self.slip_of(spring, change);
            let along = spring.direction * (scale * spring.normal * slip.along);
            let mut add = |node: u32, force: V3| {
                let node = &mut nodes[3 * node as usize..][..3];
                (0..3).for_each(|axis| node[axis] += force[axis]);
            };
            let entries = self.entries_of(spring);
            if spring.tangential == 0.0 {
                entries.iter().for_each(|entry| add(entry.node, along * entry.along));
            } else {
                let across = slip.across * (scale * spring.tangential);
                entries.iter().for_each(|entry| add(entry.node, along * entry.along + across * entry.across));
            }
            if let Some(twists) = twists.as_deref_mut().filter(|_| spring.has_rigid_ends) {
                let force = -along - slip.across * (scale * spring.tangential);
                Self::scatter_rigid(&self.rows[spring.place].rigid, &force, twists);
            }
        }
    }

    /// Where rigid bodies are eliminated: the twists with which they answer a change of the nodes' velocities, into `response`.
    pub(super) fn respond_to_change(&mut self, nodes: &[f64], dt: f64) {
        let count = 6 * self.masses.len();
        let mut loads = std::mem::take(&mut self.loads);
        memory::refill_with(&mut loads, 0.0, count);
        memory::refill_with(&mut self.response, 0.0, count);
        let change = Velocities { nodes, twists: &self.response };
        for spring in self.springs.iter().filter(|spring| spring.has_rigid_ends) {
            let slip = self.slip_of(spring, change);
            let force = spring.direction * (spring.normal * slip.along) + slip.across * spring.tangential;
            Self::scatter_rigid(&self.rows[spring.place].rigid, &(force * dt), &mut loads);
        }
        self.finish_response(loads, None);
    }
}
