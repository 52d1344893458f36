//! Which parts of a surface need rays. The winding number under a connected part that touches nothing is the same all over, so
//! one ray tells it.

use crate::math::Scalar;
use crate::memory;
use crate::query::{Tracer, winding_under};
use crate::self_contact::touching::Touching;
use crate::self_contact::union_find::UnionFind;
use crate::triangle::Hit;

/// The triangles whose samples are traced.
#[derive(Clone, Debug, Default)]
pub(crate) struct Culling {
    regions: UnionFind,
    pub(crate) is_wanted: Vec<bool>,
}

impl Culling {
    /// Wants the triangles that touch others, and the connected parts of the rest that lie inside another part of the body. Gives
    /// whether there may be any. Counts in `rays` those that found no inside.
    pub(crate) fn choose<T: Scalar>(
        &mut self,
        tracer: &Tracer<'_, T>,
        touching: &Touching<T>,
        crossings: &mut Vec<Hit<T>>,
        rays: &mut u64,
    ) -> bool {
        let topology = tracer.mesh().topology();
        let mut is_inside = |triangle: u32| {
            let is_inside = winding_under(tracer, triangle, crossings).is_none_or(|number| number > 1);
            // A ray that finds an inside is traced once more for a sample, and counted then.
            *rays += u64::from(!is_inside);
            is_inside
        };
        if !touching.any {
            // A closed surface that passes through itself nowhere winds around nothing twice, unless it has nested components.
            let components = topology.components();
            if components.len() == 1 || !components.iter().any(|&triangle| is_inside(triangle)) {
                return false;
            }
        }
        let count = topology.triangles().len();
        self.regions.reset(count);
        for edge in topology.edge_list() {
            let [a, b] = edge.triangles;
            if !(touching.touched[a as usize] || touching.touched[b as usize]) {
                self.regions.join(a, b, false);
            }
        }
        memory::refill(&mut self.is_wanted, touching.touched.iter().copied());
        for triangle in 0..count as u32 {
            let (first, _) = self.regions.find(triangle);
            // The smallest number of a region stands for it, and comes first.
            self.is_wanted[triangle as usize] = if touching.touched[triangle as usize] {
                true
            } else if first == triangle {
                is_inside(triangle)
            } else {
                self.is_wanted[first as usize]
            };
        }
        true
    }
}
