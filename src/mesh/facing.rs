use super::Mesh;
use super::normals::RingLanes;
use crate::math::{LANE_COUNT, Lanes, Mask, Scalar, Vectors};

/// Vertices around which all triangles face along an axis, or all against it, and go around once: seen along the axis they
/// cover a neighbourhood of the vertex once, so that the points just before and behind it lie on either side of the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facing {
    /// By axis.
    pub(crate) along: [Mask; 3],
    pub(crate) against: [Mask; 3],
}

/// The least part of a normal along the axis, squared: far more than the rounding of normals.
const LEAST_PART: f64 = 1.0 / 64.0;
/// The least sine of a triangle's angle, squared: the normal is rounded by some units of its two edges' product.
const LEAST_SINE: f64 = 1.0 / (1 << 20) as f64;

impl<T: Scalar> Mesh<T> {
    /// Of up to sixteen vertices. Where rounding might decide, or squares underflow or overflow, neither holds.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn facing<L: Lanes<T>>(&self, vertices: &[u32]) -> Facing {
        let count = vertices.len().min(LANE_COUNT);
        let mut own = [vertices[0]; LANE_COUNT];
        own[..count].copy_from_slice(&vertices[..count]);
        let rings = RingLanes::new::<T, L>(self.topology(), own);
        let base = self.gather::<L>(&own);
        let zero = L::splat(T::zero());
        let (least, greatest) = (L::splat(T::SAFE_SQUARES.0), L::splat(T::SAFE_SQUARES.1));
        let (least_part, least_sine) = (L::splat(T::of(LEAST_PART)), L::splat(T::of(LEAST_SINE)));
        let (mut along, mut against) = ([Mask::MAX; 3], [Mask::MAX; 3]);
        // How often the edges pass from the lower to the upper half along each axis.
        let (mut once, mut more) = ([0; 3], [0; 3]);
        let (mut before, mut square_before, mut is_below, mut has_length_before) = (Vectors::zeros(), zero, [0; 3], 0);
        for place in 0..rings.longest {
            let edge = self.gather::<L>(&rings.at::<T, L>(place)).sub(base);
            let has_length = zero.is_less(edge.magnitude().largest());
            let is_triangle = has_length & has_length_before;
            let (normal, square_of_edge) = (before.cross(edge), edge.dot(edge));
            let square = normal.dot(normal);
            let is_sure = least.is_at_most(square)
                & square.is_at_most(greatest)
                & square_of_edge.mul(square_before).mul(least_sine).is_at_most(square);
            let part = square.mul(least_part);
            let (edges, normals) = ([edge.x, edge.y, edge.z], [normal.x, normal.y, normal.z]);
            for axis in 0..3 {
                let is_enough = part.is_at_most(normals[axis].mul(normals[axis])) & is_sure;
                along[axis] &= zero.is_less(normals[axis]) & is_enough | !is_triangle;
                against[axis] &= normals[axis].is_less(zero) & is_enough | !is_triangle;
                let is_below_now = edges[axis].is_less(zero);
                let passes = is_below[axis] & !is_below_now & is_triangle;
                more[axis] |= once[axis] & passes;
                once[axis] |= passes;
                is_below[axis] = is_below_now;
            }
            (before, square_before, has_length_before) = (edge, square_of_edge, has_length);
        }
        for axis in 0..3 {
            // Seen along one axis, the edges pass the next.
            let next = (axis + 1) % 3;
            along[axis] &= once[next] & !more[next];
            against[axis] &= once[next] & !more[next];
        }
        Facing { along, against }
    }
}
