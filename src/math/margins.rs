//! Rounding margins: by how much a computed number may differ from the exact one, and so by how much a bound must be wider
//! to lose nothing.
//!
//! Each is a count of rounding units (half the gap between 1 and the next number). [`margin`] multiplies it with a length
//! that no number in the computation exceeds, so that margins scale with the scene. A margin that is too small loses contacts;
//! one that is twice as wide as need be costs next to nothing, so all are rounded up to powers of two.

use super::Scalar;

/// So many rounding units, as a factor for a length.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn margin<T: Scalar>(units: f64) -> T {
    T::ROUNDING_UNIT * T::of(units)
}

/// A box's faces, seen by a ray; times the reach, the largest coordinate difference between the ray's origin and the mesh's box.
///
/// In the watertight test a triangle's edges move by at most 8.5 units, as the oracle argues (`examples/oracle/judge.rs`; 6.1 is
/// the largest it has met). The distance to a face takes 3 more: a difference, a quotient and a product. Held by the oracle
/// and by `tests/library/octree/layouts.rs`, which compare with testing every triangle.
pub(crate) const BOX_FACE: f64 = 16.0;

/// Where a ray leaves a box that its origin lies in; times the reach. A hit on the box's own face may lie 32 units behind the
/// face, since hits are known to within as much, and the distance to the face is rounded by 3. Held by
/// `tests/library/whole/metamorphic.rs` and `tests/library/recovery/completeness.rs`.
pub(crate) const RAY_END: f64 = 64.0;

/// A ray's end as a point; times the largest coordinate: one product and one sum. Held by `src/octree/wide/packet/tests.rs`.
pub(crate) const END_POINT: f64 = 4.0;

/// The faces of the overlap box; times its largest coordinate. A sample on such a face is a sum of three corners by weights
/// that are themselves rounded: 3 products, 2 sums, 2 for the weights. Held by `tests/library/whole/metamorphic.rs`.
pub(crate) const SAMPLE_IN_BOX: f64 = 8.0;

/// A distance to a triangle; times the reach r.
///
/// It is the distance of a point of the triangle, plus what was rounded on the way. All vectors on that way are at most
/// 2 √3 r long, so that makes √3 r · (1 for the corner's difference, 3 for the part along the first edge, 1 for their sum, 8
/// for what the second edge is across the first, 2 for the part along that, 1 for the sum, 6 for the weights), 38 r in all;
/// squares and their sums, those of distances to boxes too, take another 12 r. Held by the oracle (8 at most) and
/// `tests/library/octree/closest_points.rs`.
pub(crate) const DISTANCE: f64 = 64.0;

/// The square of a bound, held against sums of three squares; times itself: 1 for the square, 3 for the sums.
pub(crate) const SQUARE_OF_BOUND: f64 = 8.0;

/// The square of a root and a margin; times itself: 1 each for root and sum, doubled by squaring, and as above.
pub(crate) const SQUARE_OF_LIMIT: f64 = 16.0;

/// The flat round volume around a tile; times the longest side of the tile's box. Heights are dot products of differences with
/// a unit vector: 1 + 3 + 3, times √3; radii take such a height off again. Held by `tests/library/octree/closest_points.rs`.
pub(crate) const SLAB: f64 = 32.0;

/// Whether rays may leave a tile at all; times its side plus the reach, squared in effect. A normal takes 7 (differences, products, their
/// difference) on each axis, its product with a direction 5, the corners as the triangle test sees them 8.5; vectors are up to 2 √3 times as
/// long as a side. Held by `src/octree/wide/packet/tests.rs`.
pub(crate) const LEAVING: f64 = 256.0;

/// Positions as rays see them; times the largest coordinate: projections 8.5, hits 32, the rays' origins 8. Held by
/// `src/detection/self_search/touching/tests.rs`.
pub(crate) const SEEN_POSITION: f64 = 64.0;

/// The lengths of the normals around a vertex, summed; times the sum: one for each triangle and some for each length.
pub(crate) const SUM_AROUND_VERTEX: f64 = 64.0;

/// The planes between a classic octree's cells; times its side: one at each of up to some tens of levels. For checks only.
pub(crate) const CELL_PLANE: f64 = 64.0;
