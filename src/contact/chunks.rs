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
use crate::triangle::Hit;

// What chose these numbers: docs/architecture.md, *Tuned constants*.

/// A direction is cast in about this many chunks. They do not depend on the number of threads, so sums over them do not either.
const CHUNKS: usize = 16;
/// The fewest and the most groups of vertices, or packets of samples, in a chunk.
const GROUPS_IN_CHUNK: [usize; 2] = [32, 64];

impl<'a, T: Scalar> Starts<'a, T> {
    /// How many groups or packets they are, and how many of these a chunk has.
    fn lengths(self) -> [usize; 2] {
        let length = match self {
            Self::Groups(groups) => groups.len(),
            Self::Samples(samples) => samples.len().div_ceil(LANE_COUNT),
        };
        let [fewest, most] = GROUPS_IN_CHUNK;
        [length, length.div_ceil(CHUNKS).clamp(fewest, most)]
    }

    fn chunk_count(self) -> usize {
        let [all, of_chunk] = self.lengths();
        all.div_ceil(of_chunk)
    }

    fn chunk(self, number: usize) -> Self {
        let [_, length] = self.lengths();
        let range = |count: usize, length: usize| number * length..count.min((number + 1) * length);
        match self {
            Self::Groups(groups) => Self::Groups(&groups[range(groups.len(), length)]),
            Self::Samples(samples) => Self::Samples(&samples[range(samples.len(), length * LANE_COUNT)]),
        }
    }
}

impl<T: Scalar> Pair<'_, T> {
    /// Adds the contacts of the samples inside the overlap box, both ways. The workspace has their groups.
    pub(crate) fn cast_samples(&self, list: &mut ContactList<T>) {
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
        let chunk_of = |index: usize| {
            let (side, number) = if index < of_first { (0, index) } else { (1, index - of_first) };
            (side, Direction { pair: self, side }, starts[side].chunk(number))
        };
        if !helpers.are_there() || count < 2 {
            let start = contacts.len();
            let mut counts = [0; 2];
            for (side, direction, starts) in (0..count).map(chunk_of) {
                let before = contacts.len();
                loads[side].merge(&direction.cast(starts, statistics, contacts, vertices, crossings));
                counts[side] += contacts.len() - before;
            }
            let shares = self.fixed_shares.unwrap_or_else(|| shares(&loads));
            scale_contacts(shares, &mut contacts[start..], counts[0]);
            return;
        }
        if chunks.len() < count {
            chunks.room_for(count - chunks.len()).resize_with(count, Chunk::default);
        }
        let chunks = &mut chunks[..count];
        helpers.for_each(chunks, |index, chunk| {
            let (_, direction, starts) = chunk_of(index);
            let Chunk { load, statistics, contacts, vertices, crossings, .. } = chunk;
            *statistics = Statistics::default();
            contacts.clear();
            *load = direction.cast(starts, statistics, contacts, vertices, crossings);
        });
        let mut before = 0;
        for (index, chunk) in chunks.iter_mut().enumerate() {
            chunk.before = before;
            before += chunk.contacts.len();
            *statistics += chunk.statistics;
            loads[usize::from(index >= of_first)].merge(&chunk.load);
        }
        let chunks = &*chunks;
        let shares = self.fixed_shares.unwrap_or_else(|| shares(&loads));
        helpers.append(
            contacts,
            chunks.len(),
            |index| (chunks[index].before, chunks[index].contacts.as_slice()),
            |index, contact| Contact { area: contact.area * shares[usize::from(index >= of_first)], ..*contact },
        );
    }

    /// Whether a direction carries any of the load.
    pub(crate) fn casts(&self, side: usize) -> bool {
        self.fixed_shares.is_none_or(|shares| shares[side] > T::zero())
    }
}

impl<T: Scalar> Direction<'_, T> {
    /// Adds the contacts of some samples; gives what they carry.
    fn cast(
        &self,
        starts: Starts<'_, T>,
        statistics: &mut Statistics,
        contacts: &mut Vec<Contact<T>>,
        vertices: &mut Vec<u32>,
        crossings: &mut Vec<Hit<T>>,
    ) -> CastLoad<T> {
        let (before, kind) = (contacts.len(), ContactKind::Ray);
        let surface =
            dispatch::<T, _>(Cast { kind, direction: self, starts, statistics, contacts, vertices, crossings });
        CastLoad::new(surface, &contacts[before..], self.pair.options.law)
    }
}

#[cfg(test)]
mod tests {
    use crate::contact::list::ContactList;
    use crate::contact::options::DetectionOptions;
    use crate::escape::detect_pair;
    use crate::mesh::Mesh;
    use crate::mesh::test_mesh::{torus, torus_positions};
    use crate::query::Octree;
    use crate::threads::Threads;

    /// So fine that threads also divide what is done before and after the rays.
    const SIDES: [u32; 2] = [256, 128];

    fn contacts(meshes: [&Mesh<f64>; 2], threads: usize) -> ContactList<f64> {
        let octrees = meshes.map(Octree::new);
        let tracers = [0, 1].map(|side| octrees[side].tracer(meshes[side]).expect("it is new"));
        let mut contacts = ContactList::default();
        let threads = Threads::new(threads).expect("the threads start");
        contacts.workspace.helpers = threads.helpers().clone();
        threads.run(|| {
            detect_pair([0, 1], tracers.each_ref(), &DetectionOptions::paper(), 0, None, true, &mut contacts);
        });
        contacts
    }

    /// Also in number: several threads are told beforehand where each chunk's contacts begin.
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
