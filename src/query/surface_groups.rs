use crate::bvh::{Bvh, MayMeet, SidesScratch, TilesNotOutside};
use crate::math::{Aabb, Scalar};
use crate::memory;
use crate::mesh::Mesh;
use crate::query::octree::Tree;
use crate::query::patch_levels::for_each_mark;
use crate::query::tracer::Tracer;
use crate::simd::{LANE_COUNT, Lanes, dispatch};
use crate::triangle::TriangleTest;

/// In a region thinner than this many of a body's tiles, nearly all tiles are near both surfaces, and rays from the others are
/// short.
const FEWEST_TILES_ACROSS: f64 = 4.0;

/// At most this many lines tell what a body's rays meet.
const MOST_LINES: usize = 6;

/// Whether a region is thick beside the tiles of a body.
fn is_thick<T: Scalar>(region: &Aabb<T>, mesh: &Mesh<T>, tree: &Bvh<T>) -> bool {
    let [x, y, z]: [T; 3] = (mesh.aabb().upper - mesh.aabb().lower).into();
    let square_of_tile = (x * y + y * z + z * x) * T::of(2.0 / f64::from(tree.tile_count()));
    let thickness = (region.upper - region.lower).min();
    thickness * thickness >= square_of_tile * T::of(FEWEST_TILES_ACROSS * FEWEST_TILES_ACROSS)
}

/// The surface in groups of neighbouring vertices and triangles, at most sixteen of each: where rays start, group by
/// group. Each vertex and each triangle belongs to one of them.
impl<T: Scalar> Tracer<'_, T> {
    /// All groups that may have something in the region, in ascending order, into `groups`, which is cleared first.
    pub(crate) fn groups_in(&self, region: &Aabb<T>, groups: &mut Vec<u32>) {
        match self.tree {
            Tree::Bvh(tree) => tree.tiles_in(region, groups),
            Tree::PaperOctree(_) => memory::refill(groups, 0..self.group_count()),
        }
    }

    pub(crate) fn group_count(&self) -> u32 {
        match self.tree {
            Tree::Bvh(tree) => tree.tile_count(),
            Tree::PaperOctree(_) => {
                let topology = self.mesh().topology();
                let largest = topology.surface_vertices().len().max(topology.triangles().len());
                largest.div_ceil(LANE_COUNT) as u32
            }
        }
    }

    /// [`groups_in`](Self::groups_in) without groups that are known to lie outside `other` with all that they have in the region.
    pub(crate) fn groups_not_outside(
        &self,
        other: &Self,
        region: &Aabb<T>,
        groups: &mut Vec<u32>,
        scratch: &mut SidesScratch<T>,
    ) {
        match self.trees_beside(other) {
            Some([own, of_other]) if is_thick(region, self.mesh(), own) => {
                groups.clear();
                let (other, mesh, tiles) = (of_other, other.mesh(), groups);
                dispatch::<T, _>(TilesNotOutside { own, other, mesh, region, tiles, scratch });
            }
            _ => self.groups_in(region, groups),
        }
    }

    /// About how many of another body's tiles this body's rays have on their way in a region, judged by a few lines through where
    /// rays start; 0 where the other body has no tiles. The lists are scratch memory.
    pub(crate) fn tiles_on_the_way(&self, other: &Self, region: &Aabb<T>, lists: [&mut Vec<u32>; 2]) -> usize {
        let (Tree::Bvh(tree), [groups, met]) = (other.tree, lists) else { return 0 };
        self.groups_in(region, groups);
        // Across a flat region: along it a line through a floor would meet many.
        let axis = (region.upper - region.lower).imin();
        let (lines, mut met_in_all) = (groups.len().div_ceil(2).min(MOST_LINES), 0);
        for line in 0..lines {
            let mut first = None;
            self.triangles_of(groups[line * groups.len() / lines], |triangle| first = first.or(Some(triangle)));
            let start = first.map_or(*region, |first| Aabb::of_triangle(&self.mesh().corners(first)));
            let middle = start.intersection(region).centre();
            let mut along = Aabb { lower: middle, upper: middle };
            (along.lower[axis], along.upper[axis]) = (region.lower[axis], region.upper[axis]);
            tree.tiles_in(&along, met);
            met_in_all += met.len();
        }
        met_in_all / lines.max(1)
    }

    /// Whether [`groups_not_outside`](Self::groups_not_outside) looks for groups to leave out.
    pub(crate) fn leaves_out(&self, other: &Self, region: &Aabb<T>) -> bool {
        self.trees_beside(other).is_some_and(|[own, _]| is_thick(region, self.mesh(), own))
    }

    /// Whether anything of the two surfaces in the region may meet.
    pub(crate) fn may_meet(&self, other: &Self, region: &Aabb<T>) -> bool {
        self.trees_beside(other).is_none_or(|[own, of_other]| {
            dispatch::<T, _>(MayMeet { own, other: of_other, mesh: other.mesh(), region })
        })
    }

    /// The trees of both, if their tiles can tell what lies outside `other`.
    fn trees_beside(&self, other: &Self) -> Option<[&Bvh<T>; 2]> {
        // A sheet has no outside, and another test of triangles may let rays through.
        let tells = !other.mesh().is_open() && other.test == TriangleTest::Watertight;
        match (self.tree, other.tree) {
            (Tree::Bvh(own), Tree::Bvh(of_other)) if tells => Some([own, of_other]),
            _ => None,
        }
    }

    /// Adds those of a group's vertices that lie in the region.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn add_vertices_in<L: Lanes<T>>(&self, group: u32, region: &Aabb<T>, vertices: &mut Vec<u32>) {
        if let Tree::Bvh(tree) = self.tree {
            return tree.add_vertices_in::<L>(self.mesh(), group, region, vertices);
        }
        let all = self.mesh().topology().surface_vertices();
        let of_group = all.chunks(LANE_COUNT).nth(group as usize).unwrap_or_default();
        let is_inside = |vertex: &u32| region.contains(&self.mesh().position(*vertex));
        memory::append(vertices, of_group.iter().copied().filter(is_inside));
    }

    /// Offers the vertices of the groups that may have something in the region, each once, in ascending order. The lists are
    /// scratch memory.
    pub(crate) fn vertices_near(
        &self,
        region: &Aabb<T>,
        (groups, marks): (&mut Vec<u32>, &mut Vec<u64>),
        mut offer: impl FnMut(u32),
    ) {
        let count = self.mesh().topology().vertex_count();
        let Tree::Bvh(tree) = self.tree else { return (0..count as u32).for_each(offer) };
        tree.tiles_in(region, groups);
        memory::refill_with(marks, 0, count.div_ceil(64));
        for &vertex in groups.iter().flat_map(|&tile| tree.vertices_of(tile)) {
            marks[vertex as usize / 64] |= 1 << (vertex % 64);
        }
        for_each_mark(marks, |vertex| offer(vertex as u32));
    }

    /// A group's triangles.
    pub(crate) fn triangles_of(&self, group: u32, offer: impl FnMut(u32)) {
        match self.tree {
            Tree::Bvh(tree) => tree.triangles_of(group).iter().copied().for_each(offer),
            Tree::PaperOctree(_) => {
                let count = self.mesh().topology().triangles().len() as u32;
                let first = group * LANE_COUNT as u32;
                (first..(first + LANE_COUNT as u32).min(count)).for_each(offer);
            }
        }
    }
}
