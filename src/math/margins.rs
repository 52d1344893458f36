//! Rounding margins: by how much a computed number may differ from the exact one, and so by how much a bound must be wider
//! to lose nothing.
//!
//! Each is a count of rounding units (half the gap between 1 and the next number). [`margin`] multiplies it with a length
//! that no number in the computation exceeds, so that margins scale with the scene. A margin that is too small loses contacts;
//! one that is twice as wide as need be costs next to nothing, so most are rounded up to powers of two.
//!
//! At the end stand tolerances of what a host gives, such as how far a rotation matrix may be from one.

use super::Scalar;

/// This many rounding units, as a factor for a length.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn margin<T: Scalar>(units: f64) -> T {
    T::ROUNDING_UNIT * T::of(units)
}

/// A box's faces, seen by a ray; times the reach, the largest coordinate difference between the ray's origin and the mesh's
/// box.
///
/// In the watertight test a triangle's edges move by at most 8.5 units, as the oracle argues
/// (`evaluation/programs/oracle/judge.rs`; 6.1 is the largest it has met). The distance to a face takes 3 more: a difference, a
/// quotient and a product. Held by the oracle and by `tests/library/query/layouts.rs`, which compare with testing every triangle.
pub(crate) const BOX_FACE: f64 = 16.0;

/// Where a ray leaves a box that its origin lies in; times the reach. A hit on the box's own face may lie 32 units behind the
/// face, since hits are known to within as much, and the distance to the face is rounded by 3. Held by
/// `tests/library/whole/metamorphic.rs` and `tests/library/escape/completeness.rs`.
pub(crate) const RAY_END: f64 = 64.0;

/// A ray's end as a point; times the largest coordinate: one product and one sum. Held by `src/bvh/rays/packet/tests.rs`.
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
/// `tests/library/query/closest_points.rs`.
pub(crate) const DISTANCE: f64 = 64.0;

/// An upper bound of a distance, found as a distance or as a sum of such; times itself. The smaller of both is used, so a bound
/// that is too small is off by no more than rounding. Held by `tests/library/contact/tolerance.rs`.
pub(crate) const DISTANCE_BOUND: f64 = 128.0;

/// The square of a bound, held against sums of three squares; times itself: 1 for the square, 3 for the sums.
pub(crate) const SQUARE_OF_BOUND: f64 = 8.0;

/// The square of the sum of a root and a margin; times itself: 1 each for root and sum, doubled by squaring, and as above.
pub(crate) const SQUARE_OF_LIMIT: f64 = 16.0;

/// The flat cylinder around a tile; times the longest side of the tile's box. Heights are dot products of differences with
/// a unit vector: 1 + 3 + 3, times √3; radii take such a height off again. Held by `tests/library/query/closest_points.rs`.
pub(crate) const TILE_CYLINDER: f64 = 32.0;

/// Whether rays may leave a tile at all; times its side plus the reach, squared in effect. A normal takes 7 (differences,
/// products, their difference) on each axis, its product with a direction 5, the corners as the triangle test sees them 8.5;
/// vectors are up to 2 √3 times as long as a side. Held by `src/bvh/rays/packet/tests.rs`.
pub(crate) const LEAVING: f64 = 256.0;

/// Between which reaches, in lengths of a ray's direction, the `t` of faces tell boxes apart; other rays are taken to meet every
/// box. Below the least, `t` has lost its digits to underflow: four bits are left above the smallest number. Above the most, a
/// ray that is parallel to a face, and no farther from it than a rounding, may seem to leave the box before it enters. It passes
/// the face at the margin times a finite stand-in for 1/0, and the quarter keeps the sum of two such numbers finite. Held by
/// `tests/library/whole/number_range.rs` and the fuzz target of rays.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn reaches_told_apart<T: Scalar>() -> [T; 2] {
    [T::of(16.0) / T::LARGEST, T::LARGEST * margin(BOX_FACE) * T::of(0.25)]
}

/// The planes between a classic octree's cells, seen by a ray; in [`BOX_FACE`]s: one for itself, and on the way down each plane
/// is rounded once at each of at most 20 levels, by one unit of the octree's side. Held by `tests/library/query/layouts.rs`.
pub(crate) const CELL_FACE: f64 = 3.0;

/// How far the cylinder around a tile reaches along a row of a rotation; times its size, and as a part of a square of the row.
/// Normals are as long as 1 to 4 units, their product with a row takes 5 more, and squares double that: 18. Held by
/// `src/bvh/placing/tests.rs`.
pub(crate) const CYLINDER_REACH: f64 = 64.0;

/// Boxes in narrow numbers, in units of the longest side of the box around most of the mesh: 16 rounding units of `f32`. A number
/// takes 1 each for the difference, the inverse, the product, the conversion and this margin itself, the sum of two that is held
/// against a distance 2 more, and the distance 3: 10. Held by `src/self_contact/near_triangles.rs`.
pub(crate) const NARROW_BOX: f32 = 1.0 / (1 << 20) as f32;

/// The least cosine of the angle between normals that face alike, in single precision: one half, and 0.01 for the normals of
/// slivers, which rounding turns by as much where a triangle is 2⁻¹⁷ times as high as long. Held by
/// `src/self_contact/near_triangles.rs`.
pub(crate) const FACING_ALIKE: f32 = 0.51;

/// The least part of a normal along an axis that it faces along, squared. A normal whose triangle passes [`LEAST_SINE`] is
/// right to 7 units over the sine, 2⁻¹¹ of its length in single precision, where an eighth is asked: 2⁻⁸ would do. Held by
/// `src/mesh/facing.rs`.
pub(crate) const LEAST_PART: f64 = 1.0 / 64.0;

/// The square of the least sine of a triangle's angle for its normal to tell where it faces: a normal is rounded by 7 units of
/// its edges' product, 2 for each edge's difference, 3 for products and their difference. Held by `src/mesh/facing.rs`.
pub(crate) const LEAST_SINE: f64 = 1.0 / (1 << 20) as f64;

/// All normals n around a vertex face outward if Σ|n| − |Σn| is below this part of the smallest |n|. A normal that faced the
/// other way would add at least its whole length. Beside [`SUM_AROUND_VERTEX`] the 5 units of one length would do; a vertex
/// that this refuses is only looked at by itself. Held by `src/mesh/facing.rs`.
pub(crate) const LEAST_NORMAL: f64 = 0.9375;

/// A flat tetrahedron, from a point to a triangle, as a part of the product of its three edges. The edges' directions are right
/// to 5 units each (difference, square, root and quotient), and the product of three takes 8 more: 23. Points nearer to a
/// triangle's plane count as on it, and only whether a part lies inside another is asked, far from both. Held by
/// `src/mesh/winding.rs`.
pub(crate) const FLAT_TETRAHEDRON: f64 = 128.0;

/// The volume of a part of a mesh, in units of its box; times the sum of its terms' sizes. A smaller volume comes from the
/// rounding of the positions, so the part is called flat instead of inside out. Held by `tests/library/mesh/orientation.rs`.
pub(crate) const VOLUME: f64 = 1.0;

/// Positions as rays see them; times the largest coordinate: projections 8.5, hits 32, the rays' origins 8. Held by
/// `src/self_contact/touching/tests.rs`.
pub(crate) const SEEN_POSITION: f64 = 64.0;

/// Triangles of one body closer than this touch; in [`SEEN_POSITION`]s: one for each of the two, and the distance found between
/// them is rounded by less than a third. Held by `src/self_contact/touching/tests.rs`.
pub(crate) const TOUCH: f64 = 4.0;

/// The least altitude of the triangles around a vertex, as seen along their mean normal; in [`SEEN_POSITION`]s. A ray from a
/// triangle's middle stays a third of it away from the others, 21, where 2 would be told apart from touching. Held by
/// `src/self_contact/touching/tests.rs`.
pub(crate) const ALTITUDE_OF_FAN: f64 = 64.0;

/// The part of the allowed strain around a vertex that is used. The rest, one in fifty, is for rounding: of sines and lengths, a
/// few units over the sine, and of the bound's 1.665 to 1.67. Held by `src/self_contact/touching/tests.rs`.
pub(crate) const STRAIN: f64 = 0.98;

/// The square of a gap between triangles, held against the square of a distance; its factor. Beyond all rounding: squares and
/// their quotient take 10 units. Triangles between the two are looked at closely. Held by
/// `src/self_contact/touching/tests.rs`.
pub(crate) const CLEAR_GAP: f64 = 1.5;

/// The lengths of the normals around a vertex, summed; times the sum: one for each triangle and 5 for each length. Held by
/// `src/mesh/facing.rs`; for up to 58 triangles, and a vertex of more is looked at by itself where it matters.
pub(crate) const SUM_AROUND_VERTEX: f64 = 64.0;

/// Which part of a triangle counts as below an outline, six times: each edge adds to it a sum of three terms of at most 3, of 8 units
/// each, for up to 40 edges. What more edges leave is a load of that size on a triangle beside it. Held by
/// `src/contact/outline.rs`.
pub(crate) const COVERED: f64 = 1024.0;

/// The planes between a classic octree's cells; times its side: one at each of up to some tens of levels. For checks only.
pub(crate) const CELL_PLANE: f64 = 64.0;

/// What elimination leaves of a number on the diagonal of the rigid bodies' matrix; times that number: 1 for each row of
/// contacts that was added to it and for each unknown eliminated before, which mostly cancel. Two cubes on one another lose 2.
/// Held by `tests/library/system/range.rs`.
pub(crate) const ELIMINATED_PART: f64 = 16.0;

/// Which part of the rigid bodies' answer may be wrong before it is corrected, so that each correction leaves no more than
/// that; and which part may stay. Above the first, forces that cancel between two bodies take 1e-9 of the momentum with them.
/// Held by `tests/library/system/range.rs`.
pub(crate) const WRONG_ANSWER: [f64; 2] = [1.0 / 8192.0, 1.0 / (1_u64 << 36) as f64];

/// The largest number that a contact system takes: of a material, a position, a velocity, a step's length. Its energies are
/// squares of forces over stiffnesses, and a force is a product of six of them, stiffness, area, friction, damping time and
/// speed, so that a thousand million of these squares are still numbers: 2^(80 · 12) · 2³⁰ < 2¹⁰²³. Held by
/// `tests/library/system/range.rs`.
pub(crate) const LARGEST_GIVEN: f64 = (1_u128 << 80) as f64;

/// The least length of a step; and bounds of what enters a product or a quotient only once: masses, and the vectors that a
/// solver multiplies with the matrix, which may be forces. Held by the same test.
pub(crate) const SHORTEST_STEP: f64 = 1.0 / LARGEST_GIVEN;
pub(crate) const LARGEST_FACTOR: f64 =
    (LARGEST_GIVEN * LARGEST_GIVEN) * (LARGEST_GIVEN * LARGEST_GIVEN) * LARGEST_GIVEN;
pub(crate) const MASSES: [f64; 2] = [1.0 / LARGEST_FACTOR, LARGEST_FACTOR];

/// How far rotation · rotationᵀ may be from the identity: what is left of a rotation in single precision. Held by
/// `src/math/pose.rs` and `tests/library/system/refusals.rs`.
pub(crate) const ROTATION: f64 = 1e-6;

/// How far a half-space's normal may be from unit length; it is normalised then. Held by `tests/library/system/refusals.rs`.
pub(crate) const UNIT_NORMAL: f64 = 1e-6;

/// How far the weights of a vertex may be from 1 in sum, times 1 + their sizes: those rounded to single precision are 2⁻²⁴ off
/// each, for up to 160 nodes. Held by `tests/library/system/refusals.rs`.
pub(crate) const WEIGHT_SUM: f64 = 1e-5;

/// How far an inertia matrix may be from its transpose, and how small its least eigenvalue may be, as parts of its norm. Held by
/// `tests/library/system/refusals.rs`.
pub(crate) const INERTIA: [f64; 2] = [1e-9, 1e-14];

/// How far the square of a remembered direction may be from 1, in either precision. Held by `src/escape/memory_bytes.rs`.
pub(crate) const UNIT_SQUARE: f64 = 1e-3;

/// The square of an angle below which two terms of a rotation's series are enough: the third is 1/120 of the square of this
/// square, a hundredth of a unit. Held by `src/system/twist.rs`.
pub(crate) const SMALL_ANGLE: f64 = 1e-8;
