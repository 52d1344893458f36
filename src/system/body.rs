use super::anchors::AnchorPoint;
use super::buffers::{Buffers, Course};
use super::error::{SystemError, check_count, check_range};
use super::material::Material;
use super::twist::{Inertia, V3, angular, at, linear, rotation};
use crate::contact::SurfacePoint;
use crate::math::{Pose, Scalar, direction, margins};
use crate::memory;
use crate::mesh::{Carrier, Mesh};
use nalgebra::Matrix3;
use std::ops::Range;

/// How the host's nodes carry the surface vertices.
#[derive(Clone, Copy, Debug)]
pub enum Carriers<'a> {
    /// Surface vertex v is the body's node v.
    Nodes,
    /// Surface vertex v is the sum of weights\[e\] · node nodes\[e\] over e from offsets\[v\] up to offsets\[v + 1\]: a skin
    /// in a cage of tetrahedra or trilinear cells, any linear mapping. Weights of a vertex sum to 1; they may be negative.
    Weights {
        /// One more than there are vertices; from 0, rising.
        offsets: &'a [u32],
        /// The node of each entry, counted from the body's first.
        nodes: &'a [u32],
        /// The weight of each entry.
        weights: &'a [f64],
    },
}

/// Where a rigid body, or one moved by the host, is and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// The centre of mass, in m.
    pub position: [f64; 3],
    /// The rows of the rotation matrix from the body's own coordinates to the world's.
    pub rotation: [[f64; 3]; 3],
    /// Linear velocity in m/s, then angular in rad/s, in the world's coordinates.
    pub velocity: [f64; 6],
    /// What the velocity would be at the end of the step without contact. Of a body moved by the host, it is what moves it.
    pub free_velocity: [f64; 6],
}

/// What moves a body.
#[derive(Debug)]
pub(super) enum Mover {
    /// With all nodes of the body.
    Nodes {
        table: Table,
        nodes: Range<u32>,
    },
    /// With its index among the rigid bodies.
    Rigid {
        inertia: Box<[Inertia; 1]>,
        index: usize,
        surface: RigidSurface,
    },
    Host(RigidSurface),
}

/// How nodes carry surface vertices.
#[derive(Debug)]
pub(super) enum Table {
    /// Each of so many vertices by a node, from the first on.
    Nodes { first: u32, count: usize },
    /// By (node, weight) entries.
    Weights { offsets: Vec<u32>, entries: Vec<(u32, f64)> },
}

/// A surface that moves as a rigid body.
#[derive(Debug)]
pub(super) struct RigidSurface {
    /// Its vertices in the body's own coordinates.
    points: Vec<V3>,
    pub(super) centre: V3,
    pub(super) rotation: Matrix3<f64>,
    pub(super) velocity: [f64; 6],
    pub(super) free_velocity: [f64; 6],
}

impl RigidSurface {
    pub(super) fn new<T: Scalar>(mesh: &Mesh<T>) -> Self {
        let points = mesh.reference_positions().iter().map(|point| point.map(T::to_f64));
        Self {
            points: memory::listed(points),
            centre: V3::zeros(),
            rotation: Matrix3::identity(),
            velocity: [0.0; 6],
            free_velocity: [0.0; 6],
        }
    }

    pub(super) fn set_motion(&mut self, body: u32, motion: &Motion) -> Result<(), SystemError> {
        check_range("position", &motion.position)?;
        check_range("velocity", &motion.velocity)?;
        check_range("free_velocity", &motion.free_velocity)?;
        let rotation = Matrix3::from_fn(|row, column| motion.rotation[row][column]);
        let error = (rotation * rotation.transpose() - Matrix3::identity()).norm();
        if !(error < margins::ROTATION && rotation.determinant() > 0.0) {
            return Err(SystemError::Rotation { body });
        }
        self.centre = motion.position.into();
        self.rotation = rotation;
        self.velocity = motion.velocity;
        self.free_velocity = motion.free_velocity;
        Ok(())
    }

    /// Centre and rotation after a time with a velocity.
    fn moved(&self, time: f64, twist: &[f64]) -> (V3, Matrix3<f64>) {
        (self.centre + linear(twist) * time, rotation(&(angular(twist) * time)) * self.rotation)
    }
}

impl Table {
    /// `nodes`: those of the body.
    pub(super) fn new(carriers: Carriers<'_>, vertices: usize, nodes: Range<u32>) -> Result<Self, SystemError> {
        let node_count = nodes.len();
        let first = nodes.start;
        match carriers {
            Carriers::Nodes if vertices > node_count => {
                Err(SystemError::NodeRange { vertex: node_count, node: node_count as u32, count: node_count })
            }
            Carriers::Nodes => Ok(Self::Nodes { first, count: vertices }),
            Carriers::Weights { offsets, nodes, weights } => {
                check_count("offsets", offsets.len(), vertices + 1)?;
                check_count("weights", weights.len(), nodes.len())?;
                let rises = |v: &usize| offsets[*v] > offsets[*v + 1] || offsets[*v + 1] as usize > nodes.len();
                if let Some(vertex) = (0..vertices).find(rises) {
                    return Err(SystemError::Offsets { vertex });
                }
                if offsets[0] != 0 || offsets[vertices] as usize != nodes.len() {
                    return Err(SystemError::Offsets { vertex: if offsets[0] != 0 { 0 } else { vertices } });
                }
                check_range("weights", weights)?;
                for vertex in 0..vertices {
                    let own = offsets[vertex] as usize..offsets[vertex + 1] as usize;
                    if let Some(&node) = nodes[own.clone()].iter().find(|&&node| node as usize >= node_count) {
                        return Err(SystemError::NodeRange { vertex, node, count: node_count });
                    }
                    let (sum, size) = weights[own].iter().fold((0.0, 1.0), |(sum, size), w| (sum + w, size + w.abs()));
                    if !sum.is_finite() || (sum - 1.0_f64).abs() > margins::WEIGHT_SUM * size {
                        return Err(SystemError::WeightSum { vertex, sum });
                    }
                }
                let offsets = memory::listed(offsets.iter().copied());
                let nodes = nodes.iter().map(|node| first + node);
                Ok(Self::Weights { offsets, entries: memory::listed(nodes.zip(weights.iter().copied())) })
            }
        }
    }

    /// How many nodes carry the surface, where they are not its vertices.
    fn carrier_count(&self) -> Option<usize> {
        let Self::Weights { entries, .. } = self else { return None };
        let mut nodes = memory::listed(entries.iter().filter(|(_, weight)| *weight != 0.0).map(|&(node, _)| node));
        nodes.sort_unstable();
        nodes.dedup();
        Some(nodes.len())
    }

    fn vertex_count(&self) -> usize {
        match self {
            Self::Nodes { count, .. } => *count,
            Self::Weights { offsets, .. } => offsets.len() - 1,
        }
    }

    /// Calls `use_node(node, weight)` for each node of a vertex.
    #[inline]
    pub(super) fn for_each(&self, vertex: u32, mut use_node: impl FnMut(u32, f64)) {
        match self {
            Self::Nodes { first, .. } => use_node(first + vertex, 1.0),
            Self::Weights { offsets, entries } => {
                of(offsets, entries, vertex).iter().for_each(|&(node, weight)| use_node(node, weight));
            }
        }
    }

    /// The sum of a field over a vertex's nodes.
    #[inline]
    pub(super) fn sum(&self, vertex: u32, field: &[f64]) -> V3 {
        match self {
            // Added to zero, as other sums are: that turns −0 to 0.
            Self::Nodes { first, .. } => V3::zeros() + at(field, first + vertex),
            Self::Weights { offsets, entries } => {
                let own = of(offsets, entries, vertex).iter();
                own.fold(V3::zeros(), |sum, &(node, weight)| sum + at(field, node) * weight)
            }
        }
    }
}

#[inline]
fn of<'a>(offsets: &[u32], entries: &'a [(u32, f64)], vertex: u32) -> &'a [(u32, f64)] {
    &entries[offsets[vertex as usize] as usize..offsets[vertex as usize + 1] as usize]
}

/// A body of the system.
#[derive(Debug)]
pub(super) struct Body<T: Scalar> {
    /// Its number in the scene.
    pub(super) number: u32,
    pub(super) material: Material,
    pub(super) mover: Mover,
    /// Its surface vertices farthest along each axis, which help to carry points inside it.
    pub(super) outermost: [u32; 6],
    /// The sum of its nodes' masses, or a rigid body's mass; infinite if no force moves it.
    pub(super) mass: f64,
    /// Where detection last looked for its contacts: the vertices of a surface that nodes carry, or centre and rotation.
    pub(super) ahead: Vec<V3>,
    pub(super) ahead_pose: (V3, Matrix3<f64>),
    /// How fast its centre of mass moves at the start of the step.
    pub(super) drift: V3,
    /// Scratch memory for the positions of its surface.
    pub(super) positions: Vec<[T; 3]>,
    pub(super) carrier: Carrier<T>,
    /// Whether it was added within the step under way, or the last one.
    pub(super) has_joined: bool,
}

impl<T: Scalar> Body<T> {
    pub(super) fn new(number: u32, material: Material, mover: Mover, mesh: &Mesh<T>, mass: f64) -> Self {
        let ahead_pose = (V3::zeros(), Matrix3::identity());
        let outermost = outermost(mesh);
        let spacing = match &mover {
            Mover::Nodes { table, .. } => {
                table.carrier_count().map_or(0.0, |count| (mesh.roundness().area / count as f64).sqrt())
            }
            Mover::Rigid { .. } => 0.0,
            Mover::Host(_) => f64::INFINITY,
        };
        let are_vertices_nodes = matches!(mover, Mover::Nodes { table: Table::Nodes { .. }, .. });
        Self {
            number,
            material,
            mover,
            outermost,
            mass,
            ahead: Vec::new(),
            ahead_pose,
            drift: V3::zeros(),
            positions: Vec::new(),
            carrier: Carrier { spacing: T::of(spacing), are_vertices_nodes },
            has_joined: false,
        }
    }

    /// Whether a force can move it.
    pub(super) fn is_movable(&self) -> bool {
        !matches!(self.mover, Mover::Host(_))
    }

    pub(super) fn vertex_count(&self) -> usize {
        match &self.mover {
            Mover::Nodes { table, .. } => table.vertex_count(),
            Mover::Rigid { surface, .. } | Mover::Host(surface) => surface.points.len(),
        }
    }

    /// The nodes of a deformable body.
    pub(super) fn nodes(&self) -> Option<Range<u32>> {
        if let Mover::Nodes { nodes, .. } = &self.mover { Some(nodes.clone()) } else { None }
    }

    /// Stores how a rigid body moves at the start of a step, and its mass and inertia there.
    pub(super) fn start_rigid(&self, buffers: &mut Buffers, masses: &mut [Inertia]) {
        if let Mover::Rigid { inertia, index, surface } = &self.mover {
            let own = 6 * index..6 * index + 6;
            buffers.twists[own.clone()].copy_from_slice(&surface.velocity);
            buffers.free_twists[own].copy_from_slice(&surface.free_velocity);
            masses[*index] = inertia[0].turned(&surface.rotation);
        }
    }

    /// Finds the drift; of a deformable body that of its free nodes.
    pub(super) fn find_drift(&mut self, velocities: &[f64], masses: &[f64]) {
        self.drift = match &self.mover {
            Mover::Nodes { nodes, .. } => {
                let free = nodes.clone().filter(|&node| masses[node as usize].is_finite());
                free.map(|node| at(velocities, node) * masses[node as usize]).sum::<V3>() / self.mass
            }
            Mover::Rigid { surface, .. } | Mover::Host(surface) => linear(&surface.velocity),
        };
    }

    /// The surface of a body that is not deformable.
    pub(super) fn surface_mut(&mut self) -> Option<&mut RigidSurface> {
        match &mut self.mover {
            Mover::Nodes { .. } => None,
            Mover::Rigid { surface, .. } | Mover::Host(surface) => Some(surface),
        }
    }

    /// The predicted centre and rotation of a body that is not deformable.
    fn pose(&self, course: &Course<'_>) -> Option<(V3, Matrix3<f64>)> {
        match &self.mover {
            Mover::Nodes { .. } => None,
            Mover::Rigid { surface, index, .. } => {
                Some(surface.moved(course.time, &course.twists[6 * index..6 * index + 6]))
            }
            Mover::Host(surface) => Some(surface.moved(course.time, &surface.free_velocity)),
        }
    }

    /// The predicted positions of surface vertices.
    pub(super) fn vertices(&self, course: &Course<'_>) -> impl Fn(u32) -> V3 {
        let pose = self.pose(course);
        move |vertex| match (&self.mover, &pose) {
            (Mover::Rigid { surface, .. } | Mover::Host(surface), Some((centre, rotation))) => {
                centre + rotation * surface.points[vertex as usize]
            }
            (Mover::Nodes { table, .. }, _) => table.sum(vertex, course.positions),
            _ => V3::zeros(),
        }
    }

    /// Moves the body to its predicted position; of a deformable one also fills `positions`.
    pub(super) fn go(&mut self, course: &Course<'_>) {
        if let Some(pose) = self.pose(course) {
            self.ahead_pose = pose;
        } else if let Mover::Nodes { table, .. } = &self.mover {
            let vertices = 0..table.vertex_count() as u32;
            memory::refill(&mut self.ahead, vertices.map(|vertex| table.sum(vertex, course.positions)));
            memory::refill(&mut self.positions, self.ahead.iter().map(rounded));
        }
    }

    /// Where a surface vertex was at the last detection.
    pub(super) fn vertex_ahead(&self, vertex: u32) -> V3 {
        match &self.mover {
            Mover::Nodes { .. } => self.ahead[vertex as usize],
            Mover::Rigid { surface, .. } | Mover::Host(surface) => {
                self.ahead_pose.0 + self.ahead_pose.1 * surface.points[vertex as usize]
            }
        }
    }

    /// Where a point of the surface was at the last detection.
    pub(super) fn point_ahead(&self, corners: &AnchorPoint) -> V3 {
        corners.point(|vertex| self.vertex_ahead(vertex))
    }

    /// The outward normal of a triangle at the last detection.
    pub(super) fn normal_ahead(&self, corners: [u32; 3]) -> V3 {
        let [a, b, c] = corners.map(|vertex| self.vertex_ahead(vertex));
        direction(&(b - a).cross(&(c - a))).unwrap_or_default()
    }

    /// The pose at the last detection, of a body that is not deformable.
    pub(super) fn pose_ahead(&self) -> Option<Pose> {
        if matches!(self.mover, Mover::Nodes { .. }) {
            return None;
        }
        let (centre, rotation) = self.ahead_pose;
        let rotation = [0, 1, 2].map(|row| [0, 1, 2].map(|column| rotation[(row, column)]));
        Some(Pose { position: centre.into(), rotation })
    }

    /// Fills `positions` with those of the last detection, or gives the first vertex that the precision cannot hold.
    pub(super) fn fill_positions(&mut self) -> Result<(), usize> {
        let Self { mover, ahead_pose: (centre, rotation), positions, .. } = self;
        if let Mover::Rigid { surface, .. } | Mover::Host(surface) = mover {
            memory::refill(positions, surface.points.iter().map(|point| rounded(&(*centre + *rotation * point))));
        }
        match self.positions.iter().position(|position| !position.iter().all(|x| x.is_finite())) {
            Some(vertex) => Err(vertex),
            None => Ok(()),
        }
    }
}

fn rounded<T: Scalar>(x: &V3) -> [T; 3] {
    [T::of(x.x), T::of(x.y), T::of(x.z)]
}

/// The weights of a point of the surface in double precision.
pub(super) fn weights_of<T: Scalar>(point: &SurfacePoint<T>) -> [f64; 3] {
    let [_, second, third] = point.weights.map(T::to_f64);
    // So that they sum to 1 in double precision too.
    [1.0 - second - third, second, third]
}

/// The vertices of a surface that lie farthest along each axis, both ways.
fn outermost<T: Scalar>(mesh: &Mesh<T>) -> [u32; 6] {
    let positions = mesh.reference_positions();
    let along =
        |vertex: u32, k: usize| positions[vertex as usize][k / 2] * T::of(if k.is_multiple_of(2) { 1.0 } else { -1.0 });
    let vertices = mesh.topology().surface_vertices();
    std::array::from_fn(|k| {
        vertices.iter().copied().fold(vertices[0], |best, v| if along(v, k) > along(best, k) { v } else { best })
    })
}
