//! Scenes that share their bodies: each has some of its own, and ghosts of those of others that meet them.

use super::bodies::Body;
use super::shared_body::{PairCost, Sharing};
use super::{Scene, SceneError};
use crate::escape::PairMemory;
use crate::math::{Aabb, Scalar};

impl<T: Scalar> Scene<T> {
    /// Sets how a body is shared with other scenes, from the next query on. A new body is not shared.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`].
    pub fn share(&mut self, body: u32, sharing: Sharing) -> Result<(), SceneError> {
        let shared = self.bodies.get_mut(body).ok_or(SceneError::UnknownBody { body })?;
        if sharing.is_ghost {
            shared.own = None;
        }
        shared.sharing = sharing;
        Ok(())
    }

    /// Whether a body is another scene's; never one that the scene does not have.
    pub fn is_ghost(&self, body: u32) -> bool {
        self.bodies.get(body).is_some_and(|body| body.sharing.is_ghost)
    }

    /// Finds the contacts of bodies with themselves where they are asked for, as the next query at the same positions
    /// would, which does not do it again.
    pub fn find_self_contacts(&mut self) {
        let Self { bodies, options, .. } = self;
        for body in bodies.iter_mut() {
            body.find_own_contacts(options);
        }
    }

    /// Whether a body may overlap itself, as the newest query or [`find_self_contacts`](Self::find_self_contacts) found;
    /// never one whose self-collision is off.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`].
    pub fn overlaps_itself(&self, body: u32) -> Result<bool, SceneError> {
        self.bodies.get(body).map(Body::may_overlap_itself).ok_or(SceneError::UnknownBody { body })
    }

    /// The box of a body's surface.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`].
    pub fn body_box(&self, body: u32) -> Result<&Aabb<T>, SceneError> {
        self.mesh(body).map(|mesh| mesh.aabb())
    }

    /// How many rays as long as the newest query took for a body: those of its contacts with itself, half of those of its
    /// pairs, and all of those with ghosts. Fifty triangles that are read count as a ray.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`].
    pub fn body_cost(&self, body: u32) -> Result<f64, SceneError> {
        self.bodies.get(body).map(|body| body.cost).ok_or(SceneError::UnknownBody { body })
    }

    /// What the newest query took for each pair whose boxes overlapped, in the order of the pairs; none before the first.
    pub fn pair_costs(&self) -> &[PairCost] {
        &self.pair_costs
    }

    /// Replaces what one pair remembers, as [`pair_memories`](Self::pair_memories) of this scene or another gave it; the
    /// pair's bodies in their order. It counts from the next query on at which their boxes overlap, and is forgotten by one
    /// at which they do not.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`], [`SceneError::SameBody`], [`SceneError::PairMemory`] where it is nothing that a pair can
    /// remember or the bodies are the other way round; the memories are then as before.
    pub fn set_pair_memory(&mut self, pair: [u32; 2], memory: PairMemory<T>) -> Result<(), SceneError> {
        self.known_pair(pair[0], pair[1])?;
        let [first, second] = self.bodies.order(&pair);
        if first > second || !memory.is_possible() {
            return Err(SceneError::PairMemory { pair });
        }
        self.pairs.history.set(pair, memory, |pair| self.bodies.order(pair));
        Ok(())
    }
}
