//! The nearest point of a triangle to a point, and how far away it is.
//!
//! Single triangles (`TrianglePoint`) and sixteen side by side (`NearTriangles`) are computed by the same operations, so all
//! ways of asking give the same bits. A vertex's distance is computed from that vertex alone, and an edge's from its two ends
//! in the order of their numbers, so all triangles there agree to the bit.
//!
//! # Accuracy
//! Every distance is that of a point of the triangle: where the foot of the perpendicular cannot be told from rounding, the
//! edges compete with it. So thin triangles, and ones without an area, are no worse than others: distances are right to
//! within 64 rounding units of the point's reach, the largest coordinate difference to the mesh's box: see `margins::DISTANCE`.

use crate::math::{Scalar, Vector3};

/// The point of a mesh's surface that is nearest to a given one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint<T: Scalar> {
    /// The triangle it lies on; of several, the one with the smallest index.
    pub triangle: u32,
    /// Barycentric weights of the point at the triangle's three corners: none is negative, they sum to 1 but for
    /// rounding, and those of corners that are not on the point's edge or vertex are zero.
    pub weights: [T; 3],
    /// Where it is.
    pub position: Vector3<T>,
    /// How far it is from the given point.
    pub distance: T,
}
