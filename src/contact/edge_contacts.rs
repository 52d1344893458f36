use super::distance::{ContactLaw, distance_over_depth};
use super::edges::for_each_inside_stretch;
use super::found::cos_alpha;
use super::load::CastLoad;
use super::pair::Direction;
use super::samples::Sample;
use super::{Contact, ContactKind, ContactList, SurfacePoint};
use crate::math::Scalar;
use crate::memory::Room;
use crate::ray::{Hit, Ray};

impl<T: Scalar> Direction<'_, T> {
    /// Adds the contacts of the edges that pierce the other mesh, from the middle of each stretch inside; gives how many
    /// such stretches there are, and the direction's load.
    pub(super) fn cast_edges(&self, contacts: &mut ContactList<T>) -> (usize, CastLoad<T>) {
        let first = contacts.len();
        let mut load = CastLoad::default();
        let workspace = &mut contacts.workspace;
        workspace.clear();
        let (samples, rays) = (&mut workspace.samples, &mut workspace.rays);
        let tracers = [self.pair.tracers[self.side], self.pair.tracers[1 - self.side]];
        let lists = [&mut workspace.groups[self.side], &mut workspace.vertices];
        for_each_inside_stretch(tracers, self.pair.region, lists, &mut workspace.crossings, |sample| {
            load.surface.add(&sample.normal, sample.area);
            rays.room_for(1).push(self.inward_ray(&sample));
            samples.room_for(1).push(sample);
        });
        let stretches = contacts.workspace.samples.len();
        self.filter(ContactKind::Edge, contacts);
        load.add_contacts(&contacts.contacts[first..], self.pair.options.law);
        (stretches, load)
    }

    /// Traces the rays and keeps those that pass both filters of the paper.
    fn filter(&self, kind: ContactKind, contacts: &mut ContactList<T>) {
        let ContactList { contacts, statistics, workspace, .. } = contacts;
        let [own, other] = [self.pair.tracers[self.side], self.pair.tracers[1 - self.side]];
        statistics.rays += workspace.rays.len() as u64;
        other.nearest_hits(&workspace.rays, &mut workspace.hits);
        if self.pair.options.past_folds {
            statistics.past_folds += workspace.follow_past_folds(other);
        }
        workspace.keep_exits(statistics);
        workspace.cut_at_hits();
        if self.pair.hides_behind_own_surface {
            own.leave_before_end(&workspace.rays, &workspace.touched, &mut workspace.hidden);
        } else {
            workspace.hidden.clear();
            workspace.hidden.room_for(workspace.rays.len()).resize(workspace.rays.len(), false);
        }
        if self.pair.options.past_folds {
            statistics.past_folds += workspace.uncover_past_folds(own);
        }
        for (place, hit) in workspace.hits.iter().enumerate() {
            match hit {
                Some(hit) if !workspace.hidden[place] => {
                    contacts.room_for(1).push(self.contact(
                        kind,
                        &workspace.samples[place],
                        &workspace.rays[place],
                        hit,
                    ));
                }
                _ => statistics.own_surface_hits += 1,
            }
        }
    }

    /// The ray, cut where it leaves the overlap box: p2 of an accepted contact lies on one body and inside the other,
    /// so in both boxes.
    fn inward_ray(&self, sample: &Sample<T>) -> Ray<T> {
        let ray = Ray::new(sample.point.position, -sample.normal);
        ray.until(ray.exit_from(&self.pair.ray_regions[self.side]))
    }

    fn contact(&self, kind: ContactKind, sample: &Sample<T>, ray: &Ray<T>, hit: &Hit<T>) -> Contact<T> {
        let other = self.pair.tracers[1 - self.side];
        let collided = other.mesh();
        let mut cos_alpha = cos_alpha(collided, hit.triangle, &ray.direction);
        // Past folds, the nearest surface may be an inner one.
        if self.pair.options.law == ContactLaw::Pressure && !self.pair.options.past_folds {
            cos_alpha = distance_over_depth(other, ray, hit, cos_alpha);
        }
        Contact {
            kind,
            piece: sample.piece,
            colliding: self.pair.bodies[self.side],
            collided: self.pair.bodies[1 - self.side],
            p1: sample.point,
            p2: SurfacePoint::of_hit(collided, ray, hit),
            direction: ray.direction,
            depth: hit.t,
            cos_alpha,
            area: sample.area,
        }
    }
}
