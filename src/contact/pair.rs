use super::load::{CastSurface, share_load};
use super::samples::{Sample, Sampling, for_each_sample};
use super::workspace::Workspace;
use super::{Contact, ContactList, Statistics, SurfacePoint};
use crate::math::{Aabb, Scalar, direction};
use crate::mesh::Mesh;
use crate::octree::{Octree, OctreeError, Tracer};
use crate::ray::{Hit, Ray};

/// How contacts are found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DetectionOptions<T: Scalar> {
    /// Where rays start.
    pub sampling: Sampling<T>,
}

impl<T: Scalar> DetectionOptions<T> {
    /// Just what the paper does: rays from the vertices.
    pub fn paper() -> Self {
        Self { sampling: Sampling::Vertices }
    }
}

/// Finds the contacts between two meshes, both ways; body 0 is `a`, body 1 is `b`. Replaces what `contacts` held.
///
/// # Errors
/// [`OctreeError`] where an octree is stale or another mesh's; `contacts` is then as before.
pub fn query_pair<T: Scalar>(
    a: &Mesh<T>,
    octree_a: &Octree<T>,
    b: &Mesh<T>,
    octree_b: &Octree<T>,
    options: &DetectionOptions<T>,
    contacts: &mut ContactList<T>,
) -> Result<(), OctreeError> {
    let (a, b) = (octree_a.tracer(a)?, octree_b.tracer(b)?);
    contacts.clear();
    detect_pair([0, 1], [&a, &b], options, contacts);
    Ok(())
}

/// Adds the contacts between two bodies, both ways, to `contacts`: Algorithm 1 of Hermann, Faure and Raffin 2008.
pub fn detect_pair<T: Scalar>(
    bodies: [u32; 2],
    tracers: [&Tracer<'_, T>; 2],
    options: &DetectionOptions<T>,
    contacts: &mut ContactList<T>,
) {
    let overlap = tracers[0].mesh().aabb().intersection(tracers[1].mesh().aabb());
    if overlap.is_empty() {
        return;
    }
    contacts.statistics.pairs += 1;
    // Points on a face of one mesh that lies on the overlap box's own face must not fall outside by rounding.
    let largest = overlap.lower.amax().max(overlap.upper.amax());
    let region = overlap.grown(largest * T::ROUNDING_UNIT * T::of(8.0));
    let start = contacts.len();
    let found = [(0, 1), (1, 0)].map(|(colliding, collided)| {
        let start = contacts.len();
        let surface = Detection {
            bodies: [bodies[colliding], bodies[collided]],
            colliding: tracers[colliding],
            collided: tracers[collided],
            overlap: &overlap,
            region: &region,
            sampling: options.sampling,
        }
        .run(contacts);
        (surface.claim(&contacts.contacts[start..]), contacts.len() - start)
    });
    let (first, second) = contacts.contacts[start..].split_at_mut(found[0].1);
    share_load(found.map(|(claim, _)| claim), [first, second]);
}

/// One direction of a pair.
struct Detection<'a, T: Scalar> {
    bodies: [u32; 2],
    colliding: &'a Tracer<'a, T>,
    collided: &'a Tracer<'a, T>,
    overlap: &'a Aabb<T>,
    /// The overlap box with its margin.
    region: &'a Aabb<T>,
    sampling: Sampling<T>,
}

impl<T: Scalar> Detection<'_, T> {
    fn run(&self, contacts: &mut ContactList<T>) -> CastSurface<T> {
        let ContactList { contacts, statistics, workspace } = contacts;
        let surface = self.cast(workspace, statistics);
        self.collided.nearest_hits(&workspace.rays, &mut workspace.hits);
        workspace.keep_exits(statistics);
        self.colliding.are_hit_before_end(&workspace.rays, &workspace.touched, &mut workspace.hidden);
        for (place, hit) in workspace.hits.iter().enumerate() {
            match hit {
                Some(hit) if !workspace.hidden[place] => {
                    contacts.push(self.contact(&workspace.samples[place], &workspace.rays[place], hit));
                }
                _ => statistics.own_surface_hits += 1,
            }
        }
        surface
    }

    /// Makes the ray of each sample inside the overlap box.
    fn cast(&self, workspace: &mut Workspace<T>, statistics: &mut Statistics) -> CastSurface<T> {
        let mut surface = CastSurface::nothing();
        let Workspace { samples, rays, .. } = workspace;
        samples.clear();
        rays.clear();
        statistics.without_normal +=
            for_each_sample(self.colliding.mesh(), self.overlap, self.region, self.sampling, |sample| {
                surface.add(&sample);
                rays.push(self.inward_ray(&sample));
                samples.push(sample);
            });
        statistics.rays += rays.len() as u64;
        surface
    }

    /// The ray, cut where it leaves the overlap box: p2 of an accepted contact lies on one body and inside the other,
    /// so in both boxes.
    fn inward_ray(&self, sample: &Sample<T>) -> Ray<T> {
        let origin = sample.point.position;
        let direction = -sample.normal;
        // A hit on the box's very face must not be lost to the rounding of either distance.
        let margin = self.overlap.reach_from(&origin) * T::ROUNDING_UNIT * T::of(64.0);
        let mut t_max = T::INFINITY;
        for axis in 0..3 {
            if direction[axis] > T::zero() {
                t_max = t_max.min((self.region.upper[axis] - origin[axis] + margin) / direction[axis]);
            } else if direction[axis] < T::zero() {
                t_max = t_max.min((self.region.lower[axis] - origin[axis] - margin) / direction[axis]);
            }
        }
        Ray { origin, direction, t_max }
    }

    fn contact(&self, sample: &Sample<T>, ray: &Ray<T>, hit: &Hit<T>) -> Contact<T> {
        let normal = direction(&self.collided.mesh().scaled_normal(hit.triangle));
        let cos_alpha = normal.map_or(T::zero(), |n| n.dot(&ray.direction).clamp(T::zero(), T::one()));
        Contact {
            colliding: self.bodies[0],
            collided: self.bodies[1],
            p1: sample.point,
            p2: SurfacePoint {
                triangle: hit.triangle,
                vertices: self.collided.mesh().topology().triangles()[hit.triangle as usize],
                weights: hit.weights,
                position: ray.origin + ray.direction * hit.t,
            },
            direction: ray.direction,
            depth: hit.t,
            cos_alpha,
            area: sample.area,
        }
    }
}
