use super::body::{Body, Mover};
use super::buffers::{Buffers, Step};
use super::error::{SystemError, check_count, check_range, check_within};
use super::row_builder::RowBuilder;
use super::{ContactSystem, RigidUnknowns, mesh_of};
use crate::math::{Scalar, margins};
use crate::memory::{self, Room};
use crate::mesh::{MeshError, next_stamp};
use crate::scene::Scene;

/// A host's threads move bodies that have at least so many vertices in all. What chose it: docs/architecture.md, *Tuned
/// constants*.
const FEWEST_VERTICES: usize = 4096;

impl<T: Scalar> ContactSystem<T> {
    /// Begins a step of `dt` seconds: x, y, z of each node's position in m and velocity in m/s at its start, and the
    /// velocity it would have at its end if nothing touched it. Detects where all bodies would then be, in `scene`, whose
    /// positions this sets, and makes rows of the contacts, linearised there. Rigid and moved bodies go by their
    /// [`set_motion`](Self::set_motion).
    ///
    /// # Errors
    /// [`SystemError::StepLength`]; [`SystemError::UnknownBody`] where the scene has a body that the system does not know,
    /// [`SystemError::NotInScene`] where it is the other way round; [`SystemError::Mesh`] where a position is beyond the scene's
    /// precision; [`SystemError::TooStiff`].
    pub fn begin(
        &mut self,
        scene: &mut Scene<T>,
        dt: f64,
        positions: &[f64],
        velocities: &[f64],
        free_velocities: &[f64],
    ) -> Result<(), SystemError> {
        let ahead = if self.looks_at_start { 0.0 } else { dt };
        let step = self.start(scene, [dt, ahead, dt], [positions, velocities, free_velocities])?;
        self.linearise_predicted(step)?;
        self.step = Some(step);
        Ok(())
    }

    /// [`begin`](Self::begin) with separate times for the step, the prediction and the rows; `given` are its three arrays.
    pub(super) fn start(
        &mut self,
        scene: &mut Scene<T>,
        [dt, ahead, rows]: [f64; 3],
        given: [&[f64]; 3],
    ) -> Result<Step, SystemError> {
        self.prepare(scene, dt, given)?;
        self.detect(scene, ahead)?;
        // This fails only for a bad step length, which `prepare` has checked.
        let _ = scene.advance(dt);
        self.rows.clear();
        self.anchors.start_step();
        self.loads.start_step();
        self.add_rows(ahead, |_, _| true, Some(scene));
        if rows > 0.0 {
            self.add_impacts(0, rows);
        }
        self.hand_over();
        Ok(Step { dt: rows, unknowns: self.unknown_count() })
    }

    /// Checks and copies what the host gives at the start of a step.
    pub(crate) fn prepare(
        &mut self,
        scene: &Scene<T>,
        dt: f64,
        [positions, velocities, free_velocities]: [&[f64]; 3],
    ) -> Result<(), SystemError> {
        self.check_no_step()?;
        if !(margins::SHORTEST_STEP..=margins::LARGEST_GIVEN).contains(&dt) {
            return Err(SystemError::StepLength { seconds: dt });
        }
        self.check_nodes([("positions", positions), ("velocities", velocities), ("free_velocities", free_velocities)])?;
        self.check_bodies(scene)?;
        let Self { buffers, bodies, .. } = self;
        memory::refill(&mut buffers.positions, positions.iter().copied());
        memory::refill(&mut buffers.velocities, velocities.iter().copied());
        memory::refill(&mut buffers.ahead, free_velocities.iter().copied());
        memory::refill_with(&mut self.rows.masses, Default::default(), self.rigid_count);
        for twists in [&mut buffers.twists, &mut buffers.free_twists] {
            memory::refill_with(twists, 0.0, 6 * self.rigid_count);
        }
        bodies.iter_mut().for_each(|body| body.has_joined = false);
        for body in &*bodies {
            body.start_rigid(buffers, &mut self.rows.masses);
        }
        memory::refill(&mut buffers.ahead_twists, buffers.free_twists.iter().copied());
        Ok(())
    }

    /// Extends the step under way to bodies that have joined: at rest at the origin until their motion is set.
    pub(super) fn extend_step(&mut self) {
        let unknowns = self.unknown_count();
        let Some(step) = &mut self.step else { return };
        let Self { buffers, bodies, rows, rigid_count, node_masses, .. } = self;
        rows.stamp = next_stamp();
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

    /// Moves the scene's bodies to their predicted positions and finds the contacts there.
    pub(super) fn detect(&mut self, scene: &mut Scene<T>, time: f64) -> Result<(), SystemError> {
        self.move_surfaces(scene, time, false)?;
        scene.query(&mut self.contacts);
        Ok(())
    }

    /// Moves surfaces to their predicted positions; where `own` is set, those of the scene's own bodies alone.
    pub(crate) fn move_surfaces(&mut self, scene: &mut Scene<T>, time: f64, own: bool) -> Result<(), SystemError> {
        let is_left = |scene: &Scene<T>, body: u32| own && scene.is_foreign(body);
        let Self { bodies, buffers, half_spaces, rows, .. } = self;
        Buffers::predict(&mut buffers.predicted, &buffers.positions, &buffers.ahead, time);
        let course = buffers.course(time);
        rows.host = scene.lent_threads();
        let known: &Scene<T> = scene;
        rows.helpers(has_many_vertices(bodies)).for_each(bodies, |_, body| {
            if !is_left(known, body.number) {
                body.go(&course);
            }
        });
        for body in &mut *bodies {
            if is_left(scene, body.number) {
                continue;
            }
            let number = body.number;
            // Contacts with half-spaces need all vertices of a body that can move.
            let needs_vertices = body.is_movable() && !half_spaces.is_empty();
            if !needs_vertices && body.pose_ahead().is_some_and(|pose| scene.may_follow(number, &pose)) {
                continue;
            }
            body.fill_positions().map_err(|vertex| SystemError::Mesh {
                body: number,
                source: MeshError::NotFinite { vertex, is_renewal: true },
            })?;
        }
        for body in &*bodies {
            scene.carry_by(body.number, body.carrier);
            let is_moved =
                |scene: &mut Scene<T>| body.pose_ahead().is_some_and(|pose| scene.follow(body.number, &pose));
            if is_left(scene, body.number) || is_moved(scene) {
                continue;
            }
            let mesh = scene.mesh_mut(body.number).map_err(|_| SystemError::NotInScene { body: body.number })?;
            let moved = mesh.set_positions(&body.positions);
            moved.map_err(|source| SystemError::Mesh { body: body.number, source })?;
        }
        Ok(())
    }

    /// Adds rows for the wanted pairs' contacts; with a scene also for escapes and half-spaces.
    pub(super) fn add_rows(&mut self, time: f64, wanted: impl Fn(u32, u32) -> bool, scene: Option<&Scene<T>>) {
        let Self { bodies, pair_materials, node_masses, contacts, rows, anchors, loads, buffers, below, .. } = self;
        let weighting = self.weighting;
        // Here, since bodies may have joined in the step.
        bodies.iter_mut().for_each(|body| body.find_drift(&buffers.velocities, node_masses));
        let course = buffers.course(time);
        let before = buffers.before();
        rows.stamp = next_stamp();
        rows.make_room(node_masses.len());
        let helpers = rows.helpers(has_many_vertices(bodies));
        let mut builder =
            RowBuilder { weighting, bodies, pair_materials, node_masses, rows, anchors, loads, course, before };
        let first = builder.rows.rows.len();
        builder.add_contacts(contacts, wanted);
        if let Some(scene) = scene {
            builder.add_escapes(contacts.pushes());
            let (bodies, shares) = (builder.bodies, below.len());
            for (number, half_space) in self.half_spaces.iter().enumerate() {
                helpers.for_each(below, |share, below| {
                    below.clear();
                    for index in bodies.len() * share / shares..bodies.len() * (share + 1) / shares {
                        let body = &bodies[index];
                        if let Some(mesh) = scene.mesh(body.number).ok().filter(|_| !scene.is_foreign(body.number)) {
                            below.find_pressed(half_space, (index, body), mesh, time > 0.0);
                        }
                    }
                });
                for below in &*below {
                    builder.add_half_space_rows((number as u32, half_space), below);
                    contacts.statistics.deep_pairs += below.deep_bodies;
                }
            }
        }
        for row in &mut rows.rows[first..] {
            row.damping_time *= loads.now[row.pair].wander.damped_fraction();
        }
    }

    /// Whether these are numbers for all nodes.
    pub(crate) fn check_nodes<const N: usize>(&self, given: [(&'static str, &[f64]); N]) -> Result<(), SystemError> {
        given.into_iter().try_for_each(|(what, numbers)| {
            check_count(what, numbers.len(), 3 * self.node_masses.len())?;
            check_range(what, numbers)
        })
    }

    pub(crate) fn check_bodies(&self, scene: &Scene<T>) -> Result<(), SystemError> {
        if let Some(body) = scene.body_numbers().find(|&number| self.index_of(number).is_err()) {
            return Err(SystemError::UnknownBody { body });
        }
        for body in &self.bodies {
            let mesh = mesh_of(scene, body.number)?;
            check_count("the body's mesh", mesh.topology().vertex_count(), body.vertex_count())?;
        }
        Ok(())
    }

    /// The step under way, if there is one and these are velocities of its unknowns.
    pub(crate) fn check_velocities(&self, velocities: &[f64]) -> Result<Step, SystemError> {
        self.check_unknowns("velocities", velocities, margins::LARGEST_GIVEN)
    }

    /// The same for numbers up to `most`.
    pub(crate) fn check_unknowns(&self, what: &'static str, numbers: &[f64], most: f64) -> Result<Step, SystemError> {
        let step = self.step.ok_or(SystemError::NoStep)?;
        check_count(what, numbers.len(), step.unknowns)?;
        check_within(what, numbers, most)?;
        Ok(step)
    }

    /// Finds the rows' motions by the nodes among the host's velocities, and stores the rigid bodies' velocities that belong to
    /// them in `rows.response`.
    pub(crate) fn find_motions(&mut self, velocities: &[f64], step: Step) {
        let (nodes, twists) = velocities.split_at(3 * self.node_masses.len());
        self.rows.find_motions(nodes);
        match self.rigid_unknowns {
            RigidUnknowns::Kept => memory::refill(&mut self.rows.response, twists.iter().copied()),
            RigidUnknowns::Eliminated => self.rows.respond(&self.buffers.free_twists, step.dt),
        }
    }

    /// Makes the rows' forces linear about these velocities, at which it decides which rows push, and how much they rub. To be
    /// called after a solve; gives the fraction of all force that had been predicted wrongly, from 0 to 1. Above 0.05 or so
    /// another solve is due.
    ///
    /// # Errors
    /// [`SystemError::TooStiff`], which cancels the step.
    pub fn linearise(&mut self, velocities: &[f64]) -> Result<f64, SystemError> {
        let step = self.check_velocities(velocities)?;
        self.find_motions(velocities, step);
        self.linearise_at(step)
    }

    /// Ends a step whose velocities at the end are these. Loads and what friction holds on to are remembered for the next, and
    /// [`rigid_velocity`](Self::rigid_velocity) gives rigid bodies' velocities. After an error the step is still under way.
    pub fn finish(&mut self, velocities: &[f64]) -> Result<(), SystemError> {
        let step = self.check_velocities(velocities)?;
        self.find_motions(velocities, step);
        memory::refill(&mut self.buffers.end_twists, self.rows.response.iter().copied());
        self.remember(velocities, step);
        self.step = None;
        Ok(())
    }

    /// Ends a step as if it had not begun; does nothing where none has.
    pub fn cancel(&mut self) {
        self.step = None;
        self.anchors.start_step();
    }

    /// The linear and angular velocity of a rigid body at the end of the last finished step, or of the last
    /// [trial](Self::potential) since.
    ///
    /// # Errors
    /// [`SystemError::UnknownBody`] where it is none, or was added since.
    pub fn rigid_velocity(&self, body: u32) -> Result<[f64; 6], SystemError> {
        let unknown = SystemError::UnknownBody { body };
        let Mover::Rigid { index, .. } = self.bodies[self.index_of(body)?].mover else { return Err(unknown) };
        let twist = self.buffers.end_twists.get(6 * index..6 * index + 6);
        twist.and_then(|twist| twist.try_into().ok()).ok_or(unknown)
    }
}

/// Whether so many vertices are carried by nodes that threads pay.
fn has_many_vertices<T: Scalar>(bodies: &[Body<T>]) -> bool {
    let deformable = bodies.iter().filter(|body| body.nodes().is_some());
    deformable.map(Body::vertex_count).sum::<usize>() >= FEWEST_VERTICES
}
