//! What a step under way keeps of the host's numbers, and its scratch memory.

use super::rows::Velocities;
use crate::memory;

/// A step under way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    /// Its length for the rows: 0 where the host integrates explicitly.
    pub(crate) dt: f64,
    /// How many unknowns the host solves for.
    pub(super) unknowns: usize,
}

/// The host's numbers for this step, and scratch memory: three numbers per node, six per rigid body.
#[derive(Debug, Default)]
pub(crate) struct Buffers {
    pub(crate) positions: Vec<f64>,
    pub(crate) velocities: Vec<f64>,
    /// The predicted positions of the nodes.
    pub(super) predicted: Vec<f64>,
    /// The velocities by which the last detection predicted where nodes and rigid bodies will be.
    pub(super) ahead: Vec<f64>,
    pub(super) ahead_twists: Vec<f64>,
    /// Those two, set aside while a trial is made.
    pub(super) kept: [Vec<f64>; 2],
    pub(super) twists: Vec<f64>,
    pub(super) free_twists: Vec<f64>,
    /// At the end of the last step.
    pub(super) end_twists: Vec<f64>,
    pub(super) sums: Vec<f64>,
    pub(super) unknowns: Vec<f64>,
    /// Each pair with the area of the contacts of a later detection, and that of its rows.
    pub(super) pairs: Vec<([u32; 2], f64, f64)>,
}

/// The predicted motion: the velocities of nodes and rigid bodies, followed for some time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course<'a> {
    pub(super) time: f64,
    pub(super) velocities: &'a [f64],
    pub(super) twists: &'a [f64],
    /// The predicted positions of the nodes.
    pub(super) positions: &'a [f64],
}

impl Buffers {
    pub(super) fn before(&self) -> Velocities<'_> {
        Velocities { nodes: &self.velocities, twists: &self.twists }
    }

    pub(super) fn course(&self, time: f64) -> Course<'_> {
        Course { time, velocities: &self.ahead, twists: &self.ahead_twists, positions: &self.predicted }
    }

    /// Finds where nodes are after a time with these velocities.
    pub(super) fn predict(predicted: &mut Vec<f64>, positions: &[f64], velocities: &[f64], time: f64) {
        memory::refill(predicted, positions.iter().zip(velocities).map(|(x, v)| x + v * time));
    }
}
