//! What a solver asks of a step under way, and how rows are held.

use super::anchors::{Corners, Hold, seen_from};
use super::body::{Body, Course, Mover};
use super::buffers::{Buffers, Step};
use super::error::{check_count, check_range};
use super::loads::Surface;
use super::row::{Held, Row};
use super::rows::Velocities;
use super::twist::V3;
use super::{CompressedRows, ContactSystem, RigidUnknowns, SystemError};
use crate::math::{Scalar, margins};

impl<T: Scalar> ContactSystem<T> {
    /// Adds to `forces` the forces on the unknowns, in N (and N m), where these are the velocities at the end of the step, as
    /// the rows are held.
    ///
    /// # Errors
    /// [`SystemError::NoStep`], [`SystemError::WrongCount`], [`SystemError::NotFinite`].
    pub fn add_forces(&mut self, velocities: &[f64], forces: &mut [f64]) -> Result<(), SystemError> {
        let step = self.check_velocities("velocities", velocities)?;
        check_count("forces", forces.len(), step.unknowns)?;
        self.find_motions(velocities, step);
        let (nodes, twists) = forces.split_at_mut(3 * self.node_masses.len());
        self.rows.add_forces(&self.rows.response, 1.0, nodes, self.kept(twists));
        Ok(())
    }

    /// Adds `factor` · (−∂force/∂velocity) · `change` to `result`, as the rows are held: a product with a symmetric, positive
    /// semi-definite matrix. An implicit solve for velocities takes dt as `factor`; for displacements it is 1 / dt times as
    /// much. How the sums are rounded depends on how many products earlier solves asked for: the quicker way is taken.
    ///
    /// # Errors
    /// [`SystemError::NoStep`], [`SystemError::WrongCount`], [`SystemError::NotFinite`].
    pub fn add_product(&mut self, factor: f64, change: &[f64], result: &mut [f64]) -> Result<(), SystemError> {
        let step = self.check_unknowns("change", change, margins::LARGEST_FACTOR)?;
        check_range("factor", &[factor])?;
        check_count("result", result.len(), step.unknowns)?;
        let (nodes, twists) = change.split_at(3 * self.node_masses.len());
        let (to, to_twists) = result.split_at_mut(3 * self.node_masses.len());
        match self.rigid_unknowns {
            RigidUnknowns::Eliminated => self.rows.add_answered_product(nodes, factor, step.dt, to),
            RigidUnknowns::Kept => self.rows.add_product(Velocities { nodes, twists }, factor, to, Some(to_twists)),
        }
        Ok(())
    }

    /// Calls `use_block(row, column, block)` for 3 × 3 blocks, by rows, whose sum is the matrix of
    /// [`add_product`](Self::add_product); those of equal place are to be added. Block n is that of node n; after them come two
    /// for each rigid body, of its linear and its angular velocity. A pair that escapes has a block for each two of its nodes.
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

    /// The potential of the rows, as they are held, in J: the forces are its negative gradient by the positions at the end of
    /// the step, velocity times dt. What springs store, ½ Σ coefficient · depth², if nothing damps or rubs; with what dampers
    /// and friction take in the step, and what eliminated rigid bodies take up.
    ///
    /// # Errors
    /// [`SystemError::NoStep`], [`SystemError::WrongCount`], [`SystemError::NotFinite`].
    pub fn energy(&mut self, velocities: &[f64]) -> Result<f64, SystemError> {
        let step = self.check_velocities("velocities", velocities)?;
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

    /// All rows act on unknowns of the host.
    pub(crate) fn check_has_blocks(&self) -> Result<(), SystemError> {
        self.step.ok_or(SystemError::NoStep)?;
        let is_answered = self.rigid_unknowns == RigidUnknowns::Eliminated && !self.rows.masses.is_empty();
        if is_answered { Err(SystemError::Eliminated) } else { Ok(()) }
    }

    fn kept<'a>(&self, twists: &'a mut [f64]) -> Option<&'a mut [f64]> {
        (self.rigid_unknowns == RigidUnknowns::Kept).then_some(twists)
    }

    /// New friction springs take over what those that are gone have pulled with.
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

    /// Holds the rows by what bodies would do without contact: none pulls, and friction goes by what its pair bore.
    pub(super) fn hold_predicted(&mut self) -> Result<(), SystemError> {
        let Step { dt, .. } = self.step.ok_or(SystemError::NoStep)?;
        let pairs = &mut self.loads.now;
        let free = Velocities { nodes: &self.buffers.ahead, twists: &self.buffers.free_twists };
        if !self.looks_ahead {
            self.rows.find_motions(free.nodes);
        }
        for place in 0..self.rows.rows.len() {
            let looked_ahead = self.looks_ahead.then_some(self.rows.rows[place].ahead);
            let predicted = looked_ahead.unwrap_or_else(|| self.rows.slip_at(place, free.twists));
            let row = &mut self.rows.rows[place];
            let pair = &mut pairs[row.pair];
            row.held = row.held_at(predicted, dt);
            if !row.held.pushes && pair.is_loaded() {
                let gained = self.rows.leaving_gained(place, self.buffers.before(), free);
                self.rows.rows[place].hold_loaded(gained, dt);
            }
            let row = &self.rows.rows[place];
            if row.held.pushes {
                pair.add_predicted(row.held.push, row.held.normal);
            }
        }
        for row in self.rows.rows.iter().filter(|row| row.held.pushes) {
            pairs[row.pair].add_relieved(row.held.push, row.held.normal);
        }
        for row in self.rows.rows.iter_mut().filter(|row| row.held.pushes && row.anchor.is_some()) {
            let pair = &pairs[row.pair];
            let load = pair.load(row.held.push, row.held.normal, dt);
            let expected = row.expected_spring(load, pair.speed_lost(dt), dt);
            let mut held = row.held;
            row.add_friction(&mut held, load, expected, dt);
            row.held = held;
        }
        self.factor(dt)
    }

    /// Holds the rows at the motions and twists last found; gives the part of the force that was predicted wrongly.
    pub(super) fn hold_at(&mut self, step: Step) -> Result<f64, SystemError> {
        let mut sums = [0.0; 2];
        for place in 0..self.rows.rows.len() {
            self.rows.rows[place].held = self.held_anew(place, step, &mut sums);
        }
        self.factor(step.dt)?;
        Ok(part_of(sums))
    }

    /// The part of the force that was predicted wrongly, at the motions and twists last found.
    pub(super) fn misjudged_at(&self, step: Step) -> f64 {
        let mut sums = [0.0; 2];
        for place in 0..self.rows.rows.len() {
            self.held_anew(place, step, &mut sums);
        }
        part_of(sums)
    }

    /// How a row is held anew; adds to what was predicted rightly and wrongly.
    fn held_anew(&self, place: usize, step: Step, [right, wrong]: &mut [f64; 2]) -> Held {
        let slip = self.rows.slip_at(place, &self.rows.response);
        let row = &self.rows.rows[place];
        let mut held = row.held_at(slip, step.dt);
        if !held.pushes && !row.held.pushes {
            return held;
        }
        let was = if row.held.pushes { row.force_at(&slip) } else { V3::zeros() };
        if held.pushes && row.anchor.is_some() {
            let expected = row.spring_at(&slip.across, step.dt).norm();
            let load = held.push;
            row.add_friction(&mut held, load, expected, step.dt);
        }
        let is = if held.pushes { held.force_at(&row.direction, &slip) } else { V3::zeros() };
        *right += is.norm();
        *wrong += (is - was).norm();
        held
    }

    /// Makes ready for products and for the answer of eliminated rigid bodies. Where one cannot be eliminated, the step is
    /// cancelled.
    fn factor(&mut self, dt: f64) -> Result<(), SystemError> {
        self.rows.forget_products();
        if self.rigid_unknowns == RigidUnknowns::Kept {
            return Ok(());
        }
        let Some(lost) = self.rows.factor_rigid(dt) else { return Ok(()) };
        let is_lost = |body: &&Body<T>| matches!(body.mover, Mover::Rigid { place, .. } if place == lost);
        let body = self.bodies.iter().find(is_lost).map_or(0, |body| body.number);
        self.cancel();
        Err(SystemError::TooStiff { body, dt })
    }

    /// What the next step is told: loads, and where contacts hold on to one another at the end of this one.
    pub(super) fn remember(&mut self, velocities: &[f64], step: Step) {
        let nodes = &velocities[..3 * self.node_masses.len()];
        let Self { bodies, anchors, loads, buffers, rows, .. } = &mut *self;
        Buffers::find_ends(&mut buffers.ends, &buffers.positions, nodes, step.dt);
        let course = Course { time: step.dt, velocities: nodes, twists: &rows.response, ends: &buffers.ends };
        let body = |number: u32| bodies.binary_search_by_key(&number, |body| body.number).map(|k| &bodies[k]);
        for (place, row) in rows.rows.iter().enumerate().filter(|(_, row)| row.held.pushes) {
            let slip = rows.slip_at(place, &rows.response);
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
            if !is_dragged && pending.from != Corners::NOWHERE && anchors.keep(anchor) {
                continue;
            }
            let Ok(first) = body(pending.key.0) else { continue };
            let point = pending.from.point(first.vertices(&course)) + offset;
            let hold = match (pending.on, pending.key.1) {
                (Some(vertices), Surface::Body(second)) => {
                    let Ok(second) = body(second) else { continue };
                    Hold::Material(seen_from(&vertices, &point, second.vertices(&course)))
                }
                _ => Hold::Space(point),
            };
            anchors.set(anchor, hold);
        }
        anchors.finish_step();
        loads.finish_step();
    }
}

fn part_of([right, wrong]: [f64; 2]) -> f64 {
    if wrong > 0.0 { wrong / (right + wrong) } else { 0.0 }
}
