//! Rays, hits, and the tests of one ray against one triangle.

use crate::math::{Aabb, Scalar, Vector3, margins};
pub use crate::triangle::moller_trumbore::moller_trumbore;
pub use crate::triangle::watertight::ShearedRay;

/// A half line, cut at `t_max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray<T: Scalar> {
    /// Where it starts (t = 0).
    pub origin: Vector3<T>,
    /// Where it goes; need not be of unit length. `t` counts multiples of it.
    pub direction: Vector3<T>,
    /// Hits beyond this `t` do not count; may be infinite.
    pub t_max: T,
}

impl<T: Scalar> Ray<T> {
    /// A ray without an end.
    pub fn new(origin: Vector3<T>, direction: Vector3<T>) -> Self {
        Self { origin, direction, t_max: T::INFINITY }
    }

    /// A `t` up to which the ray has met everything it meets inside the box, for an origin inside: where it leaves, and
    /// a little more, so that a hit on the box's very face is not lost to the rounding of either distance.
    pub fn exit_from(&self, aabb: &Aabb<T>) -> T {
        let margin = aabb.reach_from(&self.origin) * margins::margin(margins::RAY_END);
        let mut exit = T::INFINITY;
        for axis in 0..3 {
            let (origin, direction) = (self.origin[axis], self.direction[axis]);
            if direction > T::zero() {
                exit = exit.min((aabb.upper[axis] - origin + margin) / direction);
            } else if direction < T::zero() {
                exit = exit.min((aabb.lower[axis] - origin - margin) / direction);
            }
        }
        exit
    }

    /// The same ray, ending at `t_max`.
    pub fn until(self, t_max: T) -> Self {
        Self { t_max, ..self }
    }
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit<T: Scalar> {
    /// The triangle's index in its mesh.
    pub triangle: u32,
    /// The point is `origin + t · direction`.
    pub t: T,
    /// Barycentric weights of the point at the triangle's three corners; they sum to 1.
    pub weights: [T; 3],
    /// True where the ray meets the triangle from inside (ray · normal > 0), false where it enters.
    pub is_exit: bool,
}

impl<T: Scalar> Hit<T> {
    /// Whether this hit comes before `other` along the ray; at equal `t` the smaller triangle index does.
    pub fn is_before(&self, other: &Self) -> bool {
        self.t < other.t || (self.t == other.t && self.triangle < other.triangle)
    }
}

/// Which test decides whether a ray meets a triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TriangleTest {
    /// Woop, Benthin and Wald 2013: no ray slips through a shared edge or vertex.
    #[default]
    Watertight,
    /// Möller and Trumbore 1997: the paper's test. Rays aimed at edges and vertices may leak.
    MollerTrumbore,
}

/// A ray made ready for many triangle tests.
#[derive(Clone, Copy, Debug)]
pub enum PreparedRay<T: Scalar> {
    /// For [`TriangleTest::Watertight`].
    Watertight(ShearedRay<T>),
    /// For [`TriangleTest::MollerTrumbore`].
    MollerTrumbore(Ray<T>),
}

impl<T: Scalar> PreparedRay<T> {
    /// Prepares `ray` for `test`.
    pub fn new(ray: &Ray<T>, test: TriangleTest) -> Self {
        match test {
            TriangleTest::Watertight => Self::Watertight(ShearedRay::new(ray)),
            TriangleTest::MollerTrumbore => Self::MollerTrumbore(*ray),
        }
    }

    /// The hit on the triangle with these corners, wherever along the ray's full line `t` ≥ 0 it lies.
    pub fn intersect(&self, corners: &[Vector3<T>; 3], triangle: u32) -> Option<Hit<T>> {
        match self {
            Self::Watertight(ray) => ray.intersect(corners, triangle),
            Self::MollerTrumbore(ray) => moller_trumbore(ray, corners, triangle),
        }
    }
}
