//! A step of a system whose scene has ghosts: bodies of other systems, which may join within the step.

use super::body::Mover;
use super::solve::check_count;
use super::step::{copy, square_between};
use super::{ContactSystem, SystemError};
use crate::math::Scalar;
use crate::memory::Room;
use crate::scene::Scene;

impl<T: Scalar> ContactSystem<T> {
    /// How far the scene's bodies, but ghosts, end from where contacts were last looked for, if these are the velocities at
    /// the end of the step: the largest square of a difference of velocities in m²/s², of nodes and of rigid bodies'
    /// centres. Where it is more than the square of the smallest depth cap over dt, [`detect_again`](Self::detect_again)
    /// looks again. Zero for a system that looks where bodies are at the start.
    ///
    /// A system that shares bodies with others asks all of them first. Then each calls [`look_again`](Self::look_again),
    /// adds the ghosts that its scene needs there (a ghost may be added, told its motion and what its pairs remember within
    /// a step), and calls [`detect_among`](Self::detect_among).
    ///
    /// # Errors
    /// [`SystemError::NoStep`], [`SystemError::WrongCount`], [`SystemError::NotFinite`].
    pub fn off_course(&mut self, scene: &Scene<T>, velocities: &[f64]) -> Result<[f64; 2], SystemError> {
        let step = self.check_velocities("velocities", velocities)?;
        self.find_motions(velocities, step);
        let mut squares = [0.0; 2];
        if !self.looks_ahead {
            return Ok(squares);
        }
        let Self { bodies, buffers, rows, .. } = self;
        let mut count = |kind: usize, now: &[f64], ahead: &[f64]| {
            for (now, ahead) in now.chunks_exact(3).zip(ahead.chunks_exact(3)) {
                squares[kind] = f64::max(squares[kind], square_between(now, ahead));
            }
        };
        for body in bodies.iter().filter(|body| !scene.is_ghost(body.number)) {
            match &body.mover {
                Mover::Nodes { nodes, .. } => {
                    let own = 3 * nodes.start as usize..3 * nodes.end as usize;
                    count(0, &velocities[own.clone()], &buffers.ahead[own]);
                }
                Mover::Rigid { place, .. } => {
                    let linear = 6 * place..6 * place + 3;
                    count(1, &rows.response[linear.clone()], &buffers.ahead_twists[linear]);
                }
                Mover::Host(_) => {}
            }
        }
        Ok(squares)
    }

    /// Puts the scene's bodies, but ghosts, where they end with these velocities, and does no more: by where they will be it
    /// is known which ghosts [`detect_among`](Self::detect_among) needs.
    ///
    /// # Errors
    /// Those of [`detect_again`](Self::detect_again).
    pub fn look_again(&mut self, scene: &mut Scene<T>, velocities: &[f64]) -> Result<(), SystemError> {
        let step = self.check_velocities("velocities", velocities)?;
        self.check_bodies(scene)?;
        self.go_on_with(velocities);
        self.place_surfaces(scene, step.dt, |scene, body| !scene.is_ghost(body))
    }

    /// As [`detect_again`](Self::detect_again), but it looks in any case, and rows are held as before: where any system has
    /// found more, all are to [linearise](Self::linearise) at these velocities. `positions` and `start_velocities`: those
    /// given to [`begin`](Self::begin), with those of ghosts that have joined.
    ///
    /// # Errors
    /// Those of [`detect_again`](Self::detect_again).
    pub fn detect_among(
        &mut self,
        scene: &mut Scene<T>,
        positions: &[f64],
        start_velocities: &[f64],
        velocities: &[f64],
    ) -> Result<bool, SystemError> {
        let step = self.check_velocities("velocities", velocities)?;
        for (what, numbers) in [("positions", positions), ("start_velocities", start_velocities)] {
            check_count(what, numbers, 3 * self.node_masses.len())?;
            super::check_range(what, numbers)?;
        }
        self.check_bodies(scene)?;
        copy(&mut self.buffers.positions, positions);
        copy(&mut self.buffers.velocities, start_velocities);
        self.go_on_with(velocities);
        self.detect(scene, step.dt)?;
        scene.disregard_query();
        Ok(self.add_new_rows(step))
    }

    /// Makes these velocities those of the prediction.
    pub(super) fn go_on_with(&mut self, velocities: &[f64]) {
        let Some(step) = self.step else { return };
        self.find_motions(velocities, step);
        copy(&mut self.buffers.ahead, &velocities[..3 * self.node_masses.len()]);
        copy(&mut self.buffers.ahead_twists, &self.rows.response);
    }

    /// Within a step only ghosts may be added.
    pub(super) fn check_may_join(&self, scene: &Scene<T>, body: u32) -> Result<(), SystemError> {
        if scene.is_ghost(body) { Ok(()) } else { self.check_no_step() }
    }

    /// Within a step one of the bodies must have been added in it.
    pub(super) fn check_joined(&self, bodies: &[u32]) -> Result<(), SystemError> {
        let has_joined = |&body: &u32| self.place(body).is_ok_and(|place| self.bodies[place].has_joined);
        if bodies.iter().any(has_joined) { Ok(()) } else { self.check_no_step() }
    }

    /// Within a step the nodes of all other bodies must keep their masses, and there must be bodies that have joined.
    pub(super) fn check_only_joined_change(&self, masses: &[f64]) -> Result<(), SystemError> {
        let keeps = |nodes: std::ops::Range<u32>| {
            let own = nodes.start as usize..nodes.end as usize;
            masses.get(own.clone()) == self.node_masses.get(own)
        };
        let mut others = self.bodies.iter().filter(|body| !body.has_joined).filter_map(|body| body.nodes());
        if masses.len() >= self.node_masses.len() && others.all(keeps) { Ok(()) } else { self.check_no_step() }
    }

    /// Makes room in the step under way for bodies that have joined: at rest at the origin until their motion is set.
    pub(super) fn make_room_in_step(&mut self) {
        let unknowns = self.unknown_count();
        let Some(step) = &mut self.step else { return };
        self.parts.forget();
        let Self { buffers, bodies, rows, rigid_count, node_masses, .. } = self;
        let grow = |numbers: &mut Vec<f64>, count: usize| {
            numbers.room_for(count.saturating_sub(numbers.len())).resize(count, 0.0);
        };
        for numbers in [&mut buffers.positions, &mut buffers.velocities, &mut buffers.ahead] {
            grow(numbers, 3 * node_masses.len());
        }
        for twists in [&mut buffers.twists, &mut buffers.free_twists, &mut buffers.ahead_twists] {
            grow(twists, 6 * *rigid_count);
        }
        rows.masses.room_for(rigid_count.saturating_sub(rows.masses.len())).resize(*rigid_count, Default::default());
        for body in bodies.iter().filter(|body| body.has_joined) {
            body.start_rigid(buffers, &mut rows.masses);
        }
        step.unknowns = unknowns;
    }
}
