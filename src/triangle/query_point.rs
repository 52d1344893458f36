use crate::math::{Aabb, Scalar, Vector3, margins, normalising_factor};

/// Points up to this many times the mesh's size away are seen in one scale, so that they can be asked about together.
const FAR: f64 = 65536.0;

/// How points are seen from a mesh: in a scale, a power of two, in which no square overflows, and none underflows that
/// matters. So scaling mesh and point by a power of two scales every distance exactly.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeshScale<T: Scalar> {
    /// Half its coordinates, since differences of finite numbers may overflow.
    pub(crate) half_lower: Vector3<T>,
    pub(crate) half_upper: Vector3<T>,
    half_size: T,
    /// The factor for coordinates of near points, and its inverse.
    pub(crate) factors: [T; 2],
}

impl<T: Scalar> MeshScale<T> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn new(mesh_box: &Aabb<T>) -> Self {
        let half = T::of(0.5);
        let (half_lower, half_upper) = (mesh_box.lower * half, mesh_box.upper * half);
        let half_size = (half_upper - half_lower).max();
        Self { half_lower, half_upper, half_size, factors: normalising_factor(half_size).into() }
    }

    /// Points are near, and seen in the mesh's own scale, up to this half reach.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn half_reach_of_near(&self) -> T {
        self.half_size * T::of(FAR)
    }
}

/// What half a point's reach is multiplied with for the margin of its scaled distances.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn margin_per_half_reach<T: Scalar>(factor: T) -> T {
    factor * margins::margin(2.0 * margins::DISTANCE)
}

/// A point made ready to be held against the triangles of one mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct QueryPoint<T: Scalar> {
    /// The point, scaled.
    pub(crate) position: Vector3<T>,
    /// What coordinates are multiplied with.
    pub(crate) factor: T,
    /// 1 / factor.
    pub(crate) inverse: T,
    /// By how much a distance to a triangle may have been rounded down, scaled.
    pub(crate) margin: T,
}

impl<T: Scalar> QueryPoint<T> {
    /// `None` for a point that is not finite.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn new(point: &Vector3<T>, scale: &MeshScale<T>) -> Option<Self> {
        if !point.iter().all(|x| x.is_finite()) {
            return None;
        }
        let at = point * T::of(0.5);
        let half_reach = (scale.half_lower - at).abs().sup(&(scale.half_upper - at).abs()).max();
        let is_near = half_reach <= scale.half_reach_of_near();
        let [factor, inverse] = if is_near { scale.factors } else { normalising_factor(half_reach).into() };
        Some(Self { position: point * factor, factor, inverse, margin: half_reach * margin_per_half_reach(factor) })
    }

    /// The largest squared distance that may belong to a distance of at most `bound`, and perhaps a little more.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn square_of_bound(&self, bound: T) -> T {
        let bound = bound * self.factor;
        bound * bound * (T::one() + margins::margin(margins::SQUARE_OF_BOUND))
    }

    /// The largest squared distance to a box that may hold a triangle with this squared distance or a smaller one.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn square_of_boxes(&self, square: T) -> T {
        let distance = square.sqrt() + self.margin;
        distance * distance * (T::one() + margins::margin(margins::SQUARE_OF_LIMIT))
    }

    /// The same for tile cylinders, whose distances are rounded a little more: by no more than another margin.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn square_of_cylinders(&self, square: T) -> T {
        let distance = square.sqrt() + self.margin + self.margin;
        distance * distance * (T::one() + margins::margin(margins::SQUARE_OF_LIMIT))
    }

    /// The squared distance to a box.
    pub(crate) fn square_to_box(&self, aabb: &Aabb<T>) -> T {
        let below = aabb.lower * self.factor - self.position;
        let above = self.position - aabb.upper * self.factor;
        below.sup(&above).sup(&Vector3::zeros()).norm_squared()
    }
}
