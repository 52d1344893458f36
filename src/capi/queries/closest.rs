use super::octree::rayc_octree;
use super::rays::RAYC_NO_TRIANGLE;
use crate::capi::base::{rayc_status, rayc_vectors};
use crate::capi::ffi::{Failure, Output, Strided, check_numbers, guard, reading, reference, slice, with_precision};
use crate::capi::mesh::rayc_mesh;
use crate::math::{Scalar, Vector3};
use crate::memory::{self, text};
use crate::mesh::Mesh;
use crate::query::Octree;
use crate::triangle::ClosestPoint;

/// The point of a surface that is nearest to a given one.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_closest_point {
    /// The triangle it lies on, or RAYC_NO_TRIANGLE where none is within the bound; the other fields are then zero. Of
    /// several as near, the one with the smallest number.
    pub triangle: u32,
    /// 1 where there is one, 0 where there is none.
    pub is_found: u32,
    /// How far it is from the given point; ≥ 0.
    pub distance: f64,
    /// Barycentric weights at the triangle's three corners: none is negative, and those of corners that are not on the
    /// point's edge or vertex are exactly zero.
    pub weights: [f64; 3],
    /// Where it is: the weighted sum of the corners.
    pub position: [f64; 3],
}

/// Finds the points of the surface, open or closed, that are nearest to some points: `closest[i]` for point i.
///
/// points: finite, anywhere, in the mesh's unit of length.
/// bounds: NULL, or for each point how far away the surface may be to count, ≥ 0 or infinite: a tight one saves time.
/// closest: room for points->count structs.
///
/// Distances are right to within 64 rounding units (2⁻²⁴ of float, 2⁻⁵³ of double meshes) of the largest coordinate difference
/// between the point and the mesh's box, however thin the triangles. With rayc_octree_winding_numbers() they make signed
/// distances: negative where that number is not zero.
///
/// Errors: RAYC_STATUS_OCTREE_STALE, RAYC_STATUS_OCTREE_OF_OTHER_MESH, RAYC_STATUS_PRECISION_MISMATCH,
/// RAYC_STATUS_NOT_FINITE, RAYC_STATUS_MESH_BEYOND_RANGE and, for a bound, RAYC_STATUS_INVALID_OPTION, with a message that
/// names the point, and those of the array: RAYC_STATUS_INVALID_STRIDE, RAYC_STATUS_UNKNOWN_ENUM.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_octree_closest_points(
    octree: *const rayc_octree,
    mesh: *const rayc_mesh,
    points: *const rayc_vectors,
    bounds: *const f64,
    closest: *mut rayc_closest_point,
) -> rayc_status {
    /// # Safety
    /// There is room for one struct for each point.
    unsafe fn find<T: Scalar>(
        octree: &Octree<T>,
        mesh: &Mesh<T>,
        points: &Strided,
        bounds: Option<&[f64]>,
        closest: Output<rayc_closest_point>,
    ) -> Result<(), Failure> {
        let tracer = octree.tracer(mesh)?;
        let points = read_points::<T>(points)?;
        let bound = |index: usize| T::of(bounds.map_or(f64::INFINITY, |bounds| bounds[index]));
        let bounds = memory::listed((0..points.len()).map(bound));
        let mut found = Vec::new();
        tracer.closest_points(&points, &bounds, &mut found);
        closest.write_all(found.iter().map(closest_point))
    }
    guard(|| {
        let (octree, mesh) = (reading(octree, "octree")?, reading(mesh, "mesh")?);
        let points = Strided::new(reference(points, "points")?, "points")?;
        let bounds = if bounds.is_null() { None } else { Some(slice(bounds, points.count(), "bounds")?) };
        check_bounds(bounds.unwrap_or_default())?;
        let closest = Output::array(closest, points.count(), "closest")?;
        with_precision!(&octree.octree, &mesh.mesh, |octree, mesh| find(octree, mesh, &points, bounds, closest))
    })
}

/// Counts how often a closed surface winds around some points: `numbers[i]` for point i; 0 outside, 1 inside, more where the
/// surface folds over itself, negative where it is inside out.
///
/// points: finite, anywhere. numbers: room for points->count numbers. The count is exact, through edges and vertices
/// too. A point on the surface, or so near that rounding decides, has the number of one of its sides. Where coordinates
/// differ by more than 10¹⁹ (float meshes) or 10¹⁵⁴ (double), the numbers may be wrong.
///
/// Errors: RAYC_STATUS_MESH_OPEN, since an open surface has no inside; and those of rayc_octree_closest_points().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_octree_winding_numbers(
    octree: *const rayc_octree,
    mesh: *const rayc_mesh,
    points: *const rayc_vectors,
    numbers: *mut i32,
) -> rayc_status {
    /// # Safety
    /// There is room for one number for each point.
    unsafe fn count<T: Scalar>(
        octree: &Octree<T>,
        mesh: &Mesh<T>,
        points: &Strided,
        numbers: Output<i32>,
    ) -> Result<(), Failure> {
        let tracer = octree.tracer(mesh)?;
        let open = || {
            let message = "the mesh is open, so it has no inside; close it, or ask for distances alone";
            Failure::new(rayc_status::RAYC_STATUS_MESH_OPEN, message)
        };
        let mut counted = Vec::new();
        tracer.winding_numbers(&read_points::<T>(points)?, &mut counted);
        // Points are finite.
        let counted = memory::tried(counted.into_iter().map(|number| number.ok_or_else(open)))?;
        numbers.write_all(counted.into_iter())
    }
    guard(|| {
        let (octree, mesh) = (reading(octree, "octree")?, reading(mesh, "mesh")?);
        let points = Strided::new(reference(points, "points")?, "points")?;
        let numbers = Output::array(numbers, points.count(), "numbers")?;
        with_precision!(&octree.octree, &mesh.mesh, |octree, mesh| count(octree, mesh, &points, numbers))
    })
}

/// All points, as the mesh's numbers.
fn read_points<T: Scalar>(points: &Strided) -> Result<Vec<Vector3<T>>, Failure> {
    memory::tried((0..points.count()).map(|index| {
        let point = points.read::<f64>(index);
        check_numbers::<T>(point.as_slice(), format_args!("point {index}"))?;
        Ok(point.map(T::of))
    }))
}

fn check_bounds(bounds: &[f64]) -> Result<(), Failure> {
    match bounds.iter().position(|bound| bound.is_nan() || *bound < 0.0) {
        None => Ok(()),
        Some(index) => {
            let message = text!("point {index}: its bound is negative or NaN; give it ≥ 0, or infinity");
            Err(Failure::new(rayc_status::RAYC_STATUS_INVALID_OPTION, message))
        }
    }
}

pub(super) fn closest_point<T: Scalar>(found: &Option<ClosestPoint<T>>) -> rayc_closest_point {
    match found {
        None => rayc_closest_point {
            triangle: RAYC_NO_TRIANGLE,
            is_found: 0,
            distance: 0.0,
            weights: [0.0; 3],
            position: [0.0; 3],
        },
        Some(found) => rayc_closest_point {
            triangle: found.triangle,
            is_found: 1,
            distance: found.distance.to_f64(),
            weights: found.weights.map(T::to_f64),
            position: found.position.map(T::to_f64).into(),
        },
    }
}
