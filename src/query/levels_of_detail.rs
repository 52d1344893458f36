use crate::math::Scalar;
use crate::memory;
use crate::mesh::{Mesh, Representatives};
use std::sync::OnceLock;

/// For each level of patches the triangles that stand for them in the groups of one octree, found when first asked for.
#[derive(Debug, Default)]
pub(crate) struct LevelsOfDetail(OnceLock<Vec<OnceLock<Representatives>>>);

impl LevelsOfDetail {
    /// The triangles that stand for patches of at most about this area; `None` where each stands for itself. The area is
    /// rounded down, so that there are four such sets for each doubling. `group` offers the triangles of one.
    pub(crate) fn at<T: Scalar>(
        &self,
        mesh: &Mesh<T>,
        area: T,
        group_count: u32,
        group: impl FnMut(u32, &mut dyn FnMut(u32)),
    ) -> Option<&Representatives> {
        let (number, area) = mesh.patches().level(area)?;
        let levels = self.0.get_or_init(|| {
            let count = mesh.patches().level_count();
            memory::listed((0..count).map(|_| OnceLock::new()))
        });
        Some(levels[number].get_or_init(|| Representatives::new(mesh, area, group_count, group)))
    }
}
