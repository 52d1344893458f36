use super::cutter::{RAYS_ON_LARGEST_FACE, largest_face};
use super::pair::Pair;
use super::{Contact, ContactList};
use crate::math::{LANE_COUNT, Scalar, Vector3, length};
use crate::octree::Tracer;

/// So many rays on the overlap box's largest face are the fewest that are tried; each further try has four times as many.
const FEWEST_RAYS: f64 = 32.0;
/// Where the overlap box meets fewer triangles, tries cost more than they save: all cast.
const FEWEST_TRIANGLES: usize = 4096;
/// Fewer contacts tell nothing of how good they are.
const FEWEST_CONTACTS: usize = 12;

/// The net force on the pair's first body and its torque about the middle of the overlap box, for unit stiffness.
#[derive(Clone, Copy)]
struct Load<T: Scalar> {
    force: Vector3<T>,
    torque: Vector3<T>,
}

impl<T: Scalar> Load<T> {
    fn of(pair: &Pair<'_, T>, contacts: &[Contact<T>]) -> Self {
        let middle = pair.overlap.centre();
        let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
        for contact in contacts {
            let pressure = contact.area * contact.depth * contact.cos_alpha;
            let on_first = if contact.colliding == pair.bodies[0] { pressure } else { -pressure };
            let [acts_at, push] = [contact.p1.position - middle, contact.direction * on_first];
            force += push;
            torque += acts_at.cross(&push);
        }
        Self { force, torque }
    }

    /// Whether the other differs by no more than the tolerance, torques over the overlap box's half diagonal.
    fn is_within(&self, tolerance: T, other: &Self, pair: &Pair<'_, T>) -> bool {
        let half_diagonal = length(&(pair.overlap.upper - pair.overlap.lower)) * T::of(0.5);
        let allowed = length(&self.force) * tolerance;
        length(&(self.force - other.force)) <= allowed
            && length(&(self.torque - other.torque)) <= allowed * half_diagonal
    }
}

impl<T: Scalar> Pair<'_, T> {
    /// Adds the contacts of as few rays as keep net force and torque within the tolerance: patches get smaller until two
    /// tries agree, or until no triangles are joined any more.
    pub(super) fn cast_to_tolerance(&self, tolerance: T, contacts: &mut ContactList<T>) {
        let (start, before) = (contacts.len(), contacts.statistics);
        let finest_cut = largest_face(self.overlap) / T::of(RAYS_ON_LARGEST_FACE);
        let mut area = largest_face(self.overlap) / T::of(FEWEST_RAYS);
        if self.triangles_at_most(contacts) < FEWEST_TRIANGLES {
            area = T::zero();
        }
        let mut last = None;
        let mut estimate_rays = 0;
        loop {
            let pair = Pair { patch_area: Some(area), ..*self };
            pair.both_ways(contacts, |direction, contacts| direction.cast_samples(contacts));
            let found = &contacts.contacts[start..];
            let load = Load::of(self, found);
            let is_good = last.is_some_and(|last| load.is_within(tolerance, &last, self));
            let is_finest = area <= finest_cut && contacts.statistics.patches == before.patches;
            if is_finest || (is_good && found.len() >= FEWEST_CONTACTS) {
                break;
            }
            // Where nothing is found yet, little is there to find, if anything: all rays look for it.
            area = if found.is_empty() { T::zero() } else { area / T::of(4.0) };
            last = Some(load);
            estimate_rays += contacts.statistics.rays - before.rays;
            contacts.contacts.truncate(start);
            contacts.statistics = before;
        }
        contacts.statistics.estimate_rays += estimate_rays;
    }

    /// How many triangles may lie in the overlap box, by whole groups.
    fn triangles_at_most(&self, contacts: &mut ContactList<T>) -> usize {
        let groups = &mut contacts.workspace.groups;
        let count = |tracer: &Tracer<'_, T>| {
            tracer.groups_in(self.region, groups);
            groups.len() * LANE_COUNT
        };
        self.tracers.into_iter().map(count).sum()
    }
}
