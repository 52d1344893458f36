use super::Statistics;
use super::samples::Sample;
use crate::math::Scalar;
use crate::ray::{Hit, Ray};

/// The rays of one direction of a pair on their way through the filters, each at one place of all arrays. Kept with
/// the contacts, so that a steady step allocates nothing.
#[derive(Clone, Debug, Default)]
pub(super) struct Workspace<T: Scalar> {
    pub(super) samples: Vec<Sample<T>>,
    pub(super) rays: Vec<Ray<T>>,
    pub(super) hits: Vec<Option<Hit<T>>>,
    /// Of each ray the vertices shared by the triangles it starts from.
    pub(super) touched: Vec<[u32; 3]>,
    /// Whether the ray leaves its own mesh first.
    pub(super) hidden: Vec<bool>,
}

impl<T: Scalar> Workspace<T> {
    /// Keeps the rays whose first hit leaves the other mesh, cut there, and counts the others.
    pub(super) fn keep_exits(&mut self, statistics: &mut Statistics) {
        let mut kept = 0;
        self.touched.clear();
        for place in 0..self.rays.len() {
            match self.hits[place] {
                None => statistics.misses += 1,
                Some(hit) if !hit.is_exit => statistics.entry_hits += 1,
                Some(hit) => {
                    self.touched.push(self.samples[place].touched());
                    self.samples[kept] = self.samples[place];
                    self.rays[kept] = self.rays[place].until(hit.t);
                    self.hits[kept] = Some(hit);
                    kept += 1;
                }
            }
        }
        self.samples.truncate(kept);
        self.rays.truncate(kept);
        self.hits.truncate(kept);
    }
}
