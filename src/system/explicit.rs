use super::error::check_count;
use super::twist::Inertia;
use super::{ContactSystem, RigidUnknowns, SystemError};
use crate::math::Scalar;
use crate::memory;
use crate::scene::Scene;

impl<T: Scalar> ContactSystem<T> {
    /// A whole step for a host that integrates explicitly: adds to `forces` the contact forces on its unknowns at these
    /// positions and velocities, and gives the longest step, in s, for which they are stable where velocities go first and
    /// positions follow them (symplectic Euler); infinity without contact. Forces of the host's own may need a shorter one.
    /// Rigid bodies have to be [kept](RigidUnknowns::Kept): their velocities are those of [`set_motion`](Self::set_motion).
    /// `dt`: the step that the host takes, by which pairs escape.
    ///
    /// # Errors
    /// Those of [`begin`](Self::begin), and [`SystemError::Eliminated`] where rigid bodies are not kept.
    pub fn explicit_step(
        &mut self,
        scene: &mut Scene<T>,
        dt: f64,
        positions: &[f64],
        velocities: &[f64],
        forces: &mut [f64],
    ) -> Result<f64, SystemError> {
        check_count("forces", forces.len(), self.unknown_count())?;
        self.begin_explicit(scene, dt, positions, velocities)?;
        let step = self.step.ok_or(SystemError::NoStep)?;
        let unknowns = std::mem::take(&mut self.buffers.unknowns);
        let added = self.add_forces(&unknowns, forces);
        self.remember(&unknowns, step);
        self.buffers.unknowns = unknowns;
        self.step = None;
        added?;
        let mut sums = std::mem::take(&mut self.buffers.sums);
        let nodes = self.node_masses.len();
        memory::refill_with(&mut sums, 0.0, nodes + 2 * self.rigid_count);
        self.rows.for_each_coupling(nodes, |_, block, coupling| sums[block] += coupling);
        let largest = self.largest_with(&sums);
        self.buffers.sums = sums;
        Ok(longest_step(largest))
    }

    /// Begins a step as [`explicit_step`](Self::explicit_step) does, and does no more: the rows' forces at the velocities of
    /// the start can be asked for, and [`finish`](Self::finish) with these ends it.
    ///
    /// # Errors
    /// Those of [`explicit_step`](Self::explicit_step).
    pub fn begin_explicit(
        &mut self,
        scene: &mut Scene<T>,
        dt: f64,
        positions: &[f64],
        velocities: &[f64],
    ) -> Result<(), SystemError> {
        self.check_no_step()?;
        if self.rigid_unknowns == RigidUnknowns::Eliminated && self.rigid_count > 0 {
            return Err(SystemError::Eliminated);
        }
        // No look-ahead: where bodies are, at the velocities they have.
        let step = self.start(scene, [dt, 0.0, 0.0], [positions, velocities, velocities])?;
        let mut unknowns = std::mem::take(&mut self.buffers.unknowns);
        memory::refill(&mut unknowns, velocities.iter().chain(&self.buffers.twists).copied());
        self.find_motions(&unknowns, step);
        self.buffers.unknowns = unknowns;
        self.linearise_at(step)?;
        self.step = Some(step);
        Ok(())
    }

    /// A bound on the largest eigenvalue λ of M⁻¹ K, in 1/s², and the largest damping time τ of rows that push, in s; both zero
    /// without contact. `sums`: the sums of couplings, a number for each block of three unknowns. The largest sum of a row's
    /// couplings with all rows bounds λ (Gershgorin).
    pub(crate) fn largest_with(&self, sums: &[f64]) -> [f64; 2] {
        let masses = &self.node_masses;
        let count = masses.len();
        let mut most = [0.0_f64; 2];
        for (index, row) in self.rows.rows.iter().enumerate().filter(|(_, row)| row.linear.pushes) {
            let entries = &self.rows.entries[self.rows.begin(index)..row.end];
            let nodes = entries
                .iter()
                .map(|entry| entry.largest() * sums[entry.node as usize] / masses[entry.node as usize])
                .sum::<f64>();
            let rigid = row.rigid.iter().flatten().map(|end| {
                // What joints add makes no step shorter.
                let Inertia { mass, about, .. } = self.rows.masses[end.index];
                let least = about.symmetric_eigenvalues().min();
                let [linear, angular] = [0, 1].map(|k| sums[count + 2 * end.index + k]);
                linear / mass + end.arm.norm() * angular / least
            });
            most = [most[0].max(nodes + rigid.sum::<f64>()), most[1].max(row.damping_time)];
        }
        most
    }
}

/// A mode of stiffness λ and damping λ τ is stable up to dt² + 2 τ dt = 4 / λ.
fn longest_step([largest, damping_time]: [f64; 2]) -> f64 {
    if largest > 0.0 { (damping_time * damping_time + 4.0 / largest).sqrt() - damping_time } else { f64::INFINITY }
}
