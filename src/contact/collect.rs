//! Samples that do not follow the load: of a pair that escapes, and of a body that may touch itself.

use crate::contact::pair::Pair;
use crate::contact::quadrature::sampler::CollectVertices;
use crate::contact::quadrature::{Purpose, Sampling};
use crate::contact::workspace::Workspace;
use crate::math::Scalar;
use crate::memory;
use crate::simd::dispatch;

impl<T: Scalar> Pair<'_, T> {
    /// Fills the workspace with all samples of one body's groups inside the overlap box.
    pub(crate) fn collect(&self, side: usize, purpose: Purpose, workspace: &mut Workspace<T>) {
        let Workspace { groups, vertices, samples, quadrature, .. } = workspace;
        samples.clear();
        if self.options.sampling == Sampling::Vertices {
            let (own, region, groups) = (self.tracers[side], self.region, &groups[side]);
            dispatch::<T, _>(CollectVertices { own, region, groups, vertices, samples });
        } else {
            groups[1 - side].clear();
            quadrature.fill(self, groups, purpose);
            memory::append(samples, quadrature.samples[side].iter().copied());
        }
    }
}
