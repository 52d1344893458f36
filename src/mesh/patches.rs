//! Patches of a surface: connected triangles that lie nearly in one plane, merged two by two into ever larger ones
//! (compare Garland, Willmott and Heckbert 2001, "Hierarchical face clustering on polygonal surfaces").

use super::{Edge, OrderInSpace, Topology};
use crate::math::{Aabb, Scalar, Vector3, length};
use crate::memory::{self, Room};

/// The patches of a mesh, from its triangles up to the largest that are nearly flat.
#[derive(Clone, Debug)]
pub(crate) struct Patches<T: Scalar> {
    /// All triangles; those of a patch are neighbours here.
    order: Vec<u32>,
    patches: Vec<Patch<T>>,
    /// By triangle the patch that consists of it alone.
    smallest: Vec<u32>,
    /// The areas of the smallest and the largest patch of several triangles.
    bounds: Option<[T; 2]>,
    /// Some triangles, and the sum of their doubled areas, which tell how much the mesh has grown since.
    probes: Vec<u32>,
    probed_area: T,
}

#[derive(Clone, Copy, Debug)]
struct Patch<T: Scalar> {
    /// Where its triangles are in the order.
    start: u32,
    end: u32,
    /// Its area, at least that of each patch within it; 0 for a triangle.
    area: T,
    /// The two patches it was merged from; itself twice where there are none.
    parts: [u32; 2],
    /// The patch it was merged into; itself where there is none.
    whole: u32,
    /// The triangle in its middle.
    middle: u32,
}

/// A patch is flat enough if its triangles' areas, added as vectors, leave at least this part of their sum. A cap of a sphere
/// that reaches 37° from its middle just does.
const FLAT: f64 = 0.9;

/// The first three binary digits of an area tell its level, so there are four levels for each doubling.
const LEVEL_SHIFT: u32 = f64::MANTISSA_DIGITS - 3;

/// About this many triangles tell how much a mesh has grown.
const PROBE_COUNT: usize = 64;

fn level_of<T: Scalar>(area: T) -> u64 {
    area.to_f64().to_bits() >> LEVEL_SHIFT
}

impl<T: Scalar> Patches<T> {
    /// The patches of a mesh at its reference positions. Triangles go by their places in space, so that ties do not depend on
    /// their numbers.
    pub(crate) fn new(topology: &Topology, positions: &[Vector3<T>]) -> Self {
        let in_space = OrderInSpace::new(topology, positions);
        let tree = MergeTree::grow(topology, positions, &in_space);
        let count = topology.triangles().len();
        let (ranges, mut order) = tree.ranges(count);
        let mut middle_triangles = tree.middle_triangles(&ranges, &order);
        for triangle in order.iter_mut().chain(&mut middle_triangles) {
            *triangle = in_space.order[*triangle as usize];
        }
        let mut smallest = memory::filled(0, count);
        (0..).zip(&in_space.order).for_each(|(patch, &triangle)| smallest[triangle as usize] = patch);
        let patch_of = |(number, &[start, end]): (u32, &[u32; 2])| {
            let middle = middle_triangles[number as usize];
            Patch { start, end, area: T::zero(), parts: [number; 2], whole: number, middle }
        };
        let mut patches = memory::listed((0..).zip(&ranges).map(patch_of));
        let mut bounds = None;
        for patch in 0..patches.len() {
            let Some(parts) = tree.parts_of(patch, count) else { continue };
            let of_parts = parts.map(|part| patches[part as usize].area);
            let area = T::of(tree.moments[patch].area).max(of_parts[0]).max(of_parts[1]);
            bounds = Some(bounds.map_or([area; 2], |[least, most]: [T; 2]| [least.min(area), most.max(area)]));
            parts.iter().for_each(|&part| patches[part as usize].whole = patch as u32);
            (patches[patch].area, patches[patch].parts) = (area, parts);
        }
        let probes = memory::listed(order.iter().copied().step_by(count.div_ceil(PROBE_COUNT)));
        let corners = |triangle: u32| topology.triangles()[triangle as usize].map(|vertex| positions[vertex as usize]);
        let mut patches = Self { order, patches, smallest, bounds, probes, probed_area: T::one() };
        patches.probed_area = patches.growth(corners);
        patches
    }

    /// About how many times its area at the reference positions the mesh has now, given the corners of its triangles.
    pub(crate) fn growth(&self, corners: impl Fn(u32) -> [Vector3<T>; 3]) -> T {
        let mut doubled_area = T::zero();
        for &triangle in &self.probes {
            let [a, b, c] = corners(triangle);
            doubled_area += length(&(b - a).cross(&(c - a)));
        }
        doubled_area / self.probed_area
    }

    /// The level of patches of at most `area`: its number, below [`level_count`](Self::level_count), and the area rounded down to
    /// it. At level 0 each triangle is a patch of its own.
    pub(crate) fn level(&self, area: T) -> (usize, T) {
        match self.bounds {
            Some([_, most]) if area >= most => (self.level_count() - 1, most),
            Some([least, _]) if area >= least => {
                let level = level_of(area);
                let rounded_down = T::of(f64::from_bits(level << LEVEL_SHIFT));
                ((level - level_of(least)) as usize + 1, rounded_down.max(least))
            }
            // NaN too.
            _ => (0, T::zero()),
        }
    }

    /// How many levels there are.
    pub(crate) fn level_count(&self) -> usize {
        self.bounds.map_or(1, |[least, most]| (level_of(most) - level_of(least)) as usize + 3)
    }

    /// The largest patch of at most this area around a triangle.
    pub(crate) fn around(&self, triangle: u32, area: T) -> u32 {
        let mut patch = self.smallest[triangle as usize];
        loop {
            let whole = self.patches[patch as usize].whole;
            if whole == patch || self.patches[whole as usize].area > area {
                return patch;
            }
            patch = whole;
        }
    }

    /// The largest patch around a triangle of at most this area, and at most this part of the area of the largest patch there.
    pub(crate) fn part_around(&self, triangle: u32, area: T, part: T) -> u32 {
        let whole = self.around(triangle, T::INFINITY);
        self.around(triangle, area.min(self.patches[whole as usize].area * part))
    }

    /// The two patches that a patch was merged from; `None` for a triangle.
    pub(crate) fn parts(&self, patch: u32) -> Option<[u32; 2]> {
        let parts = self.patches[patch as usize].parts;
        (parts != [patch; 2]).then_some(parts)
    }

    /// The patch that this one was merged with, unless its area is larger than this.
    pub(crate) fn other_half(&self, patch: u32, largest: T) -> Option<u32> {
        let parts = self.parts(self.patches[patch as usize].whole).filter(|parts| parts.contains(&patch))?;
        parts.into_iter().find(|&part| part != patch && self.patches[part as usize].area <= largest)
    }

    /// A patch's triangles.
    pub(crate) fn triangles_of(&self, patch: u32) -> &[u32] {
        let Patch { start, end, .. } = self.patches[patch as usize];
        &self.order[start as usize..end as usize]
    }

    /// The triangle nearest to the middle of a patch.
    pub(crate) fn middle(&self, patch: u32) -> u32 {
        self.patches[patch as usize].middle
    }

    /// The number itself, if it is that of a patch with this triangle in its middle.
    pub(crate) fn named(&self, number: u32, middle: u32) -> Option<u32> {
        self.patches.get(number as usize).filter(|patch| patch.middle == middle).map(|_| number)
    }
}

/// The sums over a patch's triangles that say how far it reaches and how flat it is.
#[derive(Clone, Copy, Debug)]
struct Moments {
    area: f64,
    /// Σ area · normal.
    vector: Vector3<f64>,
    /// Σ area · middle.
    first: Vector3<f64>,
    /// Σ area · |middle|².
    second: f64,
}

impl Moments {
    fn of_triangle(scaled_normal: Vector3<f64>, middle: Vector3<f64>) -> Self {
        let area = scaled_normal.norm() * 0.5;
        Self { area, vector: scaled_normal * 0.5, first: middle * area, second: middle.norm_squared() * area }
    }

    fn with(&self, other: &Self) -> Self {
        Self {
            area: self.area + other.area,
            vector: self.vector + other.vector,
            first: self.first + other.first,
            second: self.second + other.second,
        }
    }

    fn is_flat(&self) -> bool {
        self.vector.norm() >= self.area * FLAT
    }

    /// Small where the patch is compact and flat: the mean squared radius, and twice the area that bending takes.
    fn cost(&self) -> f64 {
        let middle = self.first / self.area;
        let radius_squared = self.second / self.area - middle.norm_squared();
        radius_squared + 2.0 * (self.area - self.vector.norm())
    }
}

/// What was merged from what: first the triangles, then the patches in the order in which they were merged.
struct MergeTree {
    moments: Vec<Moments>,
    middles: Vec<Vector3<f64>>,
    /// The two parts of each patch behind the triangles.
    parts: Vec<[u32; 2]>,
}

impl MergeTree {
    /// Merges in rounds, each patch with at most one neighbour a round, the best pairs first, while any two neighbours
    /// are flat together.
    fn grow<T: Scalar>(topology: &Topology, positions: &[Vector3<T>], in_space: &OrderInSpace<'_, T>) -> Self {
        let mut aabb = Aabb::empty();
        topology.surface_vertices().iter().for_each(|&v| aabb.include(&positions[v as usize]));
        let centre = aabb.centre();
        let corners = |&triangle: &u32| in_space.corners(triangle).map(|corner| (corner - centre).map(T::to_f64));
        let all_corners = || in_space.order.iter().map(corners);
        let middles = memory::listed(all_corners().map(|[a, b, c]| (a + b + c) / 3.0));
        let normals = all_corners().map(|[a, b, c]| (b - a).cross(&(c - a)));
        let moments =
            memory::listed(normals.zip(&middles).map(|(normal, &middle)| Moments::of_triangle(normal, middle)));
        let mut tree = Self { moments, middles, parts: Vec::new() };
        let places = in_space.places();
        let inner = topology.edges().filter(|edge| edge.triangles[0] != edge.triangles[1]);
        let in_order = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
        let places_of = |edge: Edge| in_order(edge.triangles.map(|triangle| places[triangle as usize]));
        let mut neighbours: Vec<[u32; 2]> = memory::listed(inner.map(places_of));
        while !neighbours.is_empty() {
            let merged_into = tree.merge(&neighbours);
            for pair in &mut neighbours {
                *pair = pair.map(|patch| merged_into[patch as usize]);
                pair.sort_unstable();
            }
            neighbours.retain(|[a, b]| a != b);
            neighbours.sort_unstable();
            neighbours.dedup();
            neighbours.retain(|&pair| tree.together(pair).is_flat());
        }
        tree
    }

    fn together(&self, [a, b]: [u32; 2]) -> Moments {
        self.moments[a as usize].with(&self.moments[b as usize])
    }

    /// One round of merges; gives for each patch the one that it was merged into, or itself.
    fn merge(&mut self, neighbours: &[[u32; 2]]) -> Vec<u32> {
        let mut merged_into = memory::listed(0..self.moments.len() as u32);
        let together = neighbours.iter().map(|&pair| (self.together(pair), pair));
        let flat = together.filter(|(together, _)| together.is_flat());
        let mut best_first: Vec<(f64, [u32; 2])> = memory::listed(flat.map(|(together, pair)| (together.cost(), pair)));
        best_first.sort_unstable_by(|(a, first), (b, second)| a.total_cmp(b).then(first.cmp(second)));
        for (_, [a, b]) in best_first {
            if merged_into[a as usize] == a && merged_into[b as usize] == b {
                let patch = self.moments.len() as u32;
                let together = self.together([a, b]);
                self.moments.room_for(1).push(together);
                self.parts.room_for(1).push([a, b]);
                (merged_into[a as usize], merged_into[b as usize]) = (patch, patch);
            }
        }
        merged_into
    }

    fn parts_of(&self, patch: usize, triangle_count: usize) -> Option<[u32; 2]> {
        patch.checked_sub(triangle_count).map(|place| self.parts[place])
    }

    /// An order of the triangles in which each patch is a range, and these ranges.
    fn ranges(&self, triangle_count: usize) -> (Vec<[u32; 2]>, Vec<u32>) {
        let mut sizes = memory::filled(1u32, self.moments.len());
        for (place, parts) in self.parts.iter().enumerate() {
            sizes[triangle_count + place] = parts.iter().map(|&part| sizes[part as usize]).sum();
        }
        const UNKNOWN: u32 = u32::MAX;
        let mut starts = memory::filled(UNKNOWN, sizes.len());
        let (mut end, mut order) = (0, memory::filled(0, triangle_count));
        for patch in (0..sizes.len()).rev() {
            if starts[patch] == UNKNOWN {
                starts[patch] = end;
                end += sizes[patch];
            }
            match self.parts_of(patch, triangle_count) {
                Some([first, second]) => {
                    starts[first as usize] = starts[patch];
                    starts[second as usize] = starts[patch] + sizes[first as usize];
                }
                None => order[starts[patch] as usize] = patch as u32,
            }
        }
        (memory::listed(starts.iter().zip(sizes).map(|(&start, size)| [start, start + size])), order)
    }

    /// The triangle nearest to the middle of each patch, by its place in space.
    fn middle_triangles(&self, ranges: &[[u32; 2]], order: &[u32]) -> Vec<u32> {
        let nearest = |(moments, &[start, end]): (&Moments, &[u32; 2])| {
            let middle = moments.first / moments.area;
            let distance = |triangle: u32| (self.middles[triangle as usize] - middle).norm_squared();
            let triangles = &order[start as usize..end as usize];
            // Of equal ones, and of triangles without an area, the first.
            triangles[1..]
                .iter()
                .fold(triangles[0], |best, &other| if distance(other) < distance(best) { other } else { best })
        };
        memory::listed(self.moments.iter().zip(ranges).map(nearest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::mesh::test_mesh::torus;

    fn is_connected(mesh: &Mesh<f64>, patch: &[u32]) -> bool {
        let (mut reached, mut waiting) = (vec![patch[0]], vec![patch[0]]);
        while let Some(triangle) = waiting.pop() {
            for edge in mesh.topology().edges().filter(|edge| edge.triangles.contains(&triangle)) {
                let fresh = edge.triangles.into_iter().filter(|t| patch.contains(t) && !reached.contains(t));
                let fresh: Vec<u32> = fresh.collect();
                reached.extend(&fresh);
                waiting.extend(&fresh);
            }
        }
        reached.len() == patch.len()
    }

    #[test]
    fn patches_of_any_area_cover_the_surface_once() {
        let mesh = torus([40, 20]);
        let patches = Patches::new(mesh.topology(), mesh.reference_positions());
        let count = mesh.topology().triangles().len() as u32;
        let mut count_before = 0;
        for area in [1e9, 0.1, 0.04, 0.0] {
            let mut all: Vec<u32> = (0..count).map(|triangle| patches.around(triangle, area)).collect();
            all.sort_unstable();
            all.dedup();
            let mut covered = Vec::new();
            for &patch in &all {
                let triangles = patches.triangles_of(patch);
                assert!(triangles.contains(&patches.middle(patch)) && is_connected(&mesh, triangles));
                let vectors = triangles.iter().map(|&triangle| mesh.scaled_normal(triangle) / 2.0);
                let size: f64 = vectors.clone().map(|vector| vector.norm()).sum();
                assert!(triangles.len() == 1 || size <= area, "{size}");
                assert!(vectors.sum::<Vector3<f64>>().norm() >= size * 0.899);
                let middle = |triangle: u32| mesh.corners(triangle).iter().sum::<Vector3<f64>>() / 3.0;
                let moment: Vector3<f64> = triangles
                    .iter()
                    .map(|&triangle| middle(triangle) * mesh.scaled_normal(triangle).norm() / 2.0)
                    .sum();
                let aside = |triangle: u32| (middle(triangle) - moment / size).norm();
                let nearest = triangles.iter().map(|&triangle| aside(triangle)).fold(f64::MAX, f64::min);
                assert!(aside(patches.middle(patch)) <= nearest * (1.0 + 1e-9));
                covered.extend_from_slice(triangles);
                let Some([first, second]) = patches.parts(patch) else { continue };
                assert_eq!([patches.triangles_of(first), patches.triangles_of(second)].concat(), triangles);
                let other_half = |part| patches.other_half(part, area);
                assert_eq!([first, second].map(other_half), [Some(second), Some(first)]);
                assert!(other_half(patch).is_none_or(|other| other != first && other != second));
            }
            covered.sort_unstable();
            assert_eq!(covered, (0..count).collect::<Vec<_>>());
            assert!(all.len() as u32 > count_before);
            count_before = all.len() as u32;
        }
        assert_eq!(count_before, count);
    }
}
