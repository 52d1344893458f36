use super::{Cells, Tracer};
use crate::math::{LANE_COUNT, Scalar};
use crate::memory;
use crate::mesh::Standing;
use std::sync::OnceLock;

/// For each level of patches the triangles that stand for them in the groups of one octree, found when first asked for.
#[derive(Debug, Default)]
pub(super) struct StandingByLevel(OnceLock<Vec<OnceLock<Standing>>>);

impl<'a, T: Scalar> Tracer<'a, T> {
    /// The triangles that stand for patches of at most about this area; `None` where each stands for itself. The area is
    /// rounded down, so that there are four such sets for each doubling.
    pub(crate) fn standing(&self, area: T) -> Option<&'a Standing> {
        let mesh = self.mesh();
        let (number, area) = mesh.patches().level(area)?;
        let levels = self.standing.0.get_or_init(|| {
            let count = mesh.patches().level_count();
            memory::listed((0..count).map(|_| OnceLock::new()))
        });
        let find = || Standing::new(mesh, area, self.group_count(), |group, offer| self.triangles_of(group, offer));
        Some(levels[number].get_or_init(find))
    }

    /// How many triangles of these groups stand for patches of at most about this area, if only for themselves.
    pub(crate) fn casting_in(&self, groups: &[u32], area: T) -> usize {
        match self.standing(area) {
            Some(standing) => groups.iter().map(|&group| standing.count_in(group)).sum(),
            None => groups.iter().map(|&group| self.triangle_count_of(group)).sum(),
        }
    }

    fn group_count(&self) -> u32 {
        match self.cells {
            Cells::Wide(cells) => cells.tile_count(),
            Cells::Classic(_) => self.mesh().topology().triangles().len().div_ceil(LANE_COUNT) as u32,
        }
    }
}
