//! What is here for `distributed` alone: foreign bodies may join a step under way. Besides, `distributed` reads what is
//! `pub(crate)` of rows, loads and anchors, and calls the functions that `begin` and `detect_again` are made of.

pub(crate) use super::anchors::{Anchor, AnchorPoint, Hold};
pub(crate) use super::loads::Key;
pub(crate) use super::rows::{RowForce, Rows, Velocities};

use super::{ContactSystem, SystemError};
use crate::math::Scalar;
use crate::scene::Scene;
use std::ops::Range;

impl<T: Scalar> ContactSystem<T> {
    /// The nodes that carry a body; none of one that is not deformable.
    pub(crate) fn nodes_of(&self, body: u32) -> Range<u32> {
        self.index_of(body).ok().and_then(|index| self.bodies[index].nodes()).unwrap_or_default()
    }

    /// How many vertices a body's surface has.
    pub(crate) fn vertex_count(&self, body: u32) -> Result<usize, SystemError> {
        self.index_of(body).map(|index| self.bodies[index].vertex_count())
    }

    /// Within a step only foreign bodies may be added.
    pub(super) fn check_may_join(&self, scene: &Scene<T>, body: u32) -> Result<(), SystemError> {
        if scene.is_foreign(body) { Ok(()) } else { self.check_no_step() }
    }

    /// Within a step one of the bodies must have been added in it.
    pub(crate) fn check_joined(&self, bodies: &[u32]) -> Result<(), SystemError> {
        let has_joined = |&body: &u32| self.index_of(body).is_ok_and(|index| self.bodies[index].has_joined);
        if bodies.iter().any(has_joined) { Ok(()) } else { self.check_no_step() }
    }

    /// Within a step the nodes of all other bodies must keep their masses, and there must be bodies that have joined.
    pub(super) fn check_only_joined_change(&self, masses: &[f64]) -> Result<(), SystemError> {
        let keeps = |nodes: Range<u32>| {
            let own = nodes.start as usize..nodes.end as usize;
            masses.get(own.clone()) == self.node_masses.get(own)
        };
        let mut others = self.bodies.iter().filter(|body| !body.has_joined).filter_map(|body| body.nodes());
        if masses.len() >= self.node_masses.len() && others.all(keeps) { Ok(()) } else { self.check_no_step() }
    }
}
