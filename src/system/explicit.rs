use super::solve::check_count;
use super::{ContactSystem, RigidUnknowns, SystemError};
use crate::math::Scalar;
use crate::memory::Room;
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
        self.check_no_step()?;
        check_count("forces", forces, self.unknown_count())?;
        if self.rigid_unknowns == RigidUnknowns::Eliminated && self.rigid_count > 0 {
            return Err(SystemError::Eliminated);
        }
        // No look-ahead: where bodies are, at the velocities they have.
        self.start(scene, [dt, 0.0, 0.0], positions, velocities, velocities)?;
        let Some(step) = self.step else { return Err(SystemError::NoStep) };
        let mut unknowns = std::mem::take(&mut self.buffers.unknowns);
        unknowns.clear();
        unknowns.room_for(step.unknowns).extend_from_slice(velocities);
        unknowns.extend_from_slice(&self.buffers.twists);
        self.find_twists(&unknowns, step);
        self.hold_at(&unknowns, step);
        let added = self.add_forces(&unknowns, forces);
        self.remember(&unknowns, step);
        self.buffers.unknowns = unknowns;
        self.step = None;
        added?;
        Ok(self.longest_step())
    }

    /// By a bound on the largest eigenvalue λ of M⁻¹ K: the largest sum of a row's couplings with all rows (Gershgorin). A
    /// mode of stiffness λ and damping λ τ is stable up to dt² + 2 τ dt = 4 / λ.
    fn longest_step(&mut self) -> f64 {
        let masses = &self.node_masses;
        let sums = &mut self.buffers.areas;
        let count = masses.len();
        sums.clear();
        sums.room_for(count + 2 * self.rigid_count).resize(count + 2 * self.rigid_count, 0.0);
        let pushing = |place: &usize| self.rows.rows[*place].held.pushes;
        let entries = |place: usize| &self.rows.entries[self.rows.begin(place)..self.rows.rows[place].end];
        let mut damping_time: f64 = 0.0;
        for place in (0..self.rows.rows.len()).filter(pushing) {
            let row = &self.rows.rows[place];
            damping_time = damping_time.max(row.damping_time);
            for entry in entries(place) {
                sums[entry.node as usize] += row.coefficient * entry.along.abs().max(entry.across.abs());
            }
            for end in row.rigid.iter().flatten() {
                sums[count + 2 * end.place] += row.coefficient;
                sums[count + 2 * end.place + 1] += row.coefficient * end.arm.norm();
            }
        }
        let coupling = |place: usize| {
            let nodes = entries(place).iter().map(|entry| {
                entry.along.abs().max(entry.across.abs()) * sums[entry.node as usize] / masses[entry.node as usize]
            });
            let rigid = self.rows.rows[place].rigid.iter().flatten().map(|end| {
                let (mass, inertia) = self.rows.masses[end.place];
                let least = inertia.symmetric_eigenvalues().min();
                let [linear, angular] = [0, 1].map(|k| sums[count + 2 * end.place + k]);
                linear / mass + end.arm.norm() * angular / least
            });
            nodes.sum::<f64>() + rigid.sum::<f64>()
        };
        let largest = (0..self.rows.rows.len()).filter(pushing).map(coupling).fold(0.0, f64::max);
        if largest > 0.0 { (damping_time * damping_time + 4.0 / largest).sqrt() - damping_time } else { f64::INFINITY }
    }
}
