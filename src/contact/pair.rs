use super::cutter::{Cutter, part_of_rays};
use super::direction::Direction;
use super::distance::ContactLaw;
use super::escape::{choose_direction, push_apart};
use super::load::{fixed_shares, share_load};
use super::memory::{PairMemory, Progress};
use super::samples::Sampling;
use super::{Contact, ContactKind, ContactList, Statistics};
use crate::math::{Aabb, Scalar, Vector3, direction};
use crate::memory;
use crate::mesh::Mesh;
use crate::octree::{Octree, OctreeError, Tracer};
use crate::ray::Ray;

/// How contacts are found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DetectionOptions<T: Scalar> {
    /// What forces grow with. Default: the distance to the other body's surface.
    pub law: ContactLaw,
    /// Where rays start.
    pub sampling: Sampling<T>,
    /// Whether edges are traced too where no ray settles whether the bodies overlap. Default: yes.
    pub edges: bool,
    /// Whether a pair whose contacts cannot part it is pushed along one direction, in a scene until it is apart. Default:
    /// yes.
    pub escape: bool,
    /// Whether rays go past other folds of either body, as the winding number tells: a ray that meets its own body first is
    /// refused only where it has left the body altogether, and one that enters another fold of the other body on its way
    /// out of it is not taken for one from outside. For bodies that overlap themselves; a scene does so by itself for those
    /// whose self-collision is switched on. Default: no.
    pub past_folds: bool,
}

impl<T: Scalar> Default for DetectionOptions<T> {
    fn default() -> Self {
        Self { law: ContactLaw::default(), sampling: Sampling::default(), edges: true, escape: true, past_folds: false }
    }
}

impl<T: Scalar> DetectionOptions<T> {
    /// Just what the paper does: rays from the vertices, both filters, its law, nothing else.
    pub fn paper() -> Self {
        let (law, sampling) = (ContactLaw::RayLength, Sampling::Vertices);
        Self { law, sampling, edges: false, escape: false, past_folds: false }
    }
}

/// Finds the contacts between two meshes, both ways; body 0 is `a`, body 1 is `b`. Replaces what `contacts` held.
/// Nothing is remembered from query to query: a pair escapes only where it has no other contact, in a direction chosen
/// anew by each query.
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
    contacts.refill(|contacts| detect_pair([0, 1], [&a, &b], options, None, true, contacts));
    Ok(())
}

/// Adds the contacts between two bodies, both ways, to `contacts`: Algorithm 1 of Hermann, Faure and Raffin 2008, and
/// what `options` add to it. `memory` is what the pair remembers from step to step; without it a pair escapes only where
/// it has no other contact, in a direction chosen anew each time. A pair that may not escape is counted where it would.
pub fn detect_pair<T: Scalar>(
    bodies: [u32; 2],
    tracers: [&Tracer<'_, T>; 2],
    options: &DetectionOptions<T>,
    memory: Option<&mut PairMemory<T>>,
    may_escape: bool,
    contacts: &mut ContactList<T>,
) {
    detect_pair_among(0, bodies, tracers, options, memory, may_escape, contacts);
}

/// [`detect_pair`] of two bodies that both meet at least `neighbours` others.
pub(crate) fn detect_pair_among<T: Scalar>(
    neighbours: u32,
    bodies: [u32; 2],
    tracers: [&Tracer<'_, T>; 2],
    options: &DetectionOptions<T>,
    memory: Option<&mut PairMemory<T>>,
    may_escape: bool,
    contacts: &mut ContactList<T>,
) {
    let meshes = tracers.map(|tracer| tracer.mesh());
    let boxes = meshes.map(|mesh| mesh.aabb());
    if boxes[0].intersection(boxes[1]).is_empty() {
        return;
    }
    contacts.statistics.pairs += 1;
    let is_open = meshes.map(Mesh::is_open);
    contacts.statistics.open_pairs += u64::from(is_open != [false; 2]);
    // What is behind a sheet lies outside its box: there a closed body's own box bounds all its contacts.
    let (overlap, region) = match is_open {
        [false, false] => overlap_region(boxes[0], boxes[1]),
        [true, false] => overlap_region(boxes[1], boxes[1]),
        [false, true] => overlap_region(boxes[0], boxes[0]),
        [true, true] => return,
    };
    let part_of_rays = match options.sampling {
        Sampling::Automatic | Sampling::Tolerance(_) => part_of_rays(neighbours),
        Sampling::Spacing(_) | Sampling::Vertices => T::one(),
    };
    contacts.statistics.crowded_pairs += u64::from(part_of_rays < T::one());
    let (overlap, region) = (&overlap, &region);
    let pair = Pair { may_escape, part_of_rays, ..Pair::new(bodies, tracers, [overlap, region], options) };
    match memory {
        _ if is_open != [false; 2] => pair.cast_both_ways(contacts),
        Some(memory) if options.escape => pair.detect_or_escape(memory, contacts),
        memory => {
            // What was remembered may long be over when escapes are switched on again.
            memory.into_iter().for_each(|memory| *memory = PairMemory::default());
            pair.detect_without_memory(contacts);
        }
    }
}

/// The overlap box of two boxes, and the same with a margin: points on a face of one mesh that lies on the overlap box's
/// own face must not fall outside by rounding.
pub(crate) fn overlap_region<T: Scalar>(a: &Aabb<T>, b: &Aabb<T>) -> (Aabb<T>, Aabb<T>) {
    let overlap = a.intersection(b);
    let largest = overlap.lower.amax().max(overlap.upper.amax());
    (overlap, overlap.grown(largest * T::ROUNDING_UNIT * T::of(8.0)))
}

/// How far beyond an overlap box the nearest points of the surface mostly lie, as a part of the box's shortest side.
const BEYOND_OVERLAP: f64 = 0.5;

/// Where most rays end, and most distances, of a pair with these boxes.
pub(crate) fn reach_region<T: Scalar>(a: &Aabb<T>, b: &Aabb<T>, law: ContactLaw) -> Aabb<T> {
    let (overlap, region) = overlap_region(a, b);
    match law {
        ContactLaw::Pressure => region.grown((overlap.upper - overlap.lower).min() * T::of(BEYOND_OVERLAP)),
        ContactLaw::RayLength => region,
    }
}

/// Two bodies whose boxes overlap.
#[derive(Clone, Copy)]
pub(super) struct Pair<'a, T: Scalar> {
    pub(super) bodies: [u32; 2],
    pub(super) tracers: [&'a Tracer<'a, T>; 2],
    pub(super) overlap: &'a Aabb<T>,
    /// The overlap box with a margin.
    pub(super) region: &'a Aabb<T>,
    pub(super) options: &'a DetectionOptions<T>,
    pub(super) may_escape: bool,
    /// Triangles are joined to patches of at most this area; `None`: each casts for itself.
    pub(super) patch_area: Option<T>,
    /// Of the rays on the overlap box's largest face.
    pub(super) part_of_rays: T,
    /// Where the rays of either body end.
    pub(super) ray_regions: [Aabb<T>; 2],
    /// Whether rays count only that leave the other body before their own.
    pub(super) hides_behind_own_surface: bool,
    /// What either direction carries of the load; `None`: as its contacts tell.
    pub(super) fixed_shares: Option<[T; 2]>,
}

/// What a step's contacts leave open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    /// Contacts tell all, or there is no overlap.
    Settled,
    /// Points lie inside the other body without a way out through their own.
    Targetless,
}

impl<'a, T: Scalar> Pair<'a, T> {
    /// Two bodies with their overlap box, as it is and with a margin.
    pub(super) fn new(
        bodies: [u32; 2],
        tracers: [&'a Tracer<'a, T>; 2],
        [overlap, region]: [&'a Aabb<T>; 2],
        options: &'a DetectionOptions<T>,
    ) -> Self {
        let meshes = tracers.map(|tracer| tracer.mesh());
        // Behind a sheet there is no telling whether a point is inside, but by its own body.
        let hides_behind_own_surface = options.law == ContactLaw::RayLength || meshes.iter().any(|mesh| mesh.is_open());
        // A ray that leaves its own body first may end outside that body's box.
        let ray_regions = if hides_behind_own_surface {
            [*region; 2]
        } else {
            [1, 0].map(|side| overlap_region(meshes[side].aabb(), meshes[side].aabb()).1)
        };
        // A coarse flat body casts nothing from its corners: there each direction has to make up for the other.
        let is_fixed = !hides_behind_own_surface && options.sampling != Sampling::Vertices;
        let fixed_shares = is_fixed.then(|| fixed_shares(meshes.map(Mesh::roundness)));
        let patch_area = options.sampling.patch_area();
        let (may_escape, part_of_rays) = (true, T::one());
        Self {
            bodies,
            tracers,
            overlap,
            region,
            options,
            may_escape,
            patch_area,
            part_of_rays,
            ray_regions,
            hides_behind_own_surface,
            fixed_shares,
        }
    }
}

impl<T: Scalar> Pair<'_, T> {
    /// Overlaps that give no contact otherwise are still reported, by the escape of this step.
    fn detect_without_memory(&self, contacts: &mut ContactList<T>) {
        let start = contacts.len();
        let outcome = self.detect(contacts);
        let unreported = outcome == Outcome::Targetless && contacts.len() == start;
        if unreported && self.options.escape {
            self.start_to_escape(start, contacts);
        }
    }

    fn detect_or_escape(&self, memory: &mut PairMemory<T>, contacts: &mut ContactList<T>) {
        if let Some(away) = memory.escape.filter(|_| self.may_escape) {
            self.go_on_escaping(away, memory, contacts);
            return;
        }
        memory.escape = None;
        let start = contacts.len();
        let outcome = self.detect(contacts);
        if outcome == Outcome::Settled && contacts.len() == start {
            *memory = PairMemory::default();
            return;
        }
        // So that the step in which their depth is asked for allocates no more than others.
        contacts.workspace.reserve(contacts.len() - start);
        // Near edges, points without a target belong to ordinary contact: alone they tell nothing.
        let targetless = outcome == Outcome::Targetless;
        let stuck = match memory.observe(self.bodies[0], &contacts.contacts[start..]) {
            _ if contacts.len() == start => targetless,
            Progress::OneWay => false,
            Progress::Balanced => targetless || self.any_passes_its_own(start, contacts),
            Progress::Slow => targetless || self.any_leaves_own(start, T::of(2.0), contacts),
            Progress::Jammed => true,
        };
        if stuck && let Some(away) = self.start_to_escape(start, contacts) {
            memory.start_to_escape(away);
        }
    }

    /// A direction is kept until the pair is apart. Where others hold it fast, it turns to the line of centres: all that
    /// do can go their ways at once, since spreading all bodies from one point satisfies them all.
    fn go_on_escaping(&self, away: Vector3<T>, memory: &mut PairMemory<T>, contacts: &mut ContactList<T>) {
        let Some(depth) = push_apart(self, &away, contacts) else {
            *memory = PairMemory::default();
            return;
        };
        contacts.statistics.escaping_pairs += 1;
        if memory.observe_escape(depth) {
            memory.start_to_escape(self.line_of_centres());
            contacts.statistics.escapes_turned += 1;
        }
    }

    /// Replaces the pair's contacts, those from `start` on, by the first of its escape.
    fn start_to_escape(&self, start: usize, contacts: &mut ContactList<T>) -> Option<Vector3<T>> {
        if !self.may_escape {
            contacts.statistics.escapes_forbidden += 1;
            return None;
        }
        let away = choose_direction(self, contacts)?;
        let ContactList { contacts: found, statistics, .. } = &mut *contacts;
        let edges = found[start..].iter().filter(|contact| contact.kind == ContactKind::Edge).count();
        statistics.edge_contacts -= edges as u64;
        statistics.replaced += (found.len() - start) as u64;
        found.truncate(start);
        contacts.statistics.escapes_started += 1;
        contacts.statistics.escaping_pairs += 1;
        push_apart(self, &away, contacts);
        Some(away)
    }

    /// Adds the contacts of the rays of both directions, or else those of the edges.
    fn detect(&self, contacts: &mut ContactList<T>) -> Outcome {
        let start = contacts.len();
        let own_before = contacts.statistics.own_surface_hits;
        self.cast_both_ways(contacts);
        let settled = contacts.len() > start || contacts.statistics.own_surface_hits > own_before;
        let mut stretches = 0;
        if self.options.edges && !settled {
            stretches = self.cast_edges(contacts);
            contacts.statistics.edge_contacts += (contacts.len() - start) as u64;
        }
        let targetless =
            contacts.statistics.own_surface_hits > own_before || (stretches > 0 && contacts.len() == start);
        let nothing = contacts.len() == start && !targetless;
        if targetless || (self.options.escape && nothing && self.one_contains_the_other(&mut contacts.statistics)) {
            Outcome::Targetless
        } else {
            Outcome::Settled
        }
    }

    /// What cuts the bodies' triangles; `None` where rays start at vertices.
    pub(super) fn cutter(&self) -> Option<Cutter<'_, T>> {
        let cutter = Cutter::new(self.options.sampling, self.overlap, self.region);
        cutter.map(|cutter| cutter.with_part_of_rays(self.part_of_rays))
    }

    fn cast_both_ways(&self, contacts: &mut ContactList<T>) {
        for (tracer, groups) in self.tracers.iter().zip(&mut contacts.workspace.groups) {
            tracer.groups_in(self.region, groups);
        }
        match self.options.sampling {
            Sampling::Tolerance(tolerance) => self.cast_to_tolerance(tolerance, contacts),
            _ => self.cast_samples(contacts),
        }
    }

    /// Adds the contacts of the edges of both bodies; gives how many stretches of edges lie inside.
    fn cast_edges(&self, contacts: &mut ContactList<T>) -> usize {
        let start = contacts.len();
        let mut middle = start;
        let [first, second] = [0, 1].map(|side| {
            middle = contacts.len();
            Direction { pair: self, side }.cast_edges(contacts)
        });
        share_load(&[first.1, second.1], &mut contacts.contacts[start..], middle - start);
        first.0 + second.0
    }

    /// Where no surface crosses the other, either body lies inside or outside the other as a whole, and one point of it
    /// tells which.
    fn one_contains_the_other(&self, statistics: &mut Statistics) -> bool {
        [0, 1].into_iter().any(|side| {
            let (inner, outer) = (self.tracers[side].mesh(), self.tracers[1 - side].mesh());
            let vertex = inner.topology().surface_vertices()[0];
            let ray = Ray::new(inner.positions()[vertex as usize], Vector3::z());
            let may_contain = outer.aabb().intersection(inner.aabb()) == *inner.aabb();
            statistics.estimate_rays += u64::from(may_contain);
            may_contain && self.tracers[1 - side].nearest_hit(&ray).is_some_and(|hit| hit.is_exit)
        })
    }

    /// Whether any contact's ray leaves its own body before the other.
    fn any_passes_its_own(&self, start: usize, contacts: &mut ContactList<T>) -> bool {
        !self.hides_behind_own_surface && self.any_leaves_own(start, T::one(), contacts)
    }

    /// Whether any contact's ray leaves its own body within so many times its depth.
    fn any_leaves_own(&self, start: usize, factor: T, contacts: &mut ContactList<T>) -> bool {
        let ContactList { contacts, workspace, statistics, .. } = contacts;
        let longer = |contact: &Contact<T>| Ray {
            origin: contact.p1.position,
            direction: contact.direction,
            t_max: contact.depth * factor,
        };
        [0, 1].into_iter().any(|side| {
            let own = || contacts[start..].iter().filter(|contact| contact.colliding == self.bodies[side]);
            workspace.rays.clear();
            memory::append(&mut workspace.rays, own().map(longer));
            workspace.touched.clear();
            memory::append(&mut workspace.touched, own().map(|contact| contact.p1.touched()));
            statistics.estimate_rays += workspace.rays.len() as u64;
            self.tracers[side].leave_before_end(&workspace.rays, &workspace.touched, &mut workspace.hidden);
            workspace.hidden.contains(&true)
        })
    }

    /// From the middle of the second body's box to that of the first; where they are the same, along an axis.
    pub(super) fn line_of_centres(&self) -> Vector3<T> {
        let [first, second] = self.tracers.map(|tracer| tracer.mesh().aabb().centre());
        direction(&(first - second)).unwrap_or_else(|| self.of_first(Vector3::x()))
    }

    /// The direction of the pair's first body where the body that comes first in space has this one. Where one way is as
    /// good as its opposite, bodies that change their numbers thus go the same ways; and as all pairs share the order, no
    /// three bodies of a pile chase one another in a circle. Boxes are compared by their corners, the same boxes by number.
    pub(super) fn of_first(&self, away: Vector3<T>) -> Vector3<T> {
        let [first, second] = self.tracers.map(|tracer| {
            let Aabb { lower, upper } = tracer.mesh().aabb();
            [lower.x, lower.y, lower.z, upper.x, upper.y, upper.z]
        });
        let is_first = if first == second { self.bodies[0] < self.bodies[1] } else { first < second };
        if is_first { away } else { -away }
    }

    /// The ray from a point of one body along which it leaves the other, when its first body goes `away`.
    pub(super) fn ray_out(&self, side: usize, origin: Vector3<T>, away: &Vector3<T>) -> Ray<T> {
        let other = self.tracers[1 - side].mesh().aabb();
        let largest = other.lower.amax().max(other.upper.amax());
        let ray = Ray::new(origin, if side == 0 { *away } else { -away });
        ray.until(ray.exit_from(&other.grown(largest * T::ROUNDING_UNIT * T::of(8.0))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::test_contact::{self, boxes};

    fn with_pair<R>(meshes: [&Mesh<f64>; 2], ask: impl FnOnce(&Pair<'_, f64>) -> R) -> R {
        test_contact::with_pair(meshes, &DetectionOptions { edges: true, ..DetectionOptions::paper() }, ask)
    }

    /// Of either bar the two long edges that lie in the other, and the diagonal between them.
    #[test]
    fn stretches_of_edges_of_both_bodies_are_counted() {
        let bars = [[[-1.0, -0.1, -0.1], [1.0, 0.1, 0.1]], [[-0.09, -1.0, 0.03], [0.13, 1.0, 0.27]]];
        let [first, second] = bars.map(|bar| boxes(&[bar]));
        let stretches = with_pair([&first, &second], |pair| pair.cast_edges(&mut ContactList::default()));
        assert_eq!(stretches, 6);
        // The contacts of all pairs in the list.
        let mut contacts = ContactList::default();
        for found in 1..=3 {
            with_pair([&first, &second], |pair| {
                assert_eq!(pair.detect(&mut contacts), Outcome::Settled);
            });
            let count = contacts.statistics.edge_contacts;
            assert!(count > 0 && count == contacts.len() as u64 && count % found == 0, "{count}");
        }
    }

    #[test]
    fn the_line_of_centres_leads_to_the_first_body() {
        let around = |[x, y, z]: [f64; 3]| boxes(&[[[x - 1.0, y - 2.0, z - 0.5], [x + 1.0, y + 2.0, z + 0.5]]]);
        let line = |first, second| with_pair([&around(first), &around(second)], |pair| pair.line_of_centres());
        assert_eq!(line([1.0, 2.0, 3.0], [4.0, 6.0, 3.0]), Vector3::new(-0.6, -0.8, 0.0));
        assert_eq!(line([1.0, 2.0, 3.0], [1.0, 2.0, 2.0]), Vector3::z());
        assert_eq!(line([1.0, 2.0, 3.0], [1.0, 2.0, 3.0]), Vector3::x());
    }
}
