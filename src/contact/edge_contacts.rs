use crate::contact::cast::Cast;
use crate::contact::list::ContactList;
use crate::contact::pair::Direction;
use crate::contact::point_pair::{Contact, ContactKind};
use crate::contact::quadrature::Sample;
use crate::contact::quadrature::edges::for_each_inside_stretch;
use crate::contact::quadrature::sampler::Starts;
use crate::contact::weigh::shares::CastLoad;
use crate::contact::workspace::Workspace;
use crate::math::{Scalar, cosine};
use crate::memory::Room;
use crate::mesh::Mesh;
use crate::simd::dispatch;

impl<T: Scalar> Direction<'_, T> {
    /// Adds the contacts of the edges that pierce the other mesh, from the middle of each stretch inside; gives how many
    /// such stretches there are, and the direction's load.
    ///
    /// A stretch stands for a strip of its length. A strip as wide as a third of the depth, times the tangent of half the angle
    /// between the faces, has the load of a sharp edge across another edge, whatever the angle between the two. For faces that
    /// hardly bend it would be wide, so no strip is wider than the middle is deep.
    pub(crate) fn cast_edges(&self, list: &mut ContactList<T>) -> (usize, CastLoad<T>) {
        let ContactList { contacts, statistics, workspace, .. } = list;
        let Workspace { samples, groups, vertices, marks, edge_sides, crossings, .. } = workspace;
        let first = contacts.len();
        let tracers = [self.pair.tracers[self.side], self.pair.tracers[1 - self.side]];
        samples.clear();
        for_each_inside_stretch(
            tracers,
            self.pair.region,
            (&mut groups[self.side], marks),
            (edge_sides, crossings),
            |sample, length| {
                samples.room_for(1).push(Sample { area: length, ..sample });
            },
        );
        let surface = dispatch::<T, _>(Cast {
            kind: ContactKind::Edge,
            direction: self,
            starts: Starts::Samples(samples),
            statistics,
            contacts,
            vertices,
            crossings,
        });
        let own = tracers[0].mesh();
        contacts[first..].iter_mut().for_each(|contact| contact.area *= width_of_strip(own, contact));
        (samples.len(), CastLoad::new(surface, &contacts[first..], self.pair.options.law))
    }
}

fn width_of_strip<T: Scalar>(own: &Mesh<T>, contact: &Contact<T>) -> T {
    // The sine and the cosine of half the angle between the faces.
    let sine = cosine(&own.scaled_normal(contact.p1.triangle), &-contact.direction);
    let cosine = (T::one() - sine * sine).max(T::zero()).sqrt();
    let third = T::one() / T::of(3.0);
    (contact.depth * (sine / cosine) * third).min(contact.depth * contact.cos_alpha)
}
