//! What bodies store in contacts at trial positions.

use super::loads::Surface;
use super::row_builder::{material_of, pressed_area};
use super::{ContactSystem, SystemError};
use crate::force::Weighting;
use crate::math::Scalar;
use crate::memory;
use crate::scene::Scene;
use std::mem::swap;

impl<T: Scalar> ContactSystem<T> {
    /// The energy that bodies would store in contacts, in J, if they moved with these velocities from the start of the step for
    /// `part` of its length, from 0 to 1. Contacts are looked for there, in `scene`, whose bodies it moves; the step goes on as
    /// if it had not been asked. Under the pressure law it is the integral of the pressure over what bodies share (see
    /// [`Scene::potential`]), up to the materials' depth caps; with half-spaces the same over what is below, vertex by vertex.
    /// Damping and friction have no part in it. Eliminated rigid bodies move as they answer to these velocities, and
    /// [`rigid_velocity`](Self::rigid_velocity) has their answer until the step ends.
    ///
    /// # Errors
    /// [`SystemError::BeyondRange`] also where `part` is not within 0 and 1, and those of [`begin`](Self::begin) for the scene.
    pub fn potential(&mut self, scene: &mut Scene<T>, velocities: &[f64], part: f64) -> Result<f64, SystemError> {
        let step = self.check_velocities(velocities)?;
        super::check_range("part", &[part])?;
        if !(0.0..=1.0).contains(&part) {
            return Err(SystemError::BeyondRange { what: "part", index: 0, value: part, most: 1.0 });
        }
        self.check_bodies(scene)?;
        self.swap_ahead();
        self.go_on_with(velocities, step);
        let moved = self.move_surfaces(scene, part * step.dt, false);
        self.swap_ahead();
        memory::refill(&mut self.buffers.end_twists, self.rows.response.iter().copied());
        moved?;
        scene.query(&mut self.trial);
        scene.disregard_query();
        Ok(self.energy_between(scene) + self.energy_below(scene))
    }

    fn swap_ahead(&mut self) {
        let [nodes, twists] = &mut self.buffers.kept;
        swap(nodes, &mut self.buffers.ahead);
        swap(twists, &mut self.buffers.ahead_twists);
    }

    /// Of the trial's contacts between bodies.
    fn energy_between(&mut self, scene: &Scene<T>) -> f64 {
        let Self { bodies, pair_materials, trial, weighting, .. } = self;
        let material = |[a, b]: [u32; 2]| material_of(bodies, pair_materials, (a, Surface::Body(b)), None).0;
        match *weighting {
            Weighting::Area => scene.potential_of(trial, |pair| {
                let material = material(pair);
                [material.stiffness, material.depth_cap]
            }),
            Weighting::Vertex => trial.sum_of_pairs(|pair, contacts, _| {
                let doubled = contacts
                    .iter()
                    .map(|contact| (pressed_area(contact, Weighting::Vertex) * contact.depth * contact.depth).to_f64());
                0.5 * material(pair).stiffness * doubled.sum::<f64>()
            }),
        }
    }

    /// Of what lies below half-spaces there.
    fn energy_below(&mut self, scene: &Scene<T>) -> f64 {
        let Self { bodies, pair_materials, half_spaces, below, .. } = self;
        let mut sum = 0.0;
        for (number, half_space) in half_spaces.iter().enumerate() {
            let own = bodies.iter().filter(|body| body.is_movable() && !scene.is_foreign(body.number));
            for body in own {
                let Ok(mesh) = scene.mesh(body.number) else { continue };
                let key = (body.number, Surface::HalfSpace(number as u32));
                let (material, _) = material_of(bodies, pair_materials, key, Some(&half_space.material));
                sum += material.stiffness * below[0].energy(half_space, body, mesh, material.depth_cap);
            }
        }
        sum
    }
}
