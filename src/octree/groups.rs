use super::{Cells, Tracer};
use crate::math::{Aabb, LANE_COUNT, Lanes, Scalar};
use crate::memory;

/// The surface in groups of neighbouring vertices and triangles, at most sixteen of each: where rays start, group by
/// group. Each vertex and each triangle belongs to one of them.
impl<T: Scalar> Tracer<'_, T> {
    /// All groups that may have something in the region, in ascending order, into `groups`, which is cleared first.
    pub(crate) fn groups_in(&self, region: &Aabb<T>, groups: &mut Vec<u32>) {
        match self.cells {
            Cells::Wide(cells) => cells.tiles_in(region, groups),
            Cells::Classic(_) => {
                let topology = self.mesh().topology();
                groups.clear();
                let largest = topology.surface_vertices().len().max(topology.triangles().len());
                memory::append(groups, 0..largest.div_ceil(LANE_COUNT) as u32);
            }
        }
    }

    /// Adds those of a group's vertices that lie in the region.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn add_vertices_in<L: Lanes<T>>(&self, group: u32, region: &Aabb<T>, vertices: &mut Vec<u32>) {
        if let Cells::Wide(cells) = self.cells {
            return cells.add_vertices_in::<L>(self.mesh(), group, region, vertices);
        }
        let all = self.mesh().topology().surface_vertices();
        let of_group = all.chunks(LANE_COUNT).nth(group as usize).unwrap_or_default();
        let is_inside = |vertex: &u32| region.contains(&self.mesh().positions()[*vertex as usize]);
        memory::append(vertices, of_group.iter().copied().filter(is_inside));
    }

    /// How many triangles a group has.
    pub(crate) fn triangle_count_of(&self, group: u32) -> usize {
        let mut count = 0;
        self.triangles_of(group, |_| count += 1);
        count
    }

    /// A group's triangles.
    pub(crate) fn triangles_of(&self, group: u32, offer: impl FnMut(u32)) {
        match self.cells {
            Cells::Wide(cells) => cells.triangles_of(group).iter().copied().for_each(offer),
            Cells::Classic(_) => {
                let count = self.mesh().topology().triangles().len() as u32;
                let first = group * LANE_COUNT as u32;
                (first..(first + LANE_COUNT as u32).min(count)).for_each(offer);
            }
        }
    }
}
