//! Products of the rows' matrix with a change of the velocities. A solve asks for tens of them per linearisation, so their data
//! is packed first.

use super::body::at;
use super::row::{Entry, Slip, Spring};
use super::rows::{RowForce, Rows, Velocities};
use super::twist::V3;
use crate::memory::{self, Room};

impl Rows {
    /// Gathers the linearised rows for the products until the next linearisation.
    pub(super) fn gather_springs(&mut self) {
        let Self { rows, springs, matrix, coupling, .. } = self;
        matrix.is_current = false;
        coupling.gather(rows);
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

    /// Adds `scale` · Jᵀ D J · change: the forces that rows exert against a change of the velocities, turned around; on rigid
    /// bodies too where `twists` has room for them.
    pub(super) fn add_product(
        &mut self,
        change: Velocities<'_>,
        scale: f64,
        nodes: &mut [f64],
        twists: Option<&mut [f64]>,
    ) {
        self.assemble(change.nodes.len() / 3);
        self.matrix.add_product(change.nodes, scale, nodes);
        self.coupling.add_to_nodes(change.twists, scale, nodes);
        self.add_apart(change, scale, nodes);
        if let Some(twists) = twists {
            self.coupling.add_among(change.twists, scale, twists);
            self.add_to_rigid(change.nodes, scale, twists);
        }
    }

    /// The same where rigid bodies are eliminated and answer the nodes.
    pub(super) fn add_answered_product(&mut self, nodes: &[f64], scale: f64, dt: f64, result: &mut [f64]) {
        self.assemble(nodes.len() / 3);
        let count = 6 * self.masses.len();
        let mut loads = std::mem::take(&mut self.loads);
        memory::refill_with(&mut loads, 0.0, count);
        self.add_to_rigid(nodes, -dt, &mut loads);
        self.finish_response(loads, None);
        let twists = std::mem::take(&mut self.response);
        self.add_product(Velocities { nodes, twists: &twists }, scale, result, None);
        self.response = twists;
    }

    fn assemble(&mut self, nodes: usize) {
        if !self.matrix.is_current {
            let Self { rows, entries, springs, matrix, coupling, .. } = self;
            matrix.assemble((springs, rows, entries), nodes, coupling);
        }
    }

    /// Adds `scale` times the loads of rows on rigid bodies by a change of the nodes' velocities alone.
    fn add_to_rigid(&self, nodes: &[f64], scale: f64, loads: &mut [f64]) {
        self.coupling.add_to_rigid(nodes, scale, loads);
        for spring in self.apart().filter(|spring| spring.has_rigid_ends) {
            let slip = self.slip_of_nodes(spring, nodes);
            let force = spring.direction * (spring.normal * slip.along) + slip.across * spring.tangential;
            Self::scatter_rigid(&self.rows[spring.place].rigid, &(force * -scale), loads);
        }
    }

    fn entries_of(&self, spring: &Spring) -> &[Entry] {
        &self.entries[spring.begin..spring.end]
    }

    /// How a change of the velocities moves the two points of a row; across the direction only where that counts.
    fn slip_of(&self, spring: &Spring, change: Velocities<'_>) -> Slip {
        let rigid = if spring.has_rigid_ends { &self.rows[spring.place].rigid[..] } else { &[] };
        let rigid = rigid.iter().flatten().fold(V3::zeros(), |sum, end| sum + end.velocity(change.twists));
        self.slip_with(spring, change.nodes, rigid)
    }

    /// The same by the change of nodes alone.
    fn slip_of_nodes(&self, spring: &Spring, nodes: &[f64]) -> Slip {
        self.slip_with(spring, nodes, V3::zeros())
    }

    /// The same where rigid bodies move the points by so much.
    fn slip_with(&self, spring: &Spring, nodes: &[f64], rigid: V3) -> Slip {
        let direction = spring.direction;
        if spring.tangential == 0.0 {
            let along = |sum, entry: &Entry| sum + direction.dot(&at(nodes, entry.node)) * entry.along;
            let along = self.entries_of(spring).iter().fold(direction.dot(&rigid), along);
            return Slip { along, across: V3::zeros() };
        }
        let [mut along, mut across] = [rigid; 2];
        for entry in self.entries_of(spring) {
            let v = at(nodes, entry.node);
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

    /// Springs that are not assembled.
    fn apart(&self) -> impl Iterator<Item = &Spring> {
        self.matrix.apart.iter().map(|&place| &self.springs[place as usize])
    }

    /// The product on nodes of springs that are not assembled.
    fn add_apart(&self, change: Velocities<'_>, scale: f64, nodes: &mut [f64]) {
        for spring in self.apart() {
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
        }
    }
}
