//! A step's contact on the unknowns that a simulator solves for: what a host needs beyond contacts and their springs.
//!
//! A [`ContactSystem`] knows what carries each body of a [`Scene`]: nodes (directly, or by weights, as a
//! skin in a cage), a rigid body's six numbers, or the host. In a step it moves the surfaces to where they would be without
//! contact, lets the scene detect there, and makes each contact a **row**: a unilateral spring with friction over those
//! unknowns. Between linearisations the rows' force is linear in the velocities v at the end of the step,
//! −Jᵀ (p + D J (v − v₀)) with D positive semi-definite, and conjugate gradients converge.
//!
//! ```text
//! begin(scene, dt, x, v, v without contact)
//!     repeat: solve M (v⁺ − v) = dt · (own forces + add_forces(v⁺)), with add_product in the solve
//!             wrong = linearise(v⁺); done where little of the force was wrong
//!             detect_again(scene, v⁺), where stopped bodies may meet others
//! finish(v⁺)
//! ```
//! Numbers are in SI units and double precision, whatever the scene's; vectors of unknowns hold x, y, z of each node, then,
//! where rigid bodies are [kept](RigidUnknowns::Kept), the linear and angular velocity of each in the order they were added.

mod anchors;
mod body;
mod buffers;
mod compressed;
mod coupling;
mod detect_again;
mod error;
mod explicit;
mod half_spaces;
pub(crate) mod hooks;
mod impacts;
mod lines;
mod loads;
mod material;
mod matrix;
mod motions;
mod pairs;
mod potential;
mod products;
mod rigid_matrix;
mod row;
mod row_builder;
mod row_by_row;
mod row_chunk;
mod rows;
mod solve;
mod step;
mod twist;

pub use body::{Carriers, Motion};
pub use compressed::CompressedRows;
pub use error::SystemError;
pub(crate) use error::{check_count, check_range, check_within};
pub use loads::Surface;
pub use material::Material;

use crate::contact::ContactList;
use crate::force::Weighting;
use crate::math::{Scalar, margins};
use crate::memory::{self, Room};
use crate::mesh::Mesh;
use crate::scene::Scene;
use anchors::Anchors;
use body::{Body, Mover, RigidSurface, Table};
use buffers::{Buffers, Step};
use compressed::Compressed;
use half_spaces::{Below, HalfSpace};
use loads::{Key, PairLoads};
use nalgebra::{Matrix3, Matrix6};
use row_builder::PairMaterials;
use rows::Rows;
use std::ops::{AddAssign, Range};
use twist::{Inertia, V3};

/// What becomes of the velocities of rigid bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RigidUnknowns {
    /// The host solves for its nodes alone: rigid bodies give way exactly as they would if they were solved for, and
    /// [`rigid_velocity`](ContactSystem::rigid_velocity) has the result. A step factors a dense matrix of six rows for each
    /// rigid body, so some fifty of them are the most that is sensible.
    #[default]
    Eliminated,
    /// They are unknowns of the host, behind those of its nodes.
    Kept,
}

/// The contacts of a scene on the unknowns of a host.
///
/// Its rows stay as they are until [`linearise`](Self::linearise) or [`detect_again`](Self::detect_again). A steady step
/// allocates nothing.
///
/// Each call refuses what is wrong with an error of its own. Some are not listed again at each: [`SystemError::UnknownBody`] for
/// a body that the system does not have; [`SystemError::StepUnderWay`] for what must come outside a step;
/// [`SystemError::NoStep`] for what must come within one; [`SystemError::WrongCount`] and [`SystemError::NotFinite`] for arrays.
#[derive(Debug, Default)]
pub struct ContactSystem<T: Scalar> {
    rigid_unknowns: RigidUnknowns,
    /// Whether it looks for contacts where bodies are at the start of a step, and not where they will be.
    pub(crate) looks_at_start: bool,
    weighting: Weighting,
    pub(crate) node_masses: Vec<f64>,
    /// In ascending order of their numbers.
    bodies: Vec<Body<T>>,
    pub(crate) rigid_count: usize,
    pub(crate) half_spaces: Vec<HalfSpace>,
    pair_materials: PairMaterials,
    contacts: ContactList<T>,
    /// Those of the last trial.
    trial: ContactList<T>,
    pub(crate) rows: Rows,
    compressed: Compressed,
    pub(crate) anchors: Anchors,
    pub(crate) loads: PairLoads,
    pub(crate) step: Option<Step>,
    pub(crate) buffers: Buffers,
    /// Of an eighth of the bodies each, so that threads may share them.
    below: [Below<T>; 8],
}

impl<T: Scalar> ContactSystem<T> {
    /// A system without bodies.
    pub fn new(rigid_unknowns: RigidUnknowns) -> Self {
        Self { rigid_unknowns, ..Self::default() }
    }

    /// Detects contacts where bodies are at the start of a step, not where they will be, so bodies that meet within a step have
    /// none yet.
    #[must_use]
    pub fn looking_at_the_start(mut self) -> Self {
        self.looks_at_start = true;
        self
    }

    /// Weights contacts by the area that each stands for, as a new system does, or all alike as in the paper; the stiffness of
    /// materials is then in N/m. Half-spaces always press on areas.
    #[must_use]
    pub fn weighted_by(mut self, weighting: Weighting) -> Self {
        self.weighting = weighting;
        self
    }

    /// Says how many nodes the host has, and their masses in kg: infinity for one that is fixed. Within a step there may
    /// be more than before, for foreign bodies that join it, and all other bodies' nodes keep their masses.
    ///
    /// # Errors
    /// [`SystemError::Mass`], [`SystemError::WrongCount`] where a body's nodes lie beyond.
    pub fn set_node_masses(&mut self, masses: &[f64]) -> Result<(), SystemError> {
        self.check_only_joined_change(masses)?;
        let is_mass = |mass: f64| is_mass(mass) || mass == f64::INFINITY;
        if let Some(node) = masses.iter().position(|&mass| !is_mass(mass)) {
            return Err(SystemError::Mass { node: Some(node), value: masses[node] });
        }
        let needed = self.bodies.iter().filter_map(|body| body.nodes()).map(|nodes| nodes.end as usize).max();
        if let Some(expected) = needed.filter(|&needed| needed > masses.len()) {
            return Err(SystemError::WrongCount { what: "masses", given: masses.len(), expected });
        }
        memory::refill(&mut self.node_masses, masses.iter().copied());
        for body in &mut self.bodies {
            if let Some(nodes) = body.nodes() {
                body.mass = mass_of(&self.node_masses, nodes);
            }
        }
        self.extend_step();
        Ok(())
    }

    /// Adds a deformable body: number `body` of the scene, with the host's nodes `nodes`, which carry its surface as
    /// `carriers` says. The masses of the nodes are to be set before. Within a step only
    /// [foreign](Scene::is_foreign) bodies may be added, of this kind or another, which join it.
    pub fn add_deformable(
        &mut self,
        scene: &Scene<T>,
        body: u32,
        nodes: Range<u32>,
        carriers: Carriers<'_>,
        material: Material,
    ) -> Result<(), SystemError> {
        let (index, mesh) = self.check_new(scene, body, &material)?;
        let (end, count) = (nodes.end.max(nodes.start), self.node_masses.len());
        if end as usize > count {
            return Err(SystemError::WrongCount { what: "node masses", given: count, expected: end as usize });
        }
        let table = Table::new(carriers, mesh.topology().vertex_count(), nodes.clone())?;
        let mass = mass_of(&self.node_masses, nodes.clone());
        let mover = Mover::Nodes { table, nodes };
        self.insert(index, Body::new(body, material, mover, mesh, mass));
        Ok(())
    }

    /// Adds a rigid body: number `body` of the scene, whose mesh was created in the body's own coordinates, with the centre
    /// of mass at the origin. `mass` in kg, `inertia` in kg m² about that point in those coordinates. It is at the origin
    /// until [`set_motion`](Self::set_motion).
    pub fn add_rigid(
        &mut self,
        scene: &Scene<T>,
        body: u32,
        mass: f64,
        inertia: [[f64; 3]; 3],
        material: Material,
    ) -> Result<(), SystemError> {
        let (index, mesh) = self.check_new(scene, body, &material)?;
        if !is_mass(mass) {
            return Err(SystemError::Mass { node: None, value: mass });
        }
        let inertia = Matrix3::from_fn(|row, column| inertia[row][column]);
        let [asymmetry, least] = margins::INERTIA;
        let is_symmetric = (inertia - inertia.transpose()).norm() <= asymmetry * inertia.norm();
        let factor = (inertia / inertia.norm() - Matrix3::identity() * least).cholesky();
        if !is_symmetric || !inertia.iter().all(|x| x.is_finite()) || factor.is_none() {
            return Err(SystemError::Inertia);
        }
        let inertia = memory::boxed(Inertia { mass, about: inertia, ..Inertia::default() });
        let mover = Mover::Rigid { inertia, index: self.rigid_count, surface: RigidSurface::new(mesh) };
        // Memory first: if there is none, the count must not have changed.
        self.bodies.room_for(1);
        self.rigid_count += 1;
        self.insert(index, Body::new(body, material, mover, mesh, mass));
        Ok(())
    }

    /// Adds a body that stands still or that the host moves: number `body` of the scene, whose mesh was created in the body's
    /// own coordinates. It is where those say until [`set_motion`](Self::set_motion).
    pub fn add_moved(&mut self, scene: &Scene<T>, body: u32, material: Material) -> Result<(), SystemError> {
        let (index, mesh) = self.check_new(scene, body, &material)?;
        let mover = Mover::Host(RigidSurface::new(mesh));
        self.insert(index, Body::new(body, material, mover, mesh, f64::INFINITY));
        Ok(())
    }

    /// Adds a half-space, solid where `normal` · x < `offset`, for all bodies with unknowns; gives its number. Their surface
    /// vertices below the plane bear the pressure.
    ///
    /// # Errors
    /// [`SystemError::Normal`] where the normal is no unit vector, [`SystemError::Material`].
    pub fn add_half_space(&mut self, normal: [f64; 3], offset: f64, material: Material) -> Result<u32, SystemError> {
        self.check_no_step()?;
        check_range("normal", &normal)?;
        check_range("offset", &[offset])?;
        let normal = V3::from(normal);
        if (normal.norm() - 1.0).abs() > margins::UNIT_NORMAL {
            return Err(SystemError::Normal { length: normal.norm() });
        }
        material.check()?;
        self.half_spaces.room_for(1).push(HalfSpace { normal: normal.normalize(), offset, material });
        Ok(self.half_spaces.len() as u32 - 1)
    }

    /// Removes a body; the scene's is untouched. Rigid bodies added after it move up by one, and the removal of one
    /// forgets the velocities of the last step.
    pub fn remove(&mut self, body: u32) -> Result<(), SystemError> {
        self.check_no_step()?;
        let index = self.index_of(body)?;
        if let Mover::Rigid { index: gone, .. } = self.bodies.remove(index).mover {
            self.rigid_count -= 1;
            // The velocities of the last step are stored by the old indices.
            self.buffers.end_twists.clear();
            for body in &mut self.bodies {
                if let Mover::Rigid { index, .. } = &mut body.mover {
                    *index -= usize::from(*index > gone);
                }
            }
        }
        let is_gone = |key: &Key| key.0 == body || key.1 == Surface::Body(body);
        self.anchors.forget(is_gone);
        self.loads.forget(is_gone);
        self.pair_materials.retain(|(pair, _)| !is_gone(pair));
        Ok(())
    }

    /// Says where a rigid or moved body is, and how it moves. Before each step; within one of a body that has
    /// joined it.
    ///
    /// # Errors
    /// [`SystemError::UnknownBody`] also for a deformable body; [`SystemError::Rotation`].
    pub fn set_motion(&mut self, body: u32, motion: &Motion) -> Result<(), SystemError> {
        self.check_joined(&[body])?;
        let index = self.index_of(body)?;
        let surface = self.bodies[index].surface_mut().ok_or(SystemError::UnknownBody { body })?;
        surface.set_motion(body, motion)?;
        self.extend_step();
        Ok(())
    }

    /// Says what joints add to a rigid body's mass and inertia, in the body's own coordinates: the momentum, linear and
    /// angular, that six velocities take more than they would of the body alone. Forces then move the body no further than its
    /// joints let it go. The contacts' explicit steps take no notice. Before each step in which it has changed.
    ///
    /// # Errors
    /// [`SystemError::UnknownBody`] where it is no rigid body; [`SystemError::Inertia`] where the matrix is not symmetric, or its
    /// sum with the body's own not positive definite.
    pub fn set_added_inertia(&mut self, body: u32, added: [[f64; 6]; 6]) -> Result<(), SystemError> {
        self.check_joined(&[body])?;
        check_range("added", added.as_flattened())?;
        let added = Matrix6::from_fn(|row, column| added[row][column]);
        let index = self.index_of(body)?;
        let Mover::Rigid { inertia, .. } = &mut self.bodies[index].mover else {
            return Err(SystemError::UnknownBody { body });
        };
        let [inertia] = &mut **inertia;
        let mut whole = added;
        (0..3).for_each(|k| whole[(k, k)] += inertia.mass);
        whole.fixed_view_mut::<3, 3>(3, 3).add_assign(&inertia.about);
        let is_symmetric = (added - added.transpose()).norm() <= margins::INERTIA[0] * added.norm();
        if !is_symmetric || whole.cholesky().is_none() {
            return Err(SystemError::Inertia);
        }
        inertia.added = added;
        self.extend_step();
        Ok(())
    }

    /// How many unknowns a vector of velocities or forces has.
    pub fn unknown_count(&self) -> usize {
        let kept = if self.rigid_unknowns == RigidUnknowns::Kept { 6 * self.rigid_count } else { 0 };
        3 * self.node_masses.len() + kept
    }

    /// The contacts of the last detection.
    pub fn contacts(&self) -> &ContactList<T> {
        &self.contacts
    }

    /// The index of a new body, and its mesh.
    fn check_new<'a>(
        &self,
        scene: &'a Scene<T>,
        body: u32,
        material: &Material,
    ) -> Result<(usize, &'a Mesh<T>), SystemError> {
        self.check_may_join(scene, body)?;
        let mesh = mesh_of(scene, body)?;
        material.check()?;
        match self.bodies.binary_search_by_key(&body, |body| body.number) {
            Ok(_) => Err(SystemError::BodyTwice { body }),
            Err(index) => Ok((index, mesh)),
        }
    }

    fn insert(&mut self, index: usize, body: Body<T>) {
        let has_joined = self.step.is_some();
        self.bodies.room_for(1).insert(index, Body { has_joined, ..body });
        self.extend_step();
    }

    fn index_of(&self, body: u32) -> Result<usize, SystemError> {
        self.bodies.binary_search_by_key(&body, |body| body.number).map_err(|_| SystemError::UnknownBody { body })
    }

    pub(crate) fn check_no_step(&self) -> Result<(), SystemError> {
        if self.step.is_some() { Err(SystemError::StepUnderWay) } else { Ok(()) }
    }
}

fn mesh_of<T: Scalar>(scene: &Scene<T>, body: u32) -> Result<&Mesh<T>, SystemError> {
    scene.mesh(body).map_err(|_| SystemError::NotInScene { body })
}

fn mass_of(masses: &[f64], nodes: Range<u32>) -> f64 {
    let own = masses.get(nodes.start as usize..nodes.end as usize).unwrap_or_default();
    let sum: f64 = own.iter().filter(|mass| mass.is_finite()).sum();
    if sum > 0.0 { sum } else { f64::INFINITY }
}

fn is_mass(mass: f64) -> bool {
    let [least, most] = margins::MASSES;
    (least..=most).contains(&mass)
}
