//! Contacts of a body with itself (Fig. 5 of the paper).
//!
//! A point of the surface lies inside another part of its body if the winding number just under it is more than 1, which is
//! its own body. The first exit along the inward ray is then the way out, as for two bodies, and an exit through the far side
//! of the point's own fold is refused (`self_contact/own_side.rs`), as for two bodies. So two lobes have the contacts that they
//! would have as two bodies, except that each carries half the load.

use crate::contact::list::ContactList;
use crate::contact::options::DetectionOptions;
use crate::contact::pair::Pair;
use crate::contact::point_pair::{Contact, ContactKind};
use crate::contact::quadrature::{Purpose, Sample, Sampling};
use crate::contact::weigh::{cos_alpha, make_contact};
use crate::contact::workspace::Workspace;
use crate::math::{Aabb, Scalar, margins};
use crate::memory::Room;
use crate::mesh::Mesh;
use crate::query::{Octree, OctreeError, Tracer, way_out, winding_number};
use crate::self_contact::{SelfWarmStart, SelfWorkspace, is_collapsed};
use crate::triangle::{Hit, Ray};

/// Finds the contacts between parts of one mesh, body 0, in place of those in `contacts`. Of the options only the sampling
/// counts; an accuracy is one ray for each triangle.
///
/// Rays start where the surface touches others of its triangles, and where it winds around more than once: if it touches
/// itself nowhere, at no more than one point of each connected part. A scene also remembers that from step to step. An
/// open mesh has no inside, and so no contacts with itself; it is counted. Nor has a tangled one
/// ([`Statistics::tangled_bodies`](crate::contact::Statistics::tangled_bodies)).
///
/// # Errors
/// [`OctreeError`] where the octree is stale or another mesh's; `contacts` is then as before.
pub fn query_self<T: Scalar>(
    mesh: &Mesh<T>,
    octree: &Octree<T>,
    options: &DetectionOptions<T>,
    contacts: &mut ContactList<T>,
) -> Result<(), OctreeError> {
    let tracer = octree.tracer(mesh)?;
    contacts.refill(|contacts| detect_self(0, tracer, octree, options, None, contacts));
    Ok(())
}

/// [`query_self`] by casting every ray: slow, for comparison. The contacts are the same to the bit, but for
/// those of a tangled body, which this finds however long it takes.
///
/// # Errors
/// As [`query_self`].
pub fn query_self_with_all_rays<T: Scalar>(
    mesh: &Mesh<T>,
    octree: &Octree<T>,
    options: &DetectionOptions<T>,
    contacts: &mut ContactList<T>,
) -> Result<(), OctreeError> {
    let tracer = octree.tracer(mesh)?;
    contacts.clear();
    if mesh.is_open() {
        contacts.statistics.open_bodies += 1;
        return Ok(());
    }
    let body = Body { number: 0, tracer, options };
    if body.trace(false, contacts) {
        contacts.workspace.own.touching.search_all(octree, mesh);
    }
    body.add_contacts(contacts);
    Ok(())
}

/// Adds the contacts between parts of one body to `contacts`; gives whether the body may overlap itself. `memory` is what
/// the body remembers from step to step, `tracer` that of `octree`.
pub(crate) fn detect_self<T: Scalar>(
    body: u32,
    tracer: Tracer<'_, T>,
    octree: &Octree<T>,
    options: &DetectionOptions<T>,
    mut memory: Option<&mut SelfWarmStart<T>>,
    contacts: &mut ContactList<T>,
) -> bool {
    let mesh = tracer.mesh();
    if mesh.is_open() {
        contacts.statistics.open_bodies += 1;
        return false;
    }
    if memory.as_deref_mut().is_some_and(|memory| memory.is_clear(mesh, octree)) {
        return false;
    }
    if is_collapsed(mesh) {
        return false;
    }
    let ContactList { statistics, workspace, .. } = &mut *contacts;
    let SelfWorkspace { touching, culling, .. } = &mut workspace.own;
    match memory.as_deref_mut() {
        Some(memory) => memory.search(octree, mesh, touching),
        None => touching.search(octree, mesh),
    }
    if touching.is_tangled {
        statistics.tangled_bodies += 1;
        return false;
    }
    let mut rays = 0;
    let is_any_wanted = culling.choose(&tracer, touching, &mut workspace.crossings, &mut rays);
    statistics.rays += rays;
    statistics.misses += rays;
    if is_any_wanted {
        if let Some(memory) = memory {
            memory.forget();
        }
        let body = Body { number: body, tracer, options };
        body.trace(true, contacts);
        body.add_contacts(contacts);
    }
    is_any_wanted
}

/// A body that may touch itself.
struct Body<'a, T: Scalar> {
    number: u32,
    tracer: Tracer<'a, T>,
    options: &'a DetectionOptions<T>,
}

impl<T: Scalar> Body<'_, T> {
    /// Leaves in the workspace the samples that lie inside another part of the body, their rays and where these lead out.
    /// Gives whether there are any.
    fn trace(&self, is_culled: bool, contacts: &mut ContactList<T>) -> bool {
        let mesh = self.tracer.mesh();
        let ContactList { statistics, workspace, .. } = contacts;
        workspace.rays.clear();
        workspace.hits.clear();
        let region = mesh.aabb();
        // The body's own box is no measure of an overlap: one ray for each triangle, unless the caller says how many.
        let overlap = match self.options.sampling {
            Sampling::Accuracy(_) => Aabb { lower: region.lower, upper: region.lower },
            _ => *region,
        };
        let largest = region.lower.amax().max(region.upper.amax());
        let region = &region.grown(largest * margins::margin(margins::SAMPLE_IN_BOX));
        let [groups, _] = &mut workspace.groups;
        self.tracer.groups_in(region, groups);
        if is_culled && self.options.sampling != Sampling::Vertices {
            // Vertices may be wanted for a triangle of another group.
            groups.retain(|&group| {
                let mut is_any_wanted = false;
                let wanted = &workspace.own.culling.is_wanted;
                self.tracer.triangles_of(group, |triangle| is_any_wanted |= wanted[triangle as usize]);
                is_any_wanted
            });
        }
        let (bodies, tracers) = ([self.number; 2], [&self.tracer; 2]);
        Pair::new(bodies, tracers, [&overlap, region], self.options).collect(0, Purpose::Rays, workspace);
        let Workspace { samples, rays, hits, crossings, own, .. } = workspace;
        let wanted = &own.culling.is_wanted;
        let is_wanted = |sample: &Sample<T>| {
            let ([first, second, _], own) = (sample.point.touched(), std::slice::from_ref(&sample.point.triangle));
            let triangles = if first == second { mesh.topology().triangles_around(first) } else { own };
            !is_culled || triangles.iter().any(|&triangle| wanted[triangle as usize])
        };
        samples.retain(|sample| {
            if !is_wanted(sample) {
                return false;
            }
            statistics.rays += 1;
            let ray = Ray::new(sample.point.position, -sample.normal);
            let number = winding_number(&self.tracer, &ray, sample.point.touched(), crossings);
            let Some(&hit) = way_out(crossings).filter(|_| number > 1) else {
                statistics.misses += 1;
                return false;
            };
            rays.room_for(1).push(ray);
            hits.room_for(1).push(Some(hit));
            true
        });
        !samples.is_empty()
    }

    /// Turns the ways out in the workspace into contacts, but for those through the far side of the point's own fold.
    fn add_contacts(&self, contacts: &mut ContactList<T>) {
        let topology = self.tracer.mesh().topology();
        let ContactList { contacts, statistics, workspace, .. } = contacts;
        let SelfWorkspace { touching, folds, .. } = &mut workspace.own;
        if workspace.samples.is_empty() {
            return;
        }
        folds.reset(topology);
        for (sample, hit) in workspace.samples.iter().zip(&workspace.hits) {
            folds.add(sample.point.touched());
            hit.iter().for_each(|hit| folds.add(topology.triangles()[hit.triangle as usize]));
        }
        if self.options.sampling == Sampling::Vertices {
            folds.join_along_edges(topology);
        }
        folds.join(topology, touching);
        for ((sample, ray), hit) in workspace.samples.iter().zip(&workspace.rays).zip(&workspace.hits) {
            let Some(hit) = hit else { continue };
            if folds.are_one(sample.point.touched(), topology.triangles()[hit.triangle as usize]) {
                statistics.own_surface_hits += 1;
            } else {
                statistics.self_contacts += 1;
                contacts.room_for(1).push(self.contact(sample, ray, hit));
            }
        }
    }

    fn contact(&self, sample: &Sample<T>, ray: &Ray<T>, hit: &Hit<T>) -> Contact<T> {
        let mesh = self.tracer.mesh();
        // Both folds cast.
        let sample = Sample { area: sample.area * T::of(0.5), ..*sample };
        let cos_alpha = cos_alpha(mesh, hit.triangle, &ray.direction);
        make_contact(ContactKind::Ray, [self.number; 2], &sample, ray.direction, mesh, hit, cos_alpha)
    }
}
