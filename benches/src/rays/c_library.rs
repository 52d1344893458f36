//! The C library, as a program would call it that knows nothing of Rust.

use super::kinds::Ray;
use crate::workload::Body;
use std::ffi::{OsStr, c_void};
use std::mem::ManuallyDrop;
use std::ptr::null_mut;

/// As `rayc_vectors`.
#[repr(C)]
struct Vectors {
    data: *const c_void,
    count: usize,
    stride: usize,
    scalar: u32,
}

/// As `rayc_mesh_options`.
#[repr(C)]
struct MeshOptions {
    struct_size: usize,
    precision: u32,
    open: u32,
}

/// As `rayc_ray`.
#[repr(C)]
pub struct CRay {
    origin: [f64; 3],
    direction: [f64; 3],
    t_max: f64,
}

/// As `rayc_hit`.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct CHit {
    pub triangle: u32,
    pub is_exit: u32,
    pub t: f64,
    pub weights: [f64; 3],
}

const F32: u32 = 1;
const F64: u32 = 2;

type CreateMesh = unsafe extern "C" fn(*const MeshOptions, *const Vectors, *const u32, usize, *mut *mut c_void) -> i32;
type DestroyMesh = unsafe extern "C" fn(*mut c_void) -> i32;
type CreateOctree = unsafe extern "C" fn(*const c_void, *const c_void, *mut *mut c_void) -> i32;
type TraceRay = unsafe extern "C" fn(*const c_void, *const c_void, *const CRay, *mut CHit) -> i32;
type TraceRays = unsafe extern "C" fn(*const c_void, *const c_void, *const CRay, usize, *mut CHit) -> i32;

struct Functions {
    create_mesh: CreateMesh,
    destroy_mesh: DestroyMesh,
    create_octree: CreateOctree,
    destroy_octree: DestroyMesh,
    trace_ray: TraceRay,
    trace_rays: TraceRays,
}

pub struct Library(Functions);

impl Library {
    pub fn open(path: &OsStr) -> Result<Self, String> {
        let failed = |error: libloading::Error| {
            format!("cannot open the C library at {}: {error}; 'cargo build --release' makes it", path.display())
        };
        // SAFETY: the functions have the types above.
        unsafe {
            let library = ManuallyDrop::new(libloading::Library::new(path).map_err(failed)?);
            Ok(Self(Functions {
                create_mesh: *library.get::<CreateMesh>(b"rayc_mesh_create").map_err(failed)?,
                destroy_mesh: *library.get::<DestroyMesh>(b"rayc_mesh_destroy").map_err(failed)?,
                create_octree: *library.get::<CreateOctree>(b"rayc_octree_create").map_err(failed)?,
                destroy_octree: *library.get::<DestroyMesh>(b"rayc_octree_destroy").map_err(failed)?,
                trace_ray: *library.get::<TraceRay>(b"rayc_octree_trace_ray").map_err(failed)?,
                trace_rays: *library.get::<TraceRays>(b"rayc_octree_trace_rays").map_err(failed)?,
            }))
        }
    }
}

/// A mesh and its octree.
pub struct Surface<'a> {
    functions: &'a Functions,
    mesh: *mut c_void,
    octree: *mut c_void,
}

impl<'a> Surface<'a> {
    pub fn new(library: &'a Library, positions: &[[f32; 3]], body: &Body, is_double: bool) -> Result<Self, String> {
        let functions = &library.0;
        let precision = if is_double { F64 } else { F32 };
        let options = MeshOptions { struct_size: size_of::<MeshOptions>(), precision, open: 0 };
        let data = positions.as_ptr().cast();
        let vectors = Vectors { data, count: positions.len(), stride: 0, scalar: F32 };
        let mut surface = Self { functions, mesh: null_mut(), octree: null_mut() };
        let triangles = &body.triangles;
        // SAFETY: all arrays are as long as is said.
        let statuses = unsafe {
            let first = triangles.as_ptr().cast();
            let mesh = (functions.create_mesh)(&options, &vectors, first, triangles.len(), &mut surface.mesh);
            [mesh, if mesh == 0 { (functions.create_octree)(std::ptr::null(), surface.mesh, &mut surface.octree) } else { 0 }]
        };
        if statuses == [0, 0] { Ok(surface) } else { Err(format!("the C library refuses a surface: {statuses:?}")) }
    }

    pub fn trace_one_by_one(&self, rays: &[CRay], hits: &mut [CHit]) {
        for (ray, hit) in rays.iter().zip(hits) {
            // SAFETY: the handles live.
            let status = unsafe { (self.functions.trace_ray)(self.octree, self.mesh, ray, hit) };
            assert_eq!(status, 0, "the ray is good");
        }
    }

    pub fn trace_together(&self, rays: &[CRay], hits: &mut [CHit]) {
        assert_eq!(rays.len(), hits.len());
        let (first, count) = (rays.as_ptr(), rays.len());
        // SAFETY: the handles live, and there is a hit for each ray.
        let status = unsafe { (self.functions.trace_rays)(self.octree, self.mesh, first, count, hits.as_mut_ptr()) };
        assert_eq!(status, 0, "the rays are good");
    }
}

impl Drop for Surface<'_> {
    fn drop(&mut self) {
        // SAFETY: they are not used again; null does nothing.
        unsafe {
            (self.functions.destroy_octree)(self.octree);
            (self.functions.destroy_mesh)(self.mesh);
        }
    }
}

impl From<&Ray> for CRay {
    fn from(ray: &Ray) -> Self {
        Self { origin: ray.origin.map(f64::from), direction: ray.direction.map(f64::from), t_max: f64::INFINITY }
    }
}
