use crate::contact::quadrature::sample::{MeasuredSample, Sample};
use crate::math::Scalar;
use crate::simd::LANE_COUNT;

/// Where rays start.
#[derive(Clone, Copy)]
pub(crate) enum Starts<'a, T: Scalar> {
    /// From the vertices or triangles of these groups.
    Groups(&'a [u32]),
    /// From these.
    Samples(&'a [Sample<T>]),
    /// From these, in the middles of elements.
    Measured(&'a [MeasuredSample<T>]),
}

impl<T: Scalar> Starts<'_, T> {
    /// How many steps it takes to go through them.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Groups(groups) => groups.len(),
            Self::Samples(samples) => samples.len().div_ceil(LANE_COUNT),
            Self::Measured(samples) => samples.len().div_ceil(LANE_COUNT),
        }
    }
}

/// Parts of triangles that have yet to cast.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pieces<T: Scalar> {
    /// Of one triangle, the last first.
    pub(crate) cut: Vec<Sample<T>>,
    /// In which order samples come: what they are ordered by, and their places.
    pub(crate) order: Vec<((u32, u32), u32)>,
}

impl<T: Scalar> Pieces<T> {
    pub(crate) fn clear(&mut self) {
        self.cut.clear();
    }
}
