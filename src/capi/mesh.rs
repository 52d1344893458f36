//! One body's surface: made from arrays or from a file, given new positions, read back.

use crate::capi::base::{rayc_scalar, rayc_status, rayc_vectors, rayc_vectors_mut};
use crate::capi::ffi::{
    Failure, Handle, HandleKind, InPrecision, Options, Output, Strided, changing, check_length, flag, give, growing,
    guard, guard_end, mesh_status, read_options, reading, reference, scalar_from, set_positions, slice, take_back,
    with_precision, write_defaults,
};
use crate::math::Scalar;
use crate::memory::{self, text};
use crate::mesh::{Hole, InFile, Mesh, MeshError, read_obj_surface};
use libc::c_char;
use std::ffi::CStr;
use std::path::Path;

/// One triangle surface. Its topology is fixed; its positions are renewed each step. The surface is closed unless the
/// options allow a border, and its triangles are counter-clockwise seen from outside. Vertices that no triangle uses
/// are allowed, such as the inner nodes of a volume mesh.
///
/// Threads: several threads may make calls with a const mesh at the same time. A call that changes the mesh must run
/// alone. The caller frees the mesh with rayc_mesh_destroy(); octrees and scenes made from it do not need it any more.
pub struct rayc_mesh {
    pub(super) mesh: AnyMesh,
}

impl Handle for rayc_mesh {
    const KIND: HandleKind = HandleKind::MESH;
}

/// A mesh of either precision.
pub(super) type AnyMesh = InPrecision<Mesh<f32>, Mesh<f64>>;

impl AnyMesh {
    /// `failure` makes a message of what is wrong with the surface.
    fn new(
        options: &rayc_mesh_options,
        positions: &Strided,
        triangles: &[[u32; 3]],
        failure: impl Fn(MeshError) -> Failure,
    ) -> Result<Self, Failure> {
        fn make<T: Scalar>(
            open: bool,
            close_holes: f64,
            positions: &Strided,
            triangles: &[[u32; 3]],
        ) -> Result<Mesh<T>, MeshError> {
            let read = read_all(positions);
            let made = if open {
                Mesh::open(&read, triangles)
            } else if close_holes == 0.0 {
                Mesh::new(&read, triangles)
            } else {
                Mesh::closing_holes(&read, triangles, close_holes)
            };
            made.map_err(|error| before_conversion::<T>(error, positions))
        }
        let (open, holes) = (flag("open", options.open)?, options.close_holes);
        if open && holes != 0.0 {
            let message = text!("open is 1 and close_holes is {holes}; leave one of them 0");
            return Err(Failure::new(rayc_status::RAYC_STATUS_INVALID_OPTION, message));
        }
        Ok(match scalar_from(options.precision, "precision")? {
            rayc_scalar::RAYC_SCALAR_F32 => Self::F32(make(open, holes, positions, triangles).map_err(failure)?),
            rayc_scalar::RAYC_SCALAR_F64 => Self::F64(make(open, holes, positions, triangles).map_err(failure)?),
        })
    }

    pub(super) fn topology(&self) -> &crate::mesh::Topology {
        with_precision!(self, |mesh| mesh.topology())
    }
}

/// How a mesh is kept. Fill with rayc_default_mesh_options(), then change what you need.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_mesh_options {
    /// sizeof(rayc_mesh_options): lets the struct grow without breaking programs built earlier.
    pub struct_size: usize,
    /// Arithmetic of detection, a rayc_scalar. Default RAYC_SCALAR_F64.
    pub precision: u32,
    /// 1: the surface may be open, with edges that belong to one triangle only: a floor, a wall, a piece of
    /// cloth. It is solid behind its triangles. A point of a closed body that lies behind it, and whose inward
    /// ray leaves through it, gives a contact; so does a point of it inside a closed body. Limits: a body that is
    /// more than half behind the surface is pushed less and less, and not at all once it is through or beyond the
    /// border; no edges are traced, and the pair never escapes; two open meshes do not collide. Such pairs are
    /// counted as open_pairs in rayc_statistics. 0: an open surface is refused, or closed by close_holes. Default 0.
    pub open: u32,
    /// Above 0: holes are closed by triangles over the vertices around them, those of the least area. No vertex is
    /// added, so forces act on the vertices that were given. The triangles come behind those that were given, and
    /// move with their vertices; rayc_mesh_copy_holes() lists them. The value is the largest part of the given area
    /// of each connected part that its caps may have together, up to 1, so that no sheet is taken for a body: 0.1
    /// suits scans. RAYC_STATUS_MESH_OPEN where a hole is larger, has more than 1000 vertices around it, shares a
    /// vertex with another, or cannot be closed by triangles that have an area, and where duplicate vertices form
    /// a seam; the message says which and where. 0: a surface with a hole is refused. Default 0.
    pub close_holes: f64,
}

growing!(rayc_mesh_options, precision: u32);

impl Options for rayc_mesh_options {
    fn defaults() -> Self {
        Self {
            struct_size: size_of::<Self>(),
            precision: rayc_scalar::RAYC_SCALAR_F64 as u32,
            open: 0,
            close_holes: 0.0,
        }
    }
}

/// Fills `options` with the defaults. struct_size: sizeof(rayc_mesh_options).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_default_mesh_options(struct_size: usize, options: *mut rayc_mesh_options) -> rayc_status {
    guard(|| write_defaults(struct_size, options))
}

/// Checks and copies a surface.
///
/// options: NULL for the defaults. positions: one for each vertex, finite, in metres (or any one unit of length).
/// triangles: 3 · triangle_count vertex numbers, from 0. *mesh: the new handle.
///
/// Errors: every fault of the surface has its own status (RAYC_STATUS_MESH_…, RAYC_STATUS_NOT_FINITE);
/// RAYC_STATUS_OUT_OF_MEMORY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_mesh_create(
    options: *const rayc_mesh_options,
    positions: *const rayc_vectors,
    triangles: *const u32,
    triangle_count: usize,
    mesh: *mut *mut rayc_mesh,
) -> rayc_status {
    guard(|| {
        let options = read_options(options)?;
        let positions = Strided::new(reference(positions, "positions")?, "positions")?;
        let triangles = slice(triangles.cast::<[u32; 3]>(), triangle_count, "triangles")?;
        let place = Output::new(mesh, "mesh")?;
        give(place, rayc_mesh { mesh: AnyMesh::new(&options, &positions, triangles, Failure::from)? })
    })
}

/// Reads a surface from a Wavefront .obj file: vertices in the file's order, faces of all objects together, polygons cut
/// into triangle fans. Messages count lines and vertices from 1, as the file does.
///
/// options: NULL for the defaults. path: UTF-8, ended by zero. *mesh: the new handle.
///
/// Errors: RAYC_STATUS_FILE_NOT_READABLE, RAYC_STATUS_FILE_BROKEN, and those of rayc_mesh_create().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_mesh_create_from_obj(
    options: *const rayc_mesh_options,
    path: *const c_char,
    mesh: *mut *mut rayc_mesh,
) -> rayc_status {
    guard(|| {
        let options = read_options(options)?;
        let path = CStr::from_ptr(reference(path, "path")?).to_str().map_err(|_| {
            Failure::new(rayc_status::RAYC_STATUS_FILE_NOT_READABLE, "path is not UTF-8; pass it encoded so")
        })?;
        let place = Output::new(mesh, "mesh")?;
        let surface = read_obj_surface(Path::new(path))?;
        let positions = rayc_vectors {
            data: surface.positions.as_ptr().cast(),
            count: surface.positions.len(),
            stride: 0,
            scalar: rayc_scalar::RAYC_SCALAR_F64 as u32,
        };
        let failure = |error: MeshError| {
            let message = InFile { error: &error, surface: &surface };
            Failure::new(mesh_status(&error), text!("{path}: {message}"))
        };
        let mesh = AnyMesh::new(&options, &Strided::new(&positions, "positions")?, &surface.triangles, failure)?;
        give(place, rayc_mesh { mesh })
    })
}

/// Renews the positions of all vertices. Octrees of this mesh are stale from here on.
///
/// Errors: RAYC_STATUS_WRONG_COUNT, RAYC_STATUS_NOT_FINITE, RAYC_STATUS_MESH_BEYOND_RANGE; the positions are then as
/// before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_mesh_set_positions(mesh: *mut rayc_mesh, positions: *const rayc_vectors) -> rayc_status {
    guard(|| {
        let positions = Strided::new(reference(positions, "positions")?, "positions")?;
        with_precision!(&mut changing(mesh, "mesh")?.mesh, |mesh| renew_positions(mesh, &positions))
    })
}

/// Frees a mesh; NULL does nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_mesh_destroy(mesh: *mut rayc_mesh) -> rayc_status {
    guard_end(|| take_back(mesh, "mesh"))
}

fn read_all<T: Scalar>(vectors: &Strided) -> Vec<[T; 3]> {
    memory::listed((0..vectors.count()).map(|index| vectors.read::<T>(index).into()))
}

pub(super) fn renew_positions<T: Scalar>(mesh: &mut Mesh<T>, positions: &Strided) -> Result<(), Failure> {
    Ok(set_positions(mesh, positions).map_err(|error| before_conversion::<T>(error, positions))?)
}

/// Tells a coordinate that was finite before it was made a float from one that was not.
fn before_conversion<T: Scalar>(error: MeshError, positions: &Strided) -> MeshError {
    let MeshError::NotFinite { vertex, .. } = error else { return error };
    let given = positions.read::<f64>(vertex);
    match given.iter().find(|&&x| x.is_finite() && !T::of(x).is_finite()) {
        Some(&value) if given.iter().all(|x| x.is_finite()) => {
            MeshError::BeyondRange { vertex, value, largest: T::LARGEST.to_f64() }
        }
        _ => error,
    }
}

/// How many vertices the mesh has, used by triangles or not.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_mesh_vertex_count(mesh: *const rayc_mesh, count: *mut usize) -> rayc_status {
    guard(|| {
        let mesh = reading(mesh, "mesh")?;
        Output::new(count, "count")?.write(mesh.mesh.topology().vertex_count())
    })
}

/// How many triangles the mesh has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_mesh_triangle_count(mesh: *const rayc_mesh, count: *mut usize) -> rayc_status {
    guard(|| {
        let mesh = reading(mesh, "mesh")?;
        Output::new(count, "count")?.write(mesh.mesh.topology().triangles().len())
    })
}

/// Copies the present positions to `positions`, whose count must be the mesh's.
///
/// Errors: RAYC_STATUS_WRONG_COUNT.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_mesh_copy_positions(
    mesh: *const rayc_mesh,
    positions: *const rayc_vectors_mut,
) -> rayc_status {
    fn copy<T: Scalar>(mesh: &Mesh<T>, to: &mut Strided) -> Result<(), Failure> {
        check_length("positions", to.count(), mesh.topology().vertex_count())?;
        mesh.positions().iter().enumerate().for_each(|(vertex, position)| to.write(vertex, position));
        Ok(())
    }
    guard(|| {
        let mut positions = Strided::new_mut(reference(positions, "positions")?, "positions")?;
        with_precision!(&reading(mesh, "mesh")?.mesh, |mesh| copy(mesh, &mut positions))
    })
}

/// Copies the triangles' vertex numbers to `triangles`; index_count must be 3 · the number of triangles.
///
/// Errors: RAYC_STATUS_WRONG_COUNT.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_mesh_copy_triangles(
    mesh: *const rayc_mesh,
    index_count: usize,
    triangles: *mut u32,
) -> rayc_status {
    guard(|| {
        let mesh = reading(mesh, "mesh")?;
        let indices = mesh.mesh.topology().triangles().as_flattened();
        Output::exactly(triangles, index_count, indices.len(), "triangles")?.write_all(indices.iter().copied())
    })
}

/// A hole that was closed when its mesh was made; see close_holes of rayc_mesh_options.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_hole {
    /// The first triangle of its cap.
    pub first_triangle: u32,
    /// How many triangles the cap has. Their corners are the vertices around the hole, two more than triangles.
    pub triangle_count: u32,
    /// The area of the cap, as a part of the given area of the connected part that has the hole.
    pub area_share: f64,
}

/// How many holes were closed when the mesh was made.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_mesh_hole_count(mesh: *const rayc_mesh, count: *mut usize) -> rayc_status {
    guard(|| {
        let mesh = reading(mesh, "mesh")?;
        Output::new(count, "count")?.write(with_precision!(&mesh.mesh, |mesh| mesh.holes().len()))
    })
}

/// Copies what was closed when the mesh was made to `holes`; count must be that of rayc_mesh_hole_count().
///
/// Errors: RAYC_STATUS_WRONG_COUNT.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_mesh_copy_holes(
    mesh: *const rayc_mesh,
    count: usize,
    holes: *mut rayc_hole,
) -> rayc_status {
    guard(|| {
        let mesh = reading(mesh, "mesh")?;
        let closed = with_precision!(&mesh.mesh, |mesh| mesh.holes());
        let exported = closed.iter().map(|&Hole { first_triangle, triangle_count, area_share }| rayc_hole {
            first_triangle,
            triangle_count,
            area_share,
        });
        Output::exactly(holes, count, closed.len(), "holes")?.write_all(exported)
    })
}
