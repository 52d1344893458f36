use crate::contact::cast::Cast;
use crate::contact::list::ContactList;
use crate::contact::pair::{Direction, Pair};
use crate::contact::point_pair::{Contact, ContactKind};
use crate::contact::quadrature::sampler::Starts;
use crate::contact::quadrature::{Purpose, Sampling};
use crate::contact::statistics::Statistics;
use crate::contact::weigh::shares::{CastLoad, scale_contacts, shares};
use crate::contact::workspace::{Chunk, Workspace};
use crate::math::Scalar;
use crate::memory::Room;
use crate::simd::{LANE_COUNT, dispatch};

// What chose these numbers: docs/architecture.md, *Tuned constants*.

/// A direction is cast in about this many chunks. They do not depend on the number of threads, so sums over them do not either.
const CHUNKS: usize = 16;
/// The fewest groups of vertices or triangles in a chunk, whose rays need not fill the last packet, and the most.
const GROUPS_IN_CHUNK: [usize; 2] = [32, 64];

impl<'a, T: Scalar> Starts<'a, T> {
    fn chunk_count(self) -> usize {
        self.len().div_ceil(self.steps_in_chunk())
    }

    fn steps_in_chunk(self) -> usize {
        let [fewest, most] = GROUPS_IN_CHUNK;
        self.len().div_ceil(CHUNKS).clamp(fewest, most)
    }

    fn chunk(self, number: usize) -> Self {
        let length = self.steps_in_chunk();
        let part = |count: usize, length: usize| number * length..count.min((number + 1) * length);
        let lanes = length * LANE_COUNT;
        match self {
            Self::Groups(groups) => Self::Groups(&groups[part(groups.len(), length)]),
            Self::Samples(samples) => Self::Samples(&samples[part(samples.len(), lanes)]),
        }
    }
}

impl<T: Scalar> Pair<'_, T> {
    /// Adds the contacts of the samples inside the overlap box, both ways. The workspace holds their groups.
    pub(crate) fn cast_samples(&self, list: &mut ContactList<T>) {
        list.workspace.clear();
        let ContactList { contacts, workspace, statistics, .. } = list;
        let Workspace { helpers, chunks, groups, quadrature, vertices, crossings, .. } = workspace;
        let starts = if self.options.sampling == Sampling::Vertices {
            groups.each_ref().map(|groups| Starts::Groups(groups))
        } else {
            let purpose = if self.measures_distances() { Purpose::Load } else { Purpose::Rays };
            quadrature.fill(self, groups, purpose);
            *statistics += quadrature.counts;
            quadrature.samples.each_ref().map(|samples| Starts::Samples(samples))
        };
        let [of_first, of_second] = starts.map(Starts::chunk_count);
        let count = of_first + of_second;
        let mut loads = [CastLoad::default(); 2];
        let side_and_number = |place: usize| if place < of_first { (0, place) } else { (1, place - of_first) };
        if !helpers.are_there() || count < 2 {
            let start = contacts.len();
            let mut middle = start;
            for (side, number) in (0..count).map(side_and_number) {
                let before = contacts.len();
                let mut load = CastLoad::default();
                dispatch::<T, _>(Cast {
                    kind: ContactKind::Ray,
                    direction: &Direction { pair: self, side },
                    starts: starts[side].chunk(number),
                    surface: &mut load.surface,
                    statistics,
                    contacts,
                    vertices,
                    crossings,
                });
                load.add_contacts(&contacts[before..], self.options.law);
                loads[side].merge(&load);
                middle = if side == 0 { contacts.len() } else { middle };
            }
            let shares = self.fixed_shares.unwrap_or_else(|| shares(&loads));
            scale_contacts(shares, &mut contacts[start..], middle - start);
            return;
        }
        if chunks.len() < count {
            chunks.room_for(count - chunks.len()).resize_with(count, Chunk::default);
        }
        let chunks = &mut chunks[..count];
        helpers.for_each(chunks, |place, chunk| {
            let (side, number) = side_and_number(place);
            chunk.cast(&Direction { pair: self, side }, starts[side].chunk(number));
        });
        let mut found = 0;
        for (place, chunk) in chunks.iter_mut().enumerate() {
            chunk.before = found;
            found += chunk.contacts.len();
            *statistics += chunk.statistics;
            loads[side_and_number(place).0].merge(&chunk.load);
        }
        let chunks = &*chunks;
        let shares = self.fixed_shares.unwrap_or_else(|| shares(&loads));
        helpers.append(
            contacts,
            chunks.len(),
            |place| (chunks[place].before, chunks[place].contacts.as_slice()),
            |place, contact| Contact { area: contact.area * shares[side_and_number(place).0], ..*contact },
        );
    }

    /// Whether a direction carries any of the load.
    pub(crate) fn casts(&self, side: usize) -> bool {
        self.fixed_shares.is_none_or(|shares| shares[side] > T::zero())
    }
}

impl<T: Scalar> Chunk<T> {
    fn cast(&mut self, direction: &Direction<'_, T>, starts: Starts<'_, T>) {
        (self.load, self.statistics) = (CastLoad::default(), Statistics::default());
        self.contacts.clear();
        let Self { load, statistics, contacts, vertices, crossings, .. } = self;
        let surface = &mut load.surface;
        let kind = ContactKind::Ray;
        dispatch::<T, _>(Cast { kind, direction, starts, surface, statistics, contacts, vertices, crossings });
        load.add_contacts(contacts, direction.pair.options.law);
    }
}

#[cfg(test)]
mod tests {
    use crate::contact::list::ContactList;
    use crate::contact::options::DetectionOptions;
    use crate::escape::detect_pair;
    use crate::mesh::Mesh;
    use crate::mesh::test_mesh::torus;
    use crate::mesh::test_mesh::torus_positions;
    use crate::query::Octree;
    use crate::threads::Threads;

    /// So fine that threads also share what is done before and after the rays.
    const SIDES: [u32; 2] = [256, 128];

    fn contacts(meshes: [&Mesh<f64>; 2], threads: usize) -> ContactList<f64> {
        let octrees = meshes.map(Octree::new);
        let tracers = [0, 1].map(|side| octrees[side].tracer(meshes[side]).expect("it is new"));
        let mut contacts = ContactList::default();
        let threads = Threads::new(threads).expect("the threads start");
        contacts.set_helpers(threads.helpers().clone());
        threads.run(|| {
            detect_pair([0, 1], tracers.each_ref(), &DetectionOptions::paper(), 0, None, true, &mut contacts);
        });
        contacts
    }

    /// Also in number: several threads are told before where each chunk's contacts begin.
    #[test]
    fn chunks_cast_side_by_side_give_what_one_thread_gives() {
        let first = torus(SIDES);
        let mut second = first.clone();
        let moved: Vec<_> =
            torus_positions(SIDES, 3).into_iter().map(|[x, y, z]| [x - 0.2, y - 0.1, z - 0.35]).collect();
        second.set_positions(&moved).expect("finite");
        let alone = contacts([&first, &second], 1);
        assert!(alone.len() > 5000, "{}", alone.len());
        assert_eq!(contacts([&first, &second], 2), alone);
    }
}
