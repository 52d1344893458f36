use super::cast::Cast;
use super::contact::ContactKind;
use super::list::ContactList;
use super::pair::Direction;
use super::sample::{Starts, for_each_inside_stretch};
use super::weigh::shares::CastLoad;
use super::workspace::Workspace;
use crate::math::{Scalar, dispatch};
use crate::memory::Room;

impl<T: Scalar> Direction<'_, T> {
    /// Adds the contacts of the edges that pierce the other mesh, from the middle of each stretch inside; gives how many
    /// such stretches there are, and the direction's load.
    pub(crate) fn cast_edges(&self, list: &mut ContactList<T>) -> (usize, CastLoad<T>) {
        let ContactList { contacts, statistics, workspace, .. } = list;
        let Workspace { samples, groups, vertices, pieces, edge_sides, crossings, .. } = workspace;
        let first = contacts.len();
        let mut load = CastLoad::default();
        let tracers = [self.pair.tracers[self.side], self.pair.tracers[1 - self.side]];
        samples.clear();
        for_each_inside_stretch(
            tracers,
            self.pair.region,
            [&mut groups[self.side], vertices],
            (edge_sides, crossings),
            |sample| {
                samples.room_for(1).push(sample);
            },
        );
        dispatch::<T, _>(Cast {
            kind: ContactKind::Edge,
            direction: self,
            starts: Starts::Samples(samples),
            surface: &mut load.surface,
            statistics,
            contacts,
            pieces,
            vertices,
            crossings,
        });
        load.add_contacts(&contacts[first..], self.pair.options.law);
        (samples.len(), load)
    }
}
