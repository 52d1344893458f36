use super::cast::{Cast, Starts};
use super::direction::Direction;
use super::load::CastSurface;
use super::samples::Sample;
use super::workspace::Workspace;
use super::{Contact, ContactList, Statistics};
use crate::math::{LANE_COUNT, Scalar, dispatch};
use crate::memory::{self, Room};
use crate::ray::Hit;

/// So many groups of vertices or triangles are cast from together. Chunks do not depend on the number of threads, and so
/// neither do the sums over them.
const GROUPS_IN_CHUNK: usize = 64;
/// The same of patches.
const PATCHES_IN_CHUNK: usize = GROUPS_IN_CHUNK * LANE_COUNT;

/// What the rays of some groups found, where chunks are cast side by side.
#[derive(Clone, Debug, Default)]
pub(super) struct Chunk<T: Scalar> {
    surface: CastSurface<T>,
    statistics: Statistics,
    contacts: Vec<Contact<T>>,
    pieces: Vec<Sample<T>>,
    crossings: Vec<Hit<T>>,
}

impl<'a> Starts<'a> {
    fn chunk_count(self) -> usize {
        match self {
            Self::Groups(groups) => groups.len().div_ceil(GROUPS_IN_CHUNK),
            Self::Patches(_, places) => places.len().div_ceil(PATCHES_IN_CHUNK),
        }
    }

    fn chunk(self, number: usize) -> Self {
        fn part(all: &[u32], number: usize, length: usize) -> &[u32] {
            &all[number * length..all.len().min((number + 1) * length)]
        }
        match self {
            Self::Groups(groups) => Self::Groups(part(groups, number, GROUPS_IN_CHUNK)),
            Self::Patches(standing, places) => Self::Patches(standing, part(places, number, PATCHES_IN_CHUNK)),
        }
    }
}

impl<T: Scalar> Direction<'_, T> {
    /// Adds the contacts of the samples inside the overlap box, whose groups the workspace holds.
    pub(super) fn cast_samples(&self, list: &mut ContactList<T>) {
        list.workspace.clear();
        let ContactList { contacts, workspace, statistics, .. } = list;
        let Workspace { helpers, chunks, groups, places, samples, crossings, surface, .. } = workspace;
        let groups = groups[self.side].as_slice();
        let standing = self.pair.patch_area.and_then(|area| self.pair.tracers[self.side].standing(area));
        let starts = match standing {
            Some(standing) => {
                places.clear();
                groups.iter().for_each(|&group| standing.add_places_in(group, places));
                Starts::Patches(standing, places)
            }
            None => Starts::Groups(groups),
        };
        let count = starts.chunk_count();
        if helpers.are_there() && count > 1 {
            if chunks.len() < count {
                chunks.room_for(count - chunks.len()).resize_with(count, Chunk::default);
            }
            let chunks = &mut chunks[..count];
            helpers.for_each(chunks, |number, chunk| self.cast_chunk(starts.chunk(number), chunk));
            for chunk in chunks {
                memory::append(contacts, chunk.contacts.iter().copied());
                *statistics += chunk.statistics;
                surface.merge(&chunk.surface);
            }
            return;
        }
        for number in 0..count {
            let mut of_chunk = CastSurface::default();
            dispatch::<T, _>(Cast {
                direction: self,
                starts: starts.chunk(number),
                surface: &mut of_chunk,
                statistics,
                contacts,
                pieces: samples,
                crossings,
            });
            surface.merge(&of_chunk);
        }
    }

    fn cast_chunk(&self, starts: Starts<'_>, chunk: &mut Chunk<T>) {
        (chunk.surface, chunk.statistics) = (CastSurface::default(), Statistics::default());
        chunk.contacts.clear();
        let Chunk { surface, statistics, contacts, pieces, crossings } = chunk;
        dispatch::<T, _>(Cast { direction: self, starts, surface, statistics, contacts, pieces, crossings });
    }
}
