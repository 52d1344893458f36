//! Whether the closed parts of a surface face outward. A part that faces inward is a cavity if it lies inside the others.
//! Elsewhere the winding number behind it would be negative, and bodies would be pushed the wrong way.

use super::winding::{self, Corners, WindingTree};
use super::{Mesh, MeshError};
use crate::math::{Aabb, Scalar, Vector3, margins};
use crate::memory::{self, Room};

/// Flush with the wall of another part the winding number is a half, and at its edges a quarter; both count as inside.
const LEAST_INSIDE: f64 = 0.2;

/// The volume within one closed part.
struct Volume {
    /// In units of the sides of the part's box, so that it neither overflows nor underflows.
    scaled: f64,
    /// How much of it may be rounding.
    rounding: f64,
    /// The sides of the box.
    sides: Vector3<f64>,
}

/// A closed part that faces inward.
struct InwardPart<'a> {
    triangles: &'a [u32],
    volume: Volume,
}

impl<T: Scalar> Mesh<T> {
    /// Whether its closed parts face outward.
    pub(super) fn check_orientation(&self) -> Result<(), MeshError> {
        if self.topology().components().len() == 1 {
            if self.is_open() {
                return Ok(());
            }
            let volume = Volume::new(self, 0..self.topology().triangles().len() as u32)?;
            return if volume.scaled > 0.0 { Ok(()) } else { Err(volume.refusal(0)) };
        }
        let (triangles, ends) = closed_parts(self);
        let mut start = 0;
        let mut inward = Vec::new();
        for &end in &ends {
            let own = &triangles[start..end];
            let volume = Volume::new(self, own.iter().copied())?;
            if volume.scaled < 0.0 {
                inward.room_for(1).push(InwardPart { triangles: own, volume });
            }
            start = end;
        }
        if inward.is_empty() { Ok(()) } else { check_cavities(self, &triangles, &inward) }
    }
}

/// The triangles of all closed parts, one part after the other, and where each ends.
fn closed_parts<T: Scalar>(mesh: &Mesh<T>) -> (Vec<u32>, Vec<usize>) {
    let topology = mesh.topology();
    let component_of = topology.component_of_triangles();
    let of = |triangle: u32| component_of[triangle as usize] as usize;
    // Three half-edges for each triangle; two for each edge that is no border.
    let mut border = memory::filled(0isize, topology.components().len());
    component_of.iter().for_each(|&component| border[component as usize] += 3);
    topology.edges().for_each(|edge| border[of(edge.triangles[0])] -= 2);
    let all = 0..topology.triangles().len() as u32;
    let mut triangles = memory::listed(all.filter(|&triangle| border[of(triangle)] == 0));
    triangles.sort_unstable_by_key(|&triangle| (of(triangle), triangle));
    let mut ends = Vec::new();
    let mut end = 0;
    for part in triangles.chunk_by(|&s, &t| of(s) == of(t)) {
        end += part.len();
        ends.room_for(1).push(end);
    }
    (triangles, ends)
}

fn corners<T: Scalar>(mesh: &Mesh<T>, triangle: u32) -> Corners {
    mesh.corners(triangle).map(|corner| corner.map(T::to_f64))
}

impl Volume {
    fn new<T: Scalar>(mesh: &Mesh<T>, triangles: impl Iterator<Item = u32> + Clone) -> Result<Self, MeshError> {
        let first = triangles.clone().next().unwrap_or_default() as usize;
        let mut aabb = Aabb::empty();
        for triangle in triangles.clone() {
            corners(mesh, triangle).iter().for_each(|corner| aabb.include(corner));
        }
        let sides = aabb.upper - aabb.lower;
        let units = sides.map(|side| if side > 0.0 { side } else { 1.0 });
        let (mut six_fold, mut magnitude) = (0.0, 0.0);
        for triangle in triangles {
            let [a, b, c] = corners(mesh, triangle).map(|corner| (corner - aabb.lower).component_div(&units));
            let term = a.dot(&b.cross(&c));
            six_fold += term;
            magnitude += term.abs();
        }
        if !f64::is_finite(six_fold) {
            return Err(MeshError::Overflow { triangle: first });
        }
        if six_fold == 0.0 {
            return Err(MeshError::Flat { triangle: first });
        }
        let rounding = margins::margin::<T>(margins::VOLUME).to_f64() * magnitude;
        Ok(Self { scaled: six_fold / 6.0, rounding, sides })
    }

    /// Why a part is refused that faces inward and has this triangle.
    fn refusal(&self, triangle: u32) -> MeshError {
        let triangle = triangle as usize;
        if self.scaled.abs() <= self.rounding {
            return MeshError::Flat { triangle };
        }
        MeshError::Inward { triangle, volume: self.scaled * self.sides.product() }
    }
}

impl InwardPart<'_> {
    /// The triangles that reach farthest along each axis: what sticks out of another part, if anything does.
    fn outermost<T: Scalar>(&self, mesh: &Mesh<T>) -> [u32; 6] {
        std::array::from_fn(|side| {
            let sign = if side < 3 { 1.0 } else { -1.0 };
            // Thirds, so that the sum does not overflow.
            let height = |triangle: u32| corners(mesh, triangle).iter().map(|p| p[side % 3] * sign / 3.0).sum::<f64>();
            let by_height = |&s: &u32, &t: &u32| height(s).total_cmp(&height(t));
            self.triangles.iter().copied().max_by(by_height).unwrap_or_default()
        })
    }
}

/// Whether all inward parts lie inside the others, by the outermost points of each.
fn check_cavities<T: Scalar>(mesh: &Mesh<T>, triangles: &[u32], inward: &[InwardPart<'_>]) -> Result<(), MeshError> {
    // In units of the mesh's size, so that lengths neither overflow nor underflow.
    let lower = mesh.aabb().lower.map(T::to_f64);
    let size = (mesh.aabb().upper.map(T::to_f64) - lower).max();
    let scaled = |triangle: u32| corners(mesh, triangle).map(|corner| (corner - lower) / size);
    let tree = WindingTree::new(memory::listed(triangles.iter().map(|&triangle| scaled(triangle))));
    for part in inward {
        let mut outermost = part.outermost(mesh);
        outermost.sort_unstable();
        for (place, &triangle) in outermost.iter().enumerate() {
            if place > 0 && outermost[place - 1] == triangle {
                continue;
            }
            let [a, b, c] = scaled(triangle);
            let point: Vector3<f64> = (a + b + c) / 3.0;
            let own: f64 = part.triangles.iter().map(|&own| winding::of_triangle(&scaled(own), &point)).sum();
            if tree.winding_number(&point) - own < LEAST_INSIDE {
                return Err(part.volume.refusal(triangle));
            }
        }
    }
    Ok(())
}
