use crate::math::{Aabb, Scalar};
use crate::memory::{self, Room};
use crate::mesh::{Mesh, sort_points};
use std::sync::OnceLock;

/// Something for each level of patches, found when first asked for.
#[derive(Debug)]
pub(crate) struct PatchLevels<V>(OnceLock<Vec<OnceLock<V>>>);

impl<V> Default for PatchLevels<V> {
    fn default() -> Self {
        Self(OnceLock::new())
    }
}

impl<V> PatchLevels<V> {
    /// What belongs to the level of this area; found, on the first call, by `find` from the area rounded down to the level.
    pub(crate) fn at<T: Scalar>(&self, mesh: &Mesh<T>, area: T, find: impl FnOnce(T) -> V) -> &V {
        let (number, area) = mesh.patches().level(area);
        let levels = self.0.get_or_init(|| {
            let count = mesh.patches().level_count();
            memory::listed((0..count).map(|_| OnceLock::new()))
        });
        levels[number].get_or_init(|| find(area))
    }
}

/// Which patches of one level reach into each group of triangles.
#[derive(Debug)]
pub(crate) struct PatchesOfGroups {
    /// All patches. Their order depends on nothing but the mesh.
    patches: Vec<u32>,
    /// The patches of group g are `patches[p]` for p in `of_group[starts[g]..starts[g + 1]]`.
    of_group: Vec<u32>,
    starts: Vec<u32>,
}

impl PatchesOfGroups {
    /// For patches of at most this area; `group` offers the triangles of each group.
    pub(crate) fn new<T: Scalar>(
        mesh: &Mesh<T>,
        area: T,
        group_count: u32,
        mut group: impl FnMut(u32, &mut dyn FnMut(u32)),
    ) -> Self {
        let all = mesh.patches();
        let (mut of_group, mut starts) = (Vec::new(), memory::filled(0, 1));
        for number in 0..group_count {
            let first = of_group.len();
            group(number, &mut |triangle| {
                let patch = all.around(triangle, area);
                if !of_group[first..].contains(&patch) {
                    of_group.room_for(1).push(patch);
                }
            });
            starts.room_for(1).push(of_group.len() as u32);
        }
        // Neighbours in space are measured together, and halves of one whole follow one another.
        let is_first = |&patch: &u32| all.other_half(patch, area).is_none_or(|other| patch < other);
        let mut patches = memory::listed(of_group.iter().copied().filter(is_first));
        patches.sort_unstable();
        patches.dedup();
        let triangles = mesh.topology().triangles();
        let position = |vertex: u32| mesh.reference_positions()[vertex as usize];
        let middle = |patch| triangles[all.middle(patch) as usize].map(position);
        let mut points =
            memory::listed(patches.drain(..).map(|patch| (Aabb::of_triangle(&middle(patch)).centre(), patch)));
        sort_points(&mut points);
        // There are fewer patches than triangles and merges of two.
        let mut places = memory::filled(0, 2 * triangles.len());
        for (_, first) in points {
            for patch in [first].into_iter().chain(all.other_half(first, area)) {
                places[patch as usize] = patches.len() as u32;
                patches.room_for(1).push(patch);
            }
        }
        of_group.iter_mut().for_each(|patch| *patch = places[*patch as usize]);
        Self { patches, of_group, starts }
    }

    /// Lists the patches that reach into some groups, each once, in their order; `marks` is scratch memory.
    pub(crate) fn list(&self, groups: &[u32], marks: &mut Vec<u64>, patches: &mut Vec<u32>) {
        memory::refill_with(marks, 0, self.patches.len().div_ceil(64));
        for &group in groups {
            let range = self.starts[group as usize] as usize..self.starts[group as usize + 1] as usize;
            for &place in &self.of_group[range] {
                marks[place as usize / 64] |= 1 << (place % 64);
            }
        }
        patches.clear();
        for_each_mark(marks, |place| patches.room_for(1).push(self.patches[place]));
    }
}

/// The places of the bits that are set, in ascending order.
pub(crate) fn for_each_mark(marks: &[u64], mut use_place: impl FnMut(usize)) {
    for (word, &marked) in marks.iter().enumerate() {
        let mut left = marked;
        while left != 0 {
            use_place(word * 64 + left.trailing_zeros() as usize);
            left &= left - 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::test_mesh::torus;

    /// Patches of any size are listed once, halves of one whole side by side, and sixteen in a row mostly lie closer together
    /// than sixteen of the whole list.
    #[test]
    fn patches_are_listed_among_their_neighbours() {
        let mesh = torus([40, 20]);
        let (all, count) = (mesh.patches(), mesh.topology().triangles().len() as u32);
        let groups: Vec<u32> = (0..count / 16).collect();
        for area in [0.0, 0.01, 0.04] {
            // Triangles in groups in another order than in space.
            let of_group = |group, offer: &mut dyn FnMut(u32)| (0..16).for_each(|k| offer(k * (count / 16) + group));
            let (mut marks, mut listed) = (Vec::new(), Vec::new());
            PatchesOfGroups::new(&mesh, area, count / 16, of_group).list(&groups, &mut marks, &mut listed);
            let mut expected: Vec<u32> = (0..count).map(|triangle| all.around(triangle, area)).collect();
            expected.sort_unstable();
            expected.dedup();
            let mut sorted = listed.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, expected);
            for (place, &patch) in listed.iter().enumerate() {
                let other = all.other_half(patch, area);
                let beside = [place.wrapping_sub(1), place + 1].map(|beside| listed.get(beside).copied());
                assert!(other.is_none() || beside.contains(&other), "{patch} lies apart from its other half");
            }
            let size = |patches: &[u32]| {
                let mut around = Aabb::empty();
                patches.iter().for_each(|&patch| around.include(&mesh.corners(all.middle(patch))[0]));
                (around.upper - around.lower).norm()
            };
            let scattered: Vec<u32> = (0..16).map(|k| listed[k * listed.len() / 16]).collect();
            let mean = listed.chunks(16).map(size).sum::<f64>() / listed.len().div_ceil(16) as f64;
            assert!(mean < 0.5 * size(&scattered), "{mean}, and {} when scattered", size(&scattered));
        }
    }
}
