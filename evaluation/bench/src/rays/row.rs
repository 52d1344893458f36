//! One line of `rays.csv`.

use serde::Serialize;

#[derive(Serialize)]
pub struct Row {
    pub workload: String,
    pub triangles: usize,
    /// What rays.
    pub kind: String,
    pub rays: usize,
    pub hits: usize,
    pub simd: String,
    pub method: String,
    /// Nanoseconds for a ray, the median of all rounds.
    pub ns: f64,
    /// The time of Embree's single rays over this, the median of the rounds' ratios.
    pub embree_single_over_this: f64,
    /// How many rays were held against every triangle, and how many of those differ.
    pub checked: usize,
    pub wrong: usize,
}
