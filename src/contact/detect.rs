//! All contacts of a pair: by rays both ways, or by edges where rays find none; and whether they settle the overlap.

use crate::contact::list::ContactList;
use crate::contact::pair::{Direction, Pair};
use crate::contact::point_pair::Contact;
use crate::contact::weigh::shares::{scale_contacts, shares};
use crate::contact::workspace::Workspace;
use crate::math::{Scalar, Vector3};
use crate::memory;
use crate::query::way_out_past_folds;
use crate::self_contact::is_tangled_for_rays;
use crate::simd::LANE_COUNT;
use crate::threads::Helpers;
use crate::triangle::Ray;

/// A ray has two to three tiles of a body in order on its way. A body with no more than this many is not taken for tangled.
/// What chose the number: docs/architecture.md, *Tuned constants*.
const FEW_TILES: usize = 3;

/// What the contacts say of the overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// The contacts describe the overlap, or there is none.
    Settled,
    /// Points lie inside the other body, but their rays leave their own body first.
    Targetless,
}

impl<T: Scalar> Pair<'_, T> {
    /// Whether one of the bodies is tangled and the other's rays meet a large part of it. Their work would grow with the square
    /// of the triangles, and no inside is left to tell.
    pub(crate) fn is_tangled(&self, workspace: &mut Workspace<T>) -> bool {
        [0, 1].into_iter().any(|side| {
            let ([groups, met], other) = (&mut workspace.groups, self.tracers[1 - side]);
            other.mesh().topology().triangles().len() > FEW_TILES * LANE_COUNT && {
                let tiles = self.tracers[side].tiles_on_the_way(other, self.region, [groups, met]);
                tiles > FEW_TILES && is_tangled_for_rays(other.mesh(), tiles)
            }
        })
    }

    /// Adds the contacts of the rays of both directions, or else those of the edges.
    pub(crate) fn detect(&self, contacts: &mut ContactList<T>) -> Outcome {
        let start = contacts.len();
        let own_before = contacts.statistics.own_surface_hits;
        self.cast_both_ways(contacts);
        let settled = contacts.len() > start || contacts.statistics.own_surface_hits > own_before;
        let mut stretches = 0;
        if self.options.edges && !settled && self.tracers[0].may_meet(self.tracers[1], self.region) {
            stretches = self.cast_edges(contacts);
            contacts.statistics.edge_contacts += (contacts.len() - start) as u64;
        }
        let targetless =
            contacts.statistics.own_surface_hits > own_before || (stretches > 0 && contacts.len() == start);
        let nothing = contacts.len() == start && !targetless;
        if targetless || (self.options.escape && nothing && self.one_contains_the_other(contacts)) {
            Outcome::Targetless
        } else {
            Outcome::Settled
        }
    }

    /// Adds the contacts of the rays of both directions.
    pub(crate) fn cast_both_ways(&self, contacts: &mut ContactList<T>) {
        let Workspace { helpers, groups, sides, .. } = &mut contacts.workspace;
        let [first, second] = self.tracers;
        // Where there is nothing to leave out, handing over would take longer than the work.
        let take_long = first.leaves_out(second, self.region) && second.leaves_out(first, self.region);
        let helpers = if take_long { helpers } else { &Helpers::Nobody };
        let ([of_first, of_second], [first_sides, second_sides]) = (groups, sides);
        let mut both = [(0, of_first, first_sides), (1, of_second, second_sides)];
        helpers.for_each(&mut both, |_, (side, groups, sides)| {
            if self.casts(*side) {
                self.tracers[*side].groups_not_outside(self.tracers[1 - *side], self.region, groups, sides);
            } else {
                groups.clear();
            }
        });
        self.cast_samples(contacts);
    }

    /// Adds the contacts of the edges of both bodies; gives how many stretches of edges lie inside. Bodies without a share of
    /// the load cast only where no edge of the others lies inside.
    fn cast_edges(&self, contacts: &mut ContactList<T>) -> usize {
        let start = contacts.len();
        for carries in [true, false] {
            let mut middle = start;
            let [first, second] = [0, 1].map(|side| {
                middle = contacts.len();
                let casts = self.casts(side) == carries;
                if casts { Direction { pair: self, side }.cast_edges(contacts) } else { Default::default() }
            });
            if first.0 + second.0 > 0 {
                let fixed = self.fixed_shares.filter(|_| carries);
                let shares = fixed.unwrap_or_else(|| shares(&[first.1, second.1]));
                scale_contacts(shares, &mut contacts.contacts[start..], middle - start);
                return first.0 + second.0;
            }
        }
        0
    }

    /// Where no surface crosses the other, either body lies inside or outside the other as a whole, and one point of it
    /// tells which.
    fn one_contains_the_other(&self, contacts: &mut ContactList<T>) -> bool {
        let ContactList { statistics, workspace, .. } = contacts;
        [0, 1].into_iter().any(|side| {
            let (inner, outer) = (self.tracers[side].mesh(), self.tracers[1 - side].mesh());
            let vertex = inner.topology().surface_vertices()[0];
            let ray = Ray::new(inner.position(vertex), Vector3::z());
            let may_contain = outer.aabb().intersection(inner.aabb()) == *inner.aabb();
            statistics.estimate_rays += u64::from(may_contain);
            may_contain && way_out_past_folds(self.tracers[1 - side], &ray, &mut workspace.crossings).is_some()
        })
    }

    /// Whether any contact's ray leaves its own body before the other.
    pub(crate) fn any_passes_its_own(&self, start: usize, contacts: &mut ContactList<T>) -> bool {
        !self.hides_behind_own_surface && self.any_leaves_own(start, T::one(), contacts)
    }

    /// Whether any contact's ray leaves its own body within so many times its depth.
    pub(crate) fn any_leaves_own(&self, start: usize, factor: T, contacts: &mut ContactList<T>) -> bool {
        let ContactList { contacts, workspace, statistics, .. } = contacts;
        let longer = |contact: &Contact<T>| Ray {
            origin: contact.p1.position,
            direction: contact.direction,
            t_max: contact.depth * factor,
        };
        [0, 1].into_iter().any(|side| {
            let own = || contacts[start..].iter().filter(|contact| contact.colliding == self.bodies[side]);
            memory::refill(&mut workspace.rays, own().map(longer));
            memory::refill(&mut workspace.touched, own().map(|contact| contact.p1.touched()));
            statistics.estimate_rays += workspace.rays.len() as u64;
            self.tracers[side].leave_before_end(&workspace.rays, &workspace.touched, &mut workspace.hidden);
            workspace.hidden.contains(&true)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::options::DetectionOptions;
    use crate::contact::test_contact;
    use crate::mesh::Mesh;
    use crate::mesh::test_mesh::boxes;

    fn with_pair<R>(meshes: [&Mesh<f64>; 2], ask: impl FnOnce(&Pair<'_, f64>) -> R) -> R {
        test_contact::with_pair(meshes, &DetectionOptions { edges: true, ..DetectionOptions::paper() }, ask)
    }

    /// Of either bar the two long edges that lie in the other; the diagonal between them is no edge.
    #[test]
    fn stretches_of_edges_of_both_bodies_are_counted() {
        let bars = [[[-1.0, -0.1, -0.1], [1.0, 0.1, 0.1]], [[-0.09, -1.0, 0.03], [0.13, 1.0, 0.27]]];
        let [first, second] = bars.map(|bar| boxes(&[bar]));
        let stretches = with_pair([&first, &second], |pair| pair.cast_edges(&mut ContactList::default()));
        assert_eq!(stretches, 4);
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
}
