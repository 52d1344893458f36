//! What a solver asks of a step under way, and how rows are linearised.

use super::anchors::{AnchorPoint, Hold, seen_from};
use super::body::{Body, Mover};
use super::buffers::{Buffers, Course, Step};
use super::error::{check_count, check_range};
use super::loads::Surface;
use super::row::{LinearForce, Row};
use super::row_builder::body_of;
use super::rows::Velocities;
use super::twist::V3;
use super::{CompressedRows, ContactSystem, RigidUnknowns, SystemError};
use crate::math::{Scalar, margins};

impl<T: Scalar> ContactSystem<T> {
    /// Adds to `forces` the forces on the unknowns, in N (and N m), for these velocities at the end of the step, as last
    /// linearised.
    pub fn add_forces(&mut self, velocities: &[f64], forces: &mut [f64]) -> Result<(), SystemError> {
        let step = self.check_velocities(velocities)?;
        check_count("forces", forces.len(), step.unknowns)?;
        self.find_motions(velocities, step);
        let (nodes, twists) = forces.split_at_mut(3 * self.node_masses.len());
        let loads = (self.rigid_unknowns == RigidUnknowns::Kept).then_some(twists);
        self.rows.add_forces(&self.rows.response, 1.0, nodes, loads);
        Ok(())
    }

    /// Adds `factor` · (−∂force/∂velocity) · `change` to `result`, as last linearised: a product with a symmetric, positive
    /// semi-definite matrix. An implicit solve for velocities takes dt as `factor`; for displacements it is 1 / dt times as
    /// much. How the sums are rounded depends on how many products earlier solves asked for: the quicker way is taken.
    pub fn add_product(&mut self, factor: f64, change: &[f64], result: &mut [f64]) -> Result<(), SystemError> {
        let step = self.check_unknowns("change", change, margins::LARGEST_FACTOR)?;
        check_range("factor", &[factor])?;
        check_count("result", result.len(), step.unknowns)?;
        let (nodes, twists) = change.split_at(3 * self.node_masses.len());
        let (to, to_twists) = result.split_at_mut(3 * self.node_masses.len());
        match self.rigid_unknowns {
            RigidUnknowns::Eliminated => self.rows.add_answered_product(nodes, factor, step.dt, to),
            RigidUnknowns::Kept => self.rows.add_product(Velocities { nodes, twists }, factor, to, to_twists),
        }
        Ok(())
    }

    /// Calls `use_block(row, column, block)` for 3 × 3 blocks, by rows, whose sum is the matrix of
    /// [`add_product`](Self::add_product). Several may have the same row and column. Block n is that of node n; then come two for
    /// each rigid body, of its linear and its angular velocity. A pair that escapes has a block for each two of its nodes.
    ///
    /// # Errors
    /// [`SystemError::NoStep`], [`SystemError::Eliminated`] where there are rigid bodies and they are not kept.
    pub fn for_each_block(
        &self,
        factor: f64,
        mut use_block: impl FnMut(usize, usize, [f64; 9]),
    ) -> Result<(), SystemError> {
        self.check_has_blocks()?;
        check_range("factor", &[factor])?;
        self.rows.for_each_block(self.node_masses.len(), factor, |_, row, column, block| use_block(row, column, block));
        Ok(())
    }

    /// The same matrix in compressed sparse rows, a row for each unknown. In a steady step this allocates nothing.
    ///
    /// # Errors
    /// Those of [`for_each_block`](Self::for_each_block), and [`SystemError::MatrixSize`] where the matrix has more than
    /// 2³¹ − 1 numbers or rows.
    pub fn compressed_rows(&mut self, factor: f64) -> Result<CompressedRows<'_>, SystemError> {
        self.check_has_blocks()?;
        check_range("factor", &[factor])?;
        let blocks = self.unknown_count() / 3;
        if !self.compressed.assemble(&self.rows, self.node_masses.len(), blocks, factor, i32::MAX) {
            return Err(SystemError::MatrixSize);
        }
        Ok(self.compressed.matrix())
    }

    /// The potential of the rows, as last linearised, in J: the forces are its negative gradient by the positions at the end of
    /// the step, velocity times dt. It is what springs store, ½ Σ coefficient · depth², if nothing damps or rubs; else with
    /// what dampers and friction take in the step, and with what eliminated rigid bodies take up.
    pub fn energy(&mut self, velocities: &[f64]) -> Result<f64, SystemError> {
        let step = self.check_velocities(velocities)?;
        self.find_motions(velocities, step);
        let mut energy = 0.0;
        self.rows.energies(step.dt).for_each(|(_, part)| energy += part);
        if self.rigid_unknowns == RigidUnknowns::Eliminated {
            let changes = self.rows.response.chunks_exact(6).zip(self.buffers.free_twists.chunks_exact(6));
            for ((now, free), own) in changes.zip(&self.rows.masses) {
                let change: [f64; 6] = std::array::from_fn(|k| now[k] - free[k]);
                energy += own.energy(&change);
            }
        }
        Ok(energy)
    }

    /// Whether a step is under way, and all rows act on unknowns of the host.
    pub(crate) fn check_has_blocks(&self) -> Result<(), SystemError> {
        self.step.ok_or(SystemError::NoStep)?;
        let is_answered = self.rigid_unknowns == RigidUnknowns::Eliminated && !self.rows.masses.is_empty();
        if is_answered { Err(SystemError::Eliminated) } else { Ok(()) }
    }

    /// New friction springs take over the pull of those that are gone.
    pub(super) fn hand_over(&mut self) {
        let (pairs, anchors) = (&mut self.loads.now, &self.anchors);
        let rubbing = |row: &Row| row.anchor.map(|anchor| (row.pair, anchors.is_new(anchor)));
        for row in &self.rows.rows {
            if let Some((pair, is_new)) = rubbing(row) {
                pairs[pair].count_spring(row.coefficient, is_new);
            }
        }
        for row in &mut self.rows.rows {
            if let Some((pair, true)) = rubbing(row) {
                row.stretch += row.across(&pairs[pair].inherited()) * row.order;
            }
        }
    }

    /// Linearises the rows about the motion without contact: none pulls, and friction is limited by the load of the step before.
    pub(super) fn linearise_predicted(&mut self, Step { dt, .. }: Step) -> Result<(), SystemError> {
        let pairs = &mut self.loads.now;
        let free = Velocities { nodes: &self.buffers.ahead, twists: &self.buffers.free_twists };
        if self.looks_at_start {
            self.rows.find_motions(free.nodes);
        }
        for index in 0..self.rows.rows.len() {
            let looked_ahead = (!self.looks_at_start).then_some(self.rows.rows[index].ahead);
            let predicted = looked_ahead.unwrap_or_else(|| self.rows.slip_at(index, free.twists));
            let row = &mut self.rows.rows[index];
            let pair = &mut pairs[row.pair];
            row.linear = row.linear_at(predicted, dt);
            if !row.linear.pushes && pair.is_loaded() {
                let gained = self.rows.leaving_gained(index, self.buffers.before(), free);
                self.rows.rows[index].keep_loaded(gained, dt);
            }
            let row = &self.rows.rows[index];
            if row.linear.pushes {
                pair.add_predicted(row.linear.push, row.linear.normal);
            }
        }
        for row in self.rows.rows.iter().filter(|row| row.linear.pushes) {
            pairs[row.pair].add_relieved(row.linear.push, row.linear.normal);
        }
        for row in self.rows.rows.iter_mut().filter(|row| row.linear.pushes && row.anchor.is_some()) {
            let pair = &pairs[row.pair];
            let load = pair.load(row.linear.push, row.linear.normal, dt);
            let expected = row.expected_spring(load, pair.speed_lost(dt), dt);
            let mut linear = row.linear;
            row.add_friction(&mut linear, load, expected, dt);
            row.linear = linear;
        }
        self.factor(dt)
    }

    /// Linearises the rows about the motions and twists last found; gives the fraction of the force that was predicted wrongly.
    pub(super) fn linearise_at(&mut self, step: Step) -> Result<f64, SystemError> {
        let mut sums = [0.0; 2];
        for index in 0..self.rows.rows.len() {
            self.rows.rows[index].linear = self.linearised(index, step, &mut sums);
        }
        self.factor(step.dt)?;
        Ok(fraction_wrong(sums))
    }

    /// The fraction of the force, from 0 to 1, that would prove to be predicted wrongly at these velocities: what
    /// [`linearise`](Self::linearise) gives, but the rows stay as they are.
    pub fn misjudged(&mut self, velocities: &[f64]) -> Result<f64, SystemError> {
        let step = self.check_velocities(velocities)?;
        self.find_motions(velocities, step);
        let mut sums = [0.0; 2];
        for index in 0..self.rows.rows.len() {
            self.linearised(index, step, &mut sums);
        }
        Ok(fraction_wrong(sums))
    }

    /// A row's linear force about the motions last found; adds to the sums of what was predicted rightly and wrongly.
    fn linearised(&self, index: usize, step: Step, [right, wrong]: &mut [f64; 2]) -> LinearForce {
        let slip = self.rows.slip_at(index, &self.rows.response);
        let row = &self.rows.rows[index];
        let mut linear = row.linear_at(slip, step.dt);
        if !linear.pushes && !row.linear.pushes {
            return linear;
        }
        let was = if row.linear.pushes { row.force_at(&slip) } else { V3::zeros() };
        if linear.pushes && row.anchor.is_some() {
            let expected = row.spring_at(&slip.across, step.dt).norm();
            let load = linear.push;
            row.add_friction(&mut linear, load, expected, step.dt);
        }
        let is = if linear.pushes { linear.force_at(&row.direction, &slip) } else { V3::zeros() };
        *right += is.norm();
        *wrong += (is - was).norm();
        linear
    }

    /// Prepares products and the answer of eliminated rigid bodies. If one cannot be eliminated, cancels the step.
    fn factor(&mut self, dt: f64) -> Result<(), SystemError> {
        self.rows.forget_products();
        if self.rigid_unknowns == RigidUnknowns::Kept {
            return Ok(());
        }
        let Some(lost) = self.rows.factor_rigid(dt) else { return Ok(()) };
        let is_lost = |body: &&Body<T>| matches!(body.mover, Mover::Rigid { index, .. } if index == lost);
        let body = self.bodies.iter().find(is_lost).map_or(0, |body| body.number);
        self.cancel();
        Err(SystemError::TooStiff { body, dt })
    }

    /// Remembers loads for the next step, and where contacts hold on to one another at the end of this one.
    pub(super) fn remember(&mut self, velocities: &[f64], step: Step) {
        let nodes = &velocities[..3 * self.node_masses.len()];
        let Self { bodies, anchors, loads, buffers, rows, .. } = &mut *self;
        Buffers::predict(&mut buffers.predicted, &buffers.positions, nodes, step.dt);
        anchors.prepare_finish();
        let course = Course { time: step.dt, velocities: nodes, twists: &rows.response, positions: &buffers.predicted };
        for (index, row) in rows.rows.iter().enumerate().filter(|(_, row)| row.linear.pushes) {
            let slip = rows.slip_at(index, &rows.response);
            let force = row.force_at(&slip);
            let load = row.direction.dot(&force).max(0.0);
            loads.now[row.pair].add_solved(load, &(force * row.order));
            let Some(anchor) = row.anchor.filter(|_| load > 0.0) else { continue };
            let stretch = row.stretch_at(&slip.across, step.dt);
            let most = row.friction * load / row.coefficient;
            let is_dragged = stretch.norm() > most;
            let offset = if is_dragged { stretch * (most / stretch.norm()) } else { stretch };
            loads.now[row.pair].add_spring(row.coefficient, &(offset * row.order));
            let pending = anchors.pending[anchor];
            if !is_dragged && pending.from != AnchorPoint::NOWHERE && anchors.keep(anchor) {
                continue;
            }
            let point = pending.from.point(body_of(bodies, pending.key.0).vertices(&course)) + offset;
            let hold = match (pending.on, pending.key.1) {
                (Some(vertices), Surface::Body(second)) => {
                    Hold::Material(seen_from(&vertices, &point, body_of(bodies, second).vertices(&course)))
                }
                _ => Hold::Space(point),
            };
            anchors.set(anchor, hold);
        }
        anchors.finish_step();
        loads.finish_step();
    }
}

fn fraction_wrong([right, wrong]: [f64; 2]) -> f64 {
    if wrong > 0.0 { wrong / (right + wrong) } else { 0.0 }
}
