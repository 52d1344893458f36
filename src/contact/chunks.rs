use super::cast::Cast;
use super::direction::Direction;
use super::load::CastSurface;
use super::samples::Sample;
use super::{Contact, ContactList, Statistics};
use crate::math::{Scalar, dispatch};
use crate::ray::Hit;

/// So many groups of vertices or triangles are cast from together. Chunks do not depend on the number of threads, and so
/// neither do the sums over them.
const GROUPS_IN_CHUNK: usize = 64;

/// What the rays of some groups found, where chunks are cast side by side.
#[derive(Clone, Debug, Default)]
pub(super) struct Chunk<T: Scalar> {
    surface: CastSurface<T>,
    statistics: Statistics,
    contacts: Vec<Contact<T>>,
    pieces: Vec<Sample<T>>,
    crossings: Vec<Hit<T>>,
}

impl<T: Scalar> Direction<'_, T> {
    /// Adds the contacts of the samples inside the overlap box.
    pub(super) fn cast_samples(&self, list: &mut ContactList<T>) {
        list.workspace.clear();
        self.pair.tracers[self.side].groups_in(self.pair.region, &mut list.workspace.groups);
        if list.workspace.helpers.are_there() && list.workspace.groups.len() > GROUPS_IN_CHUNK {
            self.cast_side_by_side(list);
        } else {
            self.cast_one_by_one(list);
        }
    }

    fn cast_one_by_one(&self, list: &mut ContactList<T>) {
        let ContactList { contacts, workspace, statistics, .. } = list;
        for groups in workspace.groups.chunks(GROUPS_IN_CHUNK) {
            let mut surface = CastSurface::default();
            let (pieces, crossings) = (&mut workspace.samples, &mut workspace.crossings);
            dispatch::<T, _>(Cast {
                direction: self,
                groups,
                surface: &mut surface,
                statistics,
                contacts,
                pieces,
                crossings,
            });
            workspace.surface.merge(&surface);
        }
    }

    fn cast_side_by_side(&self, list: &mut ContactList<T>) {
        let ContactList { contacts, workspace, statistics, .. } = list;
        let count = workspace.groups.len().div_ceil(GROUPS_IN_CHUNK);
        if workspace.chunks.len() < count {
            workspace.chunks.resize_with(count, Chunk::default);
        }
        let chunks = &mut workspace.chunks[..count];
        workspace.helpers.for_each(chunks, |place, chunk| {
            let first = place * GROUPS_IN_CHUNK;
            let groups = &workspace.groups[first..workspace.groups.len().min(first + GROUPS_IN_CHUNK)];
            (chunk.surface, chunk.statistics) = (CastSurface::default(), Statistics::default());
            chunk.contacts.clear();
            let Chunk { surface, statistics, contacts, pieces, crossings } = chunk;
            dispatch::<T, _>(Cast { direction: self, groups, surface, statistics, contacts, pieces, crossings });
        });
        for chunk in chunks {
            contacts.extend_from_slice(&chunk.contacts);
            *statistics += chunk.statistics;
            workspace.surface.merge(&chunk.surface);
        }
    }
}
