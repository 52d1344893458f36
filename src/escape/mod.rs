//! The contacts of two bodies, and recovery from what contacts cannot part: bodies that escape along one direction, and what
//! a pair remembers of it from step to step.

mod direction;
mod memory_bytes;
mod pair_memory;
mod progress;

pub(crate) use memory_bytes::MEMORY_BYTES;
pub use pair_memory::{PairMemory, Record};

use crate::contact::{Contact, ContactList, DetectionOptions, Pair, Sampling, overlap_region, sample_fraction};
use crate::math::Scalar;
use crate::mesh::Mesh;
use crate::query::{Octree, OctreeError, Tracer};

/// Finds the contacts between two meshes, both ways; body 0 is `a`, body 1 is `b`. Replaces what `contacts` held.
/// Queries remember nothing of one another: a pair escapes only where it has no other contact, and each query chooses the
/// direction anew.
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
    contacts.refill(|contacts| detect_pair([0, 1], [&a, &b], options, 0, None, true, contacts));
    Ok(())
}

/// Adds the contacts between two bodies, both ways, to `contacts`: Algorithm 1 of Hermann, Faure and Raffin 2008, and
/// what `options` add to it. `memory` is what the pair remembers from step to step; without it a pair escapes only where
/// it has no other contact, in a direction chosen anew each time. A pair that may not escape is counted where it would.
/// `neighbours`: how many others both bodies meet at least.
pub(crate) fn detect_pair<T: Scalar>(
    bodies: [u32; 2],
    tracers: [&Tracer<'_, T>; 2],
    options: &DetectionOptions<T>,
    neighbours: u32,
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
    // What lies behind a sheet is outside the sheet's box, so the closed body's own box bounds all contacts.
    let (overlap, region) = match is_open {
        [false, false] => overlap_region(boxes[0], boxes[1]),
        [true, false] => overlap_region(boxes[1], boxes[1]),
        [false, true] => overlap_region(boxes[0], boxes[0]),
        [true, true] => return,
    };
    let sample_fraction = match options.sampling {
        Sampling::Accuracy(_) => sample_fraction(neighbours),
        Sampling::Spacing(_) | Sampling::Vertices => T::one(),
    };
    contacts.statistics.crowded_pairs += u64::from(sample_fraction < T::one());
    let (overlap, region) = (&overlap, &region);
    let pair = Pair { may_escape, sample_fraction, ..Pair::new(bodies, tracers, [overlap, region], options) };
    if pair.is_tangled(&mut contacts.workspace) {
        contacts.statistics.tangled_pairs += 1;
        memory.into_iter().for_each(|memory| *memory = PairMemory::default());
        return;
    }
    let start = contacts.len();
    match memory {
        _ if is_open != [false; 2] => pair.cast_both_ways(contacts),
        Some(memory) if options.escape => pair.detect_or_escape(memory, neighbours <= 1, contacts),
        memory => {
            // What was remembered will be out of date when escapes are switched on again.
            memory.into_iter().for_each(|memory| *memory = PairMemory::default());
            pair.detect_without_memory(contacts);
        }
    }
    // Rays from vertices alone need no patches, which tell how thick a body is.
    if options.sampling != Sampling::Vertices {
        let [half_thickness, other] = meshes.map(Mesh::half_thickness);
        let is_deep = |contact: &Contact<T>| contact.depth * contact.cos_alpha > half_thickness.min(other);
        contacts.statistics.deep_pairs += u64::from(contacts.contacts[start..].iter().any(is_deep));
    }
    pair.spread_loads(start, contacts);
}
