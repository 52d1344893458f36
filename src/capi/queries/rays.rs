use super::octree::{AnyOctree, rayc_octree};
use crate::capi::base::rayc_status;
use crate::capi::ffi::{Failure, Output, check_numbers, glancing, guard, reading, slice, with_precision};
use crate::capi::mesh::{AnyMesh, rayc_mesh};
use crate::math::{Scalar, Vector3};
use crate::memory::text;
use crate::mesh::Mesh;
use crate::query::{Octree, Tracer};
use crate::triangle::{Hit, Ray};

/// Stands where a triangle's number would be and there is no triangle: a ray that meets nothing, no surface within a
/// bound.
pub const RAYC_NO_TRIANGLE: u32 = u32::MAX;

/// A half line, cut at t_max.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_ray {
    /// Where it starts (t = 0); finite, also as a float where the mesh is one of floats.
    pub origin: [f64; 3],
    /// Where it goes; finite and not zero, also as floats where the mesh is one of floats; need not be of unit length. t
    /// counts multiples of it.
    pub direction: [f64; 3],
    /// Hits beyond this t do not count. ≥ 0; may be infinite.
    pub t_max: f64,
}

/// Where a ray first meets a mesh.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_hit {
    /// The triangle, or RAYC_NO_TRIANGLE for a miss; the other fields are then zero. At equal t, the smallest number.
    pub triangle: u32,
    /// 1 where the ray leaves the body (ray · normal > 0), 0 where it enters.
    pub is_exit: u32,
    /// The point is origin + t · direction.
    pub t: f64,
    /// Barycentric weights of the point at the triangle's three corners.
    pub weights: [f64; 3],
}

/// Traces one ray. *hit is where it first meets the mesh, from either side. The triangle test is watertight (Woop,
/// Benthin, Wald 2013): a ray through a shared edge or vertex hits. Many threads may trace single rays at once
/// without waiting for each other, because these calls are not counted as users of the handles. So a call that
/// changes the octree or the mesh at the same time is not refused with RAYC_STATUS_BUSY. Do not make one.
///
/// Errors: RAYC_STATUS_OCTREE_STALE, RAYC_STATUS_OCTREE_OF_OTHER_MESH, RAYC_STATUS_PRECISION_MISMATCH,
/// RAYC_STATUS_NOT_FINITE, RAYC_STATUS_MESH_BEYOND_RANGE and RAYC_STATUS_INVALID_OPTION for the ray.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_octree_trace_ray(
    octree: *const rayc_octree,
    mesh: *const rayc_mesh,
    ray: *const rayc_ray,
    hit: *mut rayc_hit,
) -> rayc_status {
    guard(|| {
        let (octree, mesh) = (&glancing(octree, "octree")?.octree, &glancing(mesh, "mesh")?.mesh);
        trace_all(octree, mesh, slice(ray, 1, "ray")?, Output::new(hit, "hit")?)
    })
}

/// Traces `count` rays; `hits[i]` is where `rays[i]` first meets the mesh. See rayc_octree_trace_ray(). It is fastest
/// where every sixteen rays in a row are neighbours.
///
/// Errors: as there; the message names the ray, and no hit is written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_octree_trace_rays(
    octree: *const rayc_octree,
    mesh: *const rayc_mesh,
    rays: *const rayc_ray,
    count: usize,
    hits: *mut rayc_hit,
) -> rayc_status {
    guard(|| {
        let (octree, mesh) = (reading(octree, "octree")?, reading(mesh, "mesh")?);
        let (rays, hits) = (slice(rays, count, "rays")?, Output::array(hits, count, "hits")?);
        trace_all(&octree.octree, &mesh.mesh, rays, hits)
    })
}

/// # Safety
/// `hits` has room for one hit per ray.
unsafe fn trace_all(
    octree: &AnyOctree,
    mesh: &AnyMesh,
    rays: &[rayc_ray],
    hits: Output<rayc_hit>,
) -> Result<(), Failure> {
    with_precision!(octree, mesh, |octree, mesh| trace_into(octree, mesh, rays, hits))
}

/// So many rays are copied at a time: with their hits they take 30 KB of stack.
const RAYS_AT_ONCE: usize = 256;

/// # Safety
/// `hits` has room for one hit per ray.
unsafe fn trace_into<T: Scalar>(
    octree: &Octree<T>,
    mesh: &Mesh<T>,
    rays: &[rayc_ray],
    hits: Output<rayc_hit>,
) -> Result<(), Failure> {
    rays.iter().enumerate().try_for_each(|(index, ray)| check_ray::<T>(index, ray))?;
    let tracer = octree.tracer(mesh)?;
    match rays {
        [ray] => tracer.nearest_hit_of(ray, |hit| hits.write_from(0, [hit_of(&hit)].into_iter())),
        _ => trace_many(&tracer, rays, hits),
    }
    Ok(())
}

/// Apart from what a single ray needs: a large stack takes time to set up.
///
/// # Safety
/// As [`trace_into`].
#[inline(never)]
unsafe fn trace_many<T: Scalar>(tracer: &Tracer<T>, rays: &[rayc_ray], hits: Output<rayc_hit>) {
    let none = Ray::new(Vector3::zeros(), Vector3::zeros());
    let (mut chunk, mut found) = ([none; RAYS_AT_ONCE], [None; RAYS_AT_ONCE]);
    for (number, rays) in rays.chunks(RAYS_AT_ONCE).enumerate() {
        let (chunk, found) = (&mut chunk[..rays.len()], &mut found[..rays.len()]);
        chunk.iter_mut().zip(rays).for_each(|(place, ray)| *place = ray.into());
        tracer.nearest_hits_into(chunk, found);
        hits.write_from(number * RAYS_AT_ONCE, found.iter().map(hit_of));
    }
}

impl<T: Scalar> From<&rayc_ray> for Ray<T> {
    #[inline]
    fn from(&rayc_ray { origin: [x, y, z], direction: [u, v, w], t_max }: &rayc_ray) -> Self {
        Self {
            origin: Vector3::new(T::of(x), T::of(y), T::of(z)),
            direction: Vector3::new(T::of(u), T::of(v), T::of(w)),
            t_max: T::of(t_max),
        }
    }
}

fn hit_of<T: Scalar>(hit: &Option<Hit<T>>) -> rayc_hit {
    let miss = rayc_hit { triangle: RAYC_NO_TRIANGLE, is_exit: 0, t: 0.0, weights: [0.0; 3] };
    hit.map_or(miss, |hit| rayc_hit {
        triangle: hit.triangle,
        is_exit: u32::from(hit.is_exit),
        t: hit.t.to_f64(),
        weights: hit.weights.map(T::to_f64),
    })
}

fn check_ray<T: Scalar>(index: usize, ray: &rayc_ray) -> Result<(), Failure> {
    let ([x, y, z], [u, v, w], zero) = (ray.origin.map(T::of), ray.direction.map(T::of), T::zero());
    // NaN where one of them is not finite in the mesh's precision.
    let nothing = zero * x + zero * y + zero * z + zero * u + zero * v + zero * w;
    if nothing == zero && u.abs() + v.abs() + w.abs() > zero && ray.t_max >= 0.0 {
        return Ok(());
    }
    check_numbers::<T>(&ray.origin, format_args!("ray {index}: its origin"))?;
    check_numbers::<T>(&ray.direction, format_args!("ray {index}: its direction"))?;
    let failure = |what: &str| Err(Failure::new(rayc_status::RAYC_STATUS_INVALID_OPTION, text!("ray {index}: {what}")));
    if ray.direction.iter().all(|&x| T::of(x) == T::zero()) {
        return failure("its direction is zero in the mesh's precision; give it a length");
    }
    if ray.t_max.is_nan() || ray.t_max < 0.0 {
        return failure("t_max is negative or NaN; give it ≥ 0, or infinity");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::test_mesh::{torus_at, torus_positions};

    const SIDES: [u32; 2] = [40, 16];

    /// Rays through the torus from far away, neighbours first, then from anywhere to anywhere.
    fn rays(count: usize) -> Vec<rayc_ray> {
        let points = torus_positions(SIDES, 1);
        let ray = |number: usize| {
            let (target, other) = (points[number % 600], points[number * 389 % 600]);
            let origin = if number < count / 2 { [4.0, -6.0, 5.0] } else { other };
            let direction = [0, 1, 2].map(|axis| target[axis] * 0.99 - origin[axis]);
            rayc_ray { origin, direction, t_max: if number.is_multiple_of(3) { 0.97 } else { f64::INFINITY } }
        };
        (0..count).map(ray).collect()
    }

    fn assert_as_every_triangle<T: Scalar>(count: usize) {
        let mesh: Mesh<T> = torus_at(SIDES, 1);
        let octree = Octree::new(&mesh);
        let tracer = octree.tracer(&mesh).expect("it is new");
        let rays = rays(count);
        let mut hits = vec![hit_of::<T>(&None); count];
        // SAFETY: there is a hit for each ray.
        unsafe {
            let place = Output::array(hits.as_mut_ptr(), count, "hits").expect("it is not NULL");
            trace_into(&octree, &mesh, &rays, place).expect("all is good");
        }
        let numbers = |hit: &rayc_hit| (hit.triangle, hit.is_exit, hit.t.to_bits(), hit.weights.map(f64::to_bits));
        for (ray, hit) in rays.iter().zip(&hits) {
            assert_eq!(numbers(hit), numbers(&hit_of(&tracer.nearest_hit_of_all(&Ray::from(ray)))), "of {count}");
        }
        let met = hits.iter().filter(|hit| hit.triangle != RAYC_NO_TRIANGLE).count();
        assert!(count < 9 || (count / 4..count).contains(&met), "{met} of {count} meet the torus");
    }

    #[test]
    fn rays_together_and_alone_have_the_hits_of_every_triangle() {
        // One ray, a part of a packet, and chunks with rests of either kind.
        for count in [0, 1, 2, 16, 9, RAYS_AT_ONCE, 3 * RAYS_AT_ONCE + 21] {
            assert_as_every_triangle::<f64>(count);
            assert_as_every_triangle::<f32>(count);
        }
    }
}
