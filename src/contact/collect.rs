//! Points of one body that do not follow the load: what is pushed where a pair escapes, and where a body may touch itself.

use crate::contact::pair::Pair;
use crate::contact::quadrature::Sampling;
use crate::contact::quadrature::sampler::CollectVertices;
use crate::contact::workspace::Workspace;
use crate::math::Scalar;
use crate::memory;
use crate::simd::dispatch;

/// Of the samples where loads are not measured, this part is collected: an escape pushes all points alike.
const PART_OF_ESCAPES: f64 = 0.25;

impl<T: Scalar> Pair<'_, T> {
    /// All samples of one body's groups inside the overlap box, into the workspace.
    pub(crate) fn collect(&self, side: usize, workspace: &mut Workspace<T>) {
        let Workspace { groups, vertices, samples, quadrature, .. } = workspace;
        samples.clear();
        if self.options.sampling == Sampling::Vertices {
            let (own, region, groups) = (self.tracers[side], self.region, &groups[side]);
            dispatch::<T, _>(CollectVertices { own, region, groups, vertices, samples });
        } else {
            groups[1 - side].clear();
            let pair = Self { part_of_samples: self.part_of_samples * T::of(PART_OF_ESCAPES), ..*self };
            quadrature.fill(&pair, groups, false);
            memory::append(samples, quadrature.samples[side].iter().copied());
        }
    }
}
