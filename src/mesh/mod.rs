//! One outward-oriented triangle surface, closed unless asked otherwise: fixed topology, positions renewed each step.

mod clusters;
mod edges;
mod error;
mod facing;
mod holes;
mod normals;
mod obj_file;
mod obj_text;
mod order;
mod orientation;
mod patches;
mod posed;
mod positions;
mod roundness;
#[cfg(test)]
pub(crate) mod test_mesh;
mod topology;
mod winding;

pub(crate) use clusters::{CLUSTER_SIZE, Clusters, capacity_below, middle, sort_points};
pub(crate) use edges::Side;
pub use edges::{Border, Edge};
pub(crate) use error::InFile;
pub use error::MeshError;
pub(crate) use facing::Facing;
pub use holes::Hole;
pub(crate) use normals::NormalLanes;
pub(crate) use obj_file::read_obj_surface;
pub use obj_file::{ObjFileError, Surface, read_obj_file};
pub(crate) use order::OrderInSpace;
pub(crate) use patches::Patches;
pub(crate) use positions::PositionSource;
use positions::{FiniteBounds, Numbered};
pub(crate) use roundness::Roundness;
use topology::RING_LENGTH;
pub use topology::Topology;

use crate::math::{Aabb, Pose, Scalar, Vector3};
use crate::memory;
use crate::simd::{LANE_COUNT, dispatch};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

/// A closed, manifold triangle surface with outward normals, at its positions of this step; or, made by
/// [`open`](Self::open), one with a border.
///
/// A clone shares the topology and has positions of its own. What is settled once for a mesh, such as which triangles a
/// patch joins and in which order contacts come, is settled by the positions at creation, its reference positions, and so
/// is the same for clones in whatever pose.
#[derive(Debug)]
pub struct Mesh<T: Scalar> {
    topology: Arc<Topology>,
    /// Under a pose, those of vertices that are not placed are NaN.
    positions: Vec<Vector3<T>>,
    aabb: Aabb<T>,
    stamp: u64,
    /// The pose that moves the reference positions, if one does.
    pose: Option<Pose>,
    /// The vertices placed since the pose was set.
    placed: Vec<u32>,
    /// All positions under the pose, once they have been asked for.
    all: OnceLock<Vec<Vector3<T>>>,
    /// How far apart the unknowns are that move its vertices, where the host has said so.
    told_spacing: Option<T>,
    carrier: Option<Carrier<T>>,
    /// Shared by clones.
    reference: Arc<Reference<T>>,
}

/// The unknowns that move a mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Carrier<T> {
    /// How far apart they are; 0 for a rigid body.
    pub(crate) spacing: T,
    pub(crate) are_vertices_nodes: bool,
}

/// A mesh as it was created.
#[derive(Debug, Default)]
struct Reference<T: Scalar> {
    positions: Vec<Vector3<T>>,
    /// Found when first asked for, like the patches, the order and the roundness.
    clusters: OnceLock<Clusters>,
    patches: OnceLock<Patches<T>>,
    /// The triangles, in an order that numbering does not change.
    triangles_in_space: OnceLock<Vec<u32>>,
    roundness: OnceLock<Roundness>,
    holes: Vec<Hole>,
}

impl<T: Scalar> Clone for Mesh<T> {
    fn clone(&self) -> Self {
        Self {
            topology: self.topology.clone(),
            positions: memory::listed(self.positions().iter().copied()),
            aabb: self.aabb,
            stamp: self.stamp,
            pose: None,
            placed: Vec::new(),
            all: OnceLock::new(),
            told_spacing: self.told_spacing,
            carrier: self.carrier,
            reference: self.reference.clone(),
        }
    }
}

/// A number that no positions have yet.
pub(crate) fn next_stamp() -> u64 {
    static NEXT_STAMP: AtomicU64 = AtomicU64::new(1);
    NEXT_STAMP.fetch_add(1, Ordering::Relaxed)
}

/// A vertex normal and the surface its vertex stands for.
#[derive(Clone, Copy, Debug)]
pub struct VertexNormal<T: Scalar> {
    /// Outward, of unit length: the mean of the surrounding triangles' normals, weighted by their areas.
    pub normal: Vector3<T>,
    /// One third of the surrounding triangles' areas.
    pub area: T,
}

impl<T: Scalar> Mesh<T> {
    /// Checks and copies a surface: `triangles` name the corners in `positions`, counter-clockwise seen from outside.
    /// Positions that no triangle uses are allowed.
    ///
    /// # Errors
    /// Every way in which the surface is not closed, manifold, consistently and outward oriented, without degenerate
    /// triangles and finite has its own [`MeshError`]. Each part that is connected across edges must face outward; one
    /// that faces inward is a cavity, and allowed, where it lies inside the others.
    pub fn new(positions: &[[T; 3]], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        Self::checked(positions, triangles, Border::Refused, Vec::new())
    }

    /// The same for a surface with holes, as scans have them. Each hole is closed by the triangles of least area over the
    /// vertices around it. These come behind the triangles that were given, and move with their vertices; no vertex is added.
    /// [`holes`](Self::holes) lists them. `most`: the part of the given area of each connected part that its caps may have
    /// together, from 0 to 1, so that no sheet is taken for a body; 0.1 suits scans.
    ///
    /// # Errors
    /// Those of [`new`](Self::new), but instead of [`MeshError::Open`] [`MeshError::Seam`], [`MeshError::HolesTouch`],
    /// [`MeshError::HoleTooLong`], [`MeshError::HoleTooLarge`], [`MeshError::HoleNotClosed`] and [`MeshError::CloseHoles`].
    pub fn closing_holes(positions: &[[T; 3]], triangles: &[[u32; 3]], most: f64) -> Result<Self, MeshError> {
        if !(0.0..=1.0).contains(&most) {
            return Err(MeshError::CloseHoles { value: most });
        }
        let mesh = Self::open(positions, triangles)?;
        if !mesh.is_open() {
            return Ok(mesh);
        }
        let (caps, holes) = holes::caps(&mesh.topology, &mesh.positions, &mesh.aabb, most)?;
        let all = memory::listed(triangles.iter().copied().chain(caps));
        Self::checked(positions, &all, Border::Refused, holes)
    }

    /// The same for a surface that may have a border: a floor, a wall, a piece of cloth. It is solid behind its triangles,
    /// where their normals do not point, as far as rays reach it; closed bodies collide with it there.
    ///
    /// What holds: a point of a closed body behind the sheet, whose inward ray leaves through the sheet before its own body,
    /// gives a contact; so does a point of the sheet inside the body. Against a flat sheet wider than the body the force
    /// is the law's, as long as the middle of the body is in front. What does not: an open mesh has no inside, so nothing
    /// is known of a point without such a ray. A body more than half behind is pushed less and less, and not at all when it
    /// is through or beyond the border; no edges are traced and the pair never escapes; two open meshes do not collide.
    /// All such pairs are counted ([`Statistics::open_pairs`](crate::contact::Statistics::open_pairs)).
    ///
    /// # Errors
    /// Those of [`new`](Self::new), but for [`MeshError::Open`]; [`MeshError::Inward`] and [`MeshError::Flat`] only for
    /// parts that are closed.
    pub fn open(positions: &[[T; 3]], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        Self::checked(positions, triangles, Border::Allowed, Vec::new())
    }

    fn checked(
        positions: &[[T; 3]],
        triangles: &[[u32; 3]],
        border: Border,
        holes: Vec<Hole>,
    ) -> Result<Self, MeshError> {
        let reference = memory::listed(positions.iter().map(|&position| position.into()));
        let mut mesh = Self {
            topology: memory::shared(Topology::new(positions.len(), triangles, border)?),
            positions: memory::filled(Vector3::zeros(), positions.len()),
            aabb: Aabb::empty(),
            stamp: 0,
            pose: None,
            placed: Vec::new(),
            all: OnceLock::new(),
            told_spacing: None,
            carrier: None,
            reference: memory::shared(Reference { positions: reference, holes, ..Reference::default() }),
        };
        mesh.place(positions, false)?;
        mesh.check_areas()?;
        mesh.check_orientation()?;
        Ok(mesh)
    }

    /// Renews the positions. Octrees of this mesh are stale from here on.
    ///
    /// # Errors
    /// [`MeshError::WrongCount`] and [`MeshError::NotFinite`]; the positions are then as before.
    pub fn set_positions(&mut self, positions: &[[T; 3]]) -> Result<(), MeshError> {
        self.place(positions, true)
    }

    /// [`set_positions`](Self::set_positions) from any layout: `position` is asked twice for each of `count` vertices.
    pub fn set_positions_with(
        &mut self,
        count: usize,
        position: impl Fn(usize) -> Vector3<T>,
    ) -> Result<(), MeshError> {
        self.place(&Numbered { count, position }, true)
    }

    /// [`set_positions`](Self::set_positions) from wherever they lie.
    pub(crate) fn set_positions_from(&mut self, positions: &impl PositionSource<T>) -> Result<(), MeshError> {
        self.place(positions, true)
    }

    fn place<P: PositionSource<T> + ?Sized>(&mut self, positions: &P, is_renewal: bool) -> Result<(), MeshError> {
        let count = positions.count();
        if count != self.positions.len() {
            return Err(MeshError::WrongCount { given: count, expected: self.positions.len() });
        }
        let (are_finite, aabb) = dispatch::<T, _>(FiniteBounds { positions });
        if !are_finite {
            let vertex = (0..count).find(|&vertex| !positions.position(vertex).iter().all(|x| x.is_finite()));
            return Err(MeshError::NotFinite { vertex: vertex.unwrap_or_default(), is_renewal });
        }
        let (blocks, rest) = self.positions.as_chunks_mut::<LANE_COUNT>();
        for (number, block) in blocks.iter_mut().enumerate() {
            *block = positions.block(number * LANE_COUNT).map(Vector3::from);
        }
        for (place, vertex) in rest.iter_mut().zip(count - count % LANE_COUNT..) {
            *place = positions.position(vertex).into();
        }
        self.leave_pose();
        // Vertices of no triangle must not widen the surface's box.
        let is_whole = self.topology.surface_vertices().len() == count;
        self.aabb = if is_whole { aabb } else { self.surface_box() };
        self.stamp = next_stamp();
        Ok(())
    }

    fn surface_box(&self) -> Aabb<T> {
        let mut aabb = Aabb::empty();
        for &vertex in self.topology.surface_vertices() {
            aabb.include(&self.positions[vertex as usize]);
        }
        aabb
    }

    /// Its triangles in an order that depends on its reference positions, and not on their numbers.
    pub(crate) fn triangles_in_space(&self) -> &[u32] {
        let Reference { positions, triangles_in_space, .. } = &*self.reference;
        triangles_in_space.get_or_init(|| OrderInSpace::new(&self.topology, positions).order)
    }

    /// Its triangles, cluster by cluster, by its reference positions.
    pub(crate) fn clusters(&self) -> &Clusters {
        let Reference { positions, clusters, .. } = &*self.reference;
        clusters.get_or_init(|| Clusters::new(&self.topology, positions))
    }

    /// Takes over clusters that were found for this mesh before; false where they cannot be its own.
    pub(crate) fn takes_clusters(&self, triangles: Vec<u32>, sizes: Vec<u8>) -> bool {
        let known = Clusters::known(&self.topology, triangles, sizes);
        known.map(|known| self.reference.clusters.get_or_init(|| known)).is_some()
    }

    /// Its patches, by its reference positions.
    pub(crate) fn patches(&self) -> &Patches<T> {
        let Reference { positions, patches, .. } = &*self.reference;
        patches.get_or_init(|| Patches::new(&self.topology, positions))
    }

    /// How round and how large it is, by its reference positions.
    pub(crate) fn roundness(&self) -> Roundness {
        *self.reference.roundness.get_or_init(|| roundness::roundness(&self.topology, &self.reference.positions))
    }

    /// Its volume over its area: half of a plate's thickness, a third of a ball's radius. Infinite for an open surface. By its
    /// reference positions, and by how much its area has grown since then.
    pub(crate) fn half_thickness(&self) -> T {
        T::of(self.roundness().half_thickness) * self.patches().growth(|triangle| self.corners(triangle)).sqrt()
    }

    /// The positions at creation.
    pub(crate) fn reference_positions(&self) -> &[Vector3<T>] {
        &self.reference.positions
    }

    /// Says how far apart the unknowns are that move its vertices, in m: 0 where the vertices are unknowns themselves, the
    /// distance between nodes where a cage carries it, infinity where nothing moves it. A rigid body need not be told. With
    /// [`Accuracy`](crate::contact::Sampling::Accuracy) the samples of a pair stand no closer to one another than the unknowns
    /// of the finer one of both. Where neither has 0, a contact's force acts on the triangles at its two ends alone. Where this
    /// mesh has it, its vertices bear what the other's rays bring as an even pressure on the areas of these does. A step then
    /// takes 1.5 to 9 times as long. A host that never calls this has 0 without that, or in a contact system what that knows.
    ///
    /// # Errors
    /// [`MeshError::CarrierSpacing`] where it is negative or NaN.
    pub fn set_carrier_spacing(&mut self, spacing: T) -> Result<(), MeshError> {
        if spacing.to_f64().is_nan() || spacing < T::zero() {
            return Err(MeshError::CarrierSpacing { value: spacing.to_f64() });
        }
        self.told_spacing = Some(spacing);
        Ok(())
    }

    /// Sets what moves the mesh unless the host has said so.
    pub(crate) fn carry_by(&mut self, carrier: Carrier<T>) {
        self.carrier = Some(carrier);
    }

    pub(crate) fn carrier_spacing(&self) -> T {
        self.told_spacing.or(self.carrier.map(|carrier| carrier.spacing)).unwrap_or(T::zero())
    }

    /// Whether the vertices are unknowns, so that it matters on which of them a load lies.
    pub(crate) fn are_vertices_nodes(&self) -> bool {
        let known = self.carrier.is_none_or(|carrier| carrier.are_vertices_nodes);
        self.told_spacing.map_or(known, |spacing| spacing == T::zero())
    }

    /// Whether the host or a contact system has said that.
    pub(crate) fn are_vertices_known_nodes(&self) -> bool {
        self.are_vertices_nodes() && (self.told_spacing.is_some() || self.carrier.is_some())
    }

    /// Triangles, neighbourhoods and vertices.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// The smallest box around the surface.
    pub fn aabb(&self) -> &Aabb<T> {
        &self.aabb
    }

    /// The three corners of a triangle.
    #[inline]
    pub fn corners(&self, triangle: u32) -> [Vector3<T>; 3] {
        let corners = self.topology.triangles()[triangle as usize];
        match &self.pose {
            None => corners.map(|vertex| self.positions[vertex as usize]),
            Some(pose) => self.corners_by(pose, corners),
        }
    }

    /// Outward, as long as twice the triangle's area.
    pub fn scaled_normal(&self, triangle: u32) -> Vector3<T> {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(&(c - a))
    }

    /// The holes that [`closing_holes`](Self::closing_holes) closed.
    pub fn holes(&self) -> &[Hole] {
        &self.reference.holes
    }

    /// Whether the surface has a border.
    pub fn is_open(&self) -> bool {
        self.topology.is_open()
    }

    /// The enclosed volume; without meaning where the surface is open.
    pub fn volume(&self) -> T {
        let base = self.aabb.lower;
        let six_fold = (0..self.topology.triangles().len() as u32).fold(T::zero(), |sum, triangle| {
            let [a, b, c] = self.corners(triangle).map(|corner| corner - base);
            sum + a.dot(&b.cross(&c))
        });
        six_fold / T::of(6.0)
    }

    /// A stamp that no other positions have, so that a stale octree is recognised.
    pub(crate) fn stamp(&self) -> u64 {
        self.stamp
    }

    /// The positions of vertices that are placed; those of others are NaN.
    pub(crate) fn placed_positions(&self) -> &[Vector3<T>] {
        &self.positions
    }

    pub(crate) fn shares_topology_with(&self, topology: &Arc<Topology>) -> bool {
        Arc::ptr_eq(&self.topology, topology)
    }

    pub(crate) fn shared_topology(&self) -> &Arc<Topology> {
        &self.topology
    }

    fn check_areas(&self) -> Result<(), MeshError> {
        for (triangle, &corners) in self.topology.triangles().iter().enumerate() {
            let normal = self.scaled_normal(triangle as u32);
            if normal == Vector3::zeros() {
                return Err(MeshError::DegenerateTriangle { triangle, corners });
            }
            if !normal.iter().all(|x| x.is_finite()) {
                return Err(MeshError::Overflow { triangle });
            }
        }
        Ok(())
    }
}
