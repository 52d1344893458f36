use crate::math::{Scalar, Vector3};
use crate::triangle::moller_trumbore::moller_trumbore;
use crate::triangle::ray::{Hit, Ray};
use crate::triangle::watertight::ShearedRay;

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
