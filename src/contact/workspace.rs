use super::Statistics;
use crate::math::Scalar;
use crate::ray::{Hit, Ray};

/// The rays of one direction of a pair on their way through the filters, each at one place of all arrays. Kept with
/// the contacts, so that a steady step allocates nothing.
#[derive(Clone, Debug, Default)]
pub(super) struct Workspace<T: Scalar> {
    pub(super) vertices: Vec<u32>,
    pub(super) areas: Vec<T>,
    pub(super) rays: Vec<Ray<T>>,
    pub(super) hits: Vec<Option<Hit<T>>>,
    /// Whether the ray leaves its own mesh first.
    pub(super) hidden: Vec<bool>,
}

impl<T: Scalar> Workspace<T> {
    pub(super) fn clear(&mut self) {
        self.vertices.clear();
        self.areas.clear();
        self.rays.clear();
    }

    pub(super) fn push(&mut self, vertex: u32, area: T, ray: Ray<T>) {
        self.vertices.push(vertex);
        self.areas.push(area);
        self.rays.push(ray);
    }

    /// Keeps the rays whose first hit leaves the other mesh, cut there, and counts the others.
    pub(super) fn keep_exits(&mut self, statistics: &mut Statistics) {
        let mut kept = 0;
        for place in 0..self.rays.len() {
            match self.hits[place] {
                None => statistics.misses += 1,
                Some(hit) if !hit.is_exit => statistics.entry_hits += 1,
                Some(hit) => {
                    self.vertices[kept] = self.vertices[place];
                    self.areas[kept] = self.areas[place];
                    self.rays[kept] = self.rays[place].until(hit.t);
                    self.hits[kept] = Some(hit);
                    kept += 1;
                }
            }
        }
        self.vertices.truncate(kept);
        self.areas.truncate(kept);
        self.rays.truncate(kept);
        self.hits.truncate(kept);
    }
}
