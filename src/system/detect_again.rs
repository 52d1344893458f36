//! A second detection within a step: a body that was stopped may be in the way of another one.

use super::body::Mover;
use super::buffers::Step;
use super::row_builder::pressed_area;
use super::{ContactSystem, SystemError};
use crate::math::Scalar;
use crate::memory::{self, Room};
use crate::scene::Scene;

impl<T: Scalar> ContactSystem<T> {
    /// Looks for contacts where bodies end with these velocities, instead of where they were predicted: a body that was stopped
    /// may be in the way of another one, though the prediction had it moving on. To be called after a solve. Pairs that had no
    /// rows, or rows of less than half the area, get new ones. If there are such pairs, all rows are linearised at these
    /// velocities, the result is true, and another solve is due. If no node or rigid body ends farther from its prediction than
    /// the smallest depth cap, nothing is done.
    ///
    /// # Errors
    /// [`SystemError::Mesh`], and [`SystemError::TooStiff`], which cancels the step. So does memory that ends.
    pub fn detect_again(&mut self, scene: &mut Scene<T>, velocities: &[f64]) -> Result<bool, SystemError> {
        let step = self.check_velocities(velocities)?;
        self.check_bodies(scene)?;
        let cap = self.bodies.iter().map(|body| body.material.depth_cap).fold(f64::INFINITY, f64::min) / step.dt;
        let [nodes, rigids] = self.off_course(scene, velocities)?;
        if nodes.max(rigids) <= cap * cap {
            return Ok(false);
        }
        // Until all rows are there, since a step that lacks some must not go on.
        self.step = None;
        let has_news = self.look_again(scene, velocities, step);
        self.step = Some(step).filter(|_| !matches!(has_news, Err(SystemError::TooStiff { .. })));
        has_news
    }

    fn look_again(&mut self, scene: &mut Scene<T>, velocities: &[f64], step: Step) -> Result<bool, SystemError> {
        let has_news = self.detect_at(scene, velocities, step)?;
        if has_news {
            // The twists are those of the rows that there were.
            self.rows.find_motions(&velocities[..3 * self.node_masses.len()]);
            self.linearise_at(step)?;
        }
        Ok(has_news)
    }

    /// How far the scene's own bodies end from where contacts were last looked for, if these are the velocities at the end
    /// of the step: the largest square of a difference of velocities in m²/s², of nodes and of rigid bodies' centres. Where
    /// it is more than the square of the smallest depth cap over dt, [`detect_again`](Self::detect_again) looks again. Zero
    /// for a system that looks where bodies are at the start.
    pub fn off_course(&mut self, scene: &Scene<T>, velocities: &[f64]) -> Result<[f64; 2], SystemError> {
        let step = self.check_velocities(velocities)?;
        self.find_motions(velocities, step);
        let mut squares = [0.0; 2];
        if self.looks_at_start {
            return Ok(squares);
        }
        let Self { bodies, buffers, rows, .. } = self;
        let mut count = |kind: usize, now: &[f64], ahead: &[f64]| {
            for (now, ahead) in now.chunks_exact(3).zip(ahead.chunks_exact(3)) {
                let square = (0..3).map(|axis| (now[axis] - ahead[axis]).powi(2)).sum();
                squares[kind] = f64::max(squares[kind], square);
            }
        };
        for body in bodies.iter().filter(|body| !scene.is_foreign(body.number)) {
            match &body.mover {
                Mover::Nodes { nodes, .. } => {
                    let own = 3 * nodes.start as usize..3 * nodes.end as usize;
                    count(0, &velocities[own.clone()], &buffers.ahead[own]);
                }
                Mover::Rigid { index, .. } => {
                    let linear = 6 * index..6 * index + 3;
                    count(1, &rows.response[linear.clone()], &buffers.ahead_twists[linear]);
                }
                Mover::Host(_) => {}
            }
        }
        Ok(squares)
    }

    /// Makes these velocities those of the prediction.
    pub(crate) fn go_on_with(&mut self, velocities: &[f64], step: Step) {
        self.find_motions(velocities, step);
        memory::refill(&mut self.buffers.ahead, velocities[..3 * self.node_masses.len()].iter().copied());
        memory::refill(&mut self.buffers.ahead_twists, self.rows.response.iter().copied());
    }

    /// Detects in any case, and linearises no rows.
    pub(crate) fn detect_at(
        &mut self,
        scene: &mut Scene<T>,
        velocities: &[f64],
        step: Step,
    ) -> Result<bool, SystemError> {
        self.go_on_with(velocities, step);
        self.detect(scene, step.dt)?;
        scene.disregard_query();
        Ok(self.add_new_rows(step))
    }

    /// Makes new rows for pairs of which the last detection has more than twice the area of their rows; true if there are any.
    fn add_new_rows(&mut self, step: Step) -> bool {
        self.measure_pairs();
        let mut pairs = std::mem::take(&mut self.buffers.pairs);
        pairs.retain(|&(_, contacts, rows)| contacts > 2.0 * rows);
        let is_news = |a: u32, b: u32| pairs.binary_search_by_key(&[a.min(b), a.max(b)], |(pair, ..)| *pair).is_ok();
        for row in &mut self.rows.rows {
            let (first, second) = self.loads.now[row.pair].key;
            if matches!(second, super::Surface::Body(second) if is_news(first, second)) {
                // Switched off: the new rows replace it.
                row.coefficient = 0.0;
                row.anchor = None;
            }
        }
        let first = self.rows.rows.len();
        self.add_rows(step.dt, is_news, None);
        self.add_impacts(first, step.dt);
        let has_news = !pairs.is_empty();
        self.buffers.pairs = pairs;
        has_news
    }

    /// The area of the contacts and of the rows of each pair of the last detection.
    fn measure_pairs(&mut self) {
        let Self { weighting, contacts, rows, loads, buffers, .. } = self;
        let pairs = &mut buffers.pairs;
        pairs.clear();
        // Contacts of escaping pairs have no area: such pairs keep their one row.
        let areas = contacts.contacts.iter().map(|contact| (contact, pressed_area(contact, *weighting).to_f64()));
        for (contact, area) in areas.filter(|(_, area)| *area > 0.0) {
            let pair = contact.bodies();
            match pairs.binary_search_by_key(&pair, |(pair, ..)| *pair) {
                Ok(index) => pairs[index].1 += area,
                Err(index) => pairs.room_for(1).insert(index, (pair, area, 0.0)),
            }
        }
        for row in rows.rows.iter().filter(|row| row.coefficient > 0.0) {
            let load = &loads.now[row.pair];
            let (first, super::Surface::Body(second)) = load.key else { continue };
            let pair = [first.min(second), first.max(second)];
            if let Ok(index) = pairs.binary_search_by_key(&pair, |(pair, ..)| *pair) {
                pairs[index].2 += row.coefficient / load.material.stiffness;
            }
        }
    }
}
