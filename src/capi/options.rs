use super::failure::{Failure, rayc_status, unknown_enum};
use super::guard::guard;
use super::host_threads::rayc_parallel_for;
use super::pointers::{Output, reference};
use super::vectors::rayc_scalar;
use crate::contact::{ContactLaw, DetectionOptions, Sampling};
use crate::math::Scalar;
use crate::memory::text;
use crate::response::{PenaltyLaw, Weighting};
use libc::c_void;

/// How a mesh is kept. Fill with rayc_default_mesh_options(), then change what you need.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_mesh_options {
    /// sizeof(rayc_mesh_options): lets the struct grow without breaking programs built earlier.
    pub struct_size: usize,
    /// Arithmetic of detection, a rayc_scalar. Default RAYC_SCALAR_F64.
    pub precision: u32,
    /// 1: the surface may be open, with edges that belong to one triangle only: a floor, a wall, a piece of cloth. It is
    /// solid behind its triangles. A point of a closed body behind it whose inward ray leaves through it gives a contact,
    /// and so does a point of it inside a closed body. Not promised: a body more than half behind it is pushed less and
    /// less, and not at all when it is through or beyond the border; no edges are traced and the pair never escapes; two
    /// open meshes do not collide. Such pairs are counted as open_pairs in rayc_statistics. 0: an open surface is refused.
    /// Default 0.
    pub open: u32,
}

/// How contacts are found. Fill with rayc_default_detection_options(), then change what you need.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_detection_options {
    /// sizeof(rayc_detection_options).
    pub struct_size: usize,
    /// Where rays start. 0: at the vertices, as in the paper. A length > 0: about so far apart, in the middles of faces;
    /// larger triangles are cut into pieces of that size, and smaller ones joined to patches, connected and nearly flat,
    /// of which one triangle casts for all. RAYC_SPACING_AUTOMATIC (the default): in the middle of each triangle, larger
    /// ones being cut so that about 128 rays stand on the overlap's largest side; forces then hardly depend on the
    /// triangulation, for about two rays a vertex on fine meshes. In a scene, where the boxes of both bodies of a pair overlap
    /// those of more than 12 others, n at the least, it is 12/n as many, but no fewer than 8: crowded_pairs in
    /// rayc_statistics.
    pub sample_spacing: f64,
    /// 1: edges are traced too where no ray settles whether bodies overlap; 0: not. Default 1.
    pub edges: u32,
    /// 1: in a scene, a pair whose contacts cannot part it (one body swallowed, or held in the other's folds) is pushed
    /// along one direction until it is apart; 0: not. Default 1.
    pub escape: u32,
    /// 1: rays go past other folds of either body, as the winding number tells: a ray that meets its own body first is
    /// refused only where it has left the body altogether, and one that enters another fold of the other body on its way
    /// out of it is not taken for one from outside. 0: not. For bodies that overlap themselves; a scene does so by itself
    /// for those whose self-collision is switched on. Default 0.
    pub past_folds: u32,
    /// What forces grow with, a rayc_law. Default RAYC_LAW_PRESSURE.
    pub law: u32,
    /// How far the net force of each pair may be from that of all rays, as a part of it, 0 to 1, and its torque as a part
    /// of the force times half the overlap box's diagonal: triangles are joined to patches as large as that leaves. It is
    /// an estimate: patches get smaller until two tries agree clearly better than that; where two tries would take more
    /// than a third of the triangles, or leave no hope to agree, all cast. 0: no triangles are joined. With
    /// RAYC_SPACING_AUTOMATIC alone. Default 0.
    pub force_tolerance: f64,
}

/// What a contact's force grows with.
#[repr(C)]
#[derive(Clone, Copy)]
pub enum rayc_law {
    /// Pressure by depth below the surface: at every surface point inside the other body, k times the distance to the nearest
    /// point of that body's surface, along the inward normal; a contact's cos_alpha is that distance over its depth. The
    /// force is a gradient, so closed paths cost no work; it is that of Archimedes on round bodies in flat faces, and near that
    /// of hydroelastic contact (Elandt et al., IROS 2019) elsewhere. Where a body folds over itself, the rays' own law stays.
    RAYC_LAW_PRESSURE = 0,
    /// The paper's: k times the ray's length times the cosine of its angle, at points whose ray leaves the other body before
    /// their own (Hermann, Faure, Raffin 2008, section 4). Beside edges such forces may point the wrong way.
    RAYC_LAW_RAY_LENGTH = 1,
}

/// The sample_spacing that follows the size of each overlap.
pub const RAYC_SPACING_AUTOMATIC: f64 = -1.0;

/// What a contact's stiffness is multiplied with.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum rayc_weighting {
    /// The area the ray stands for: stiffness is in N/m³, and the net force does not depend on the triangulation.
    RAYC_WEIGHTING_AREA = 1,
    /// Nothing, as in the paper: stiffness is in N/m per ray, and a finer mesh is a stiffer one.
    RAYC_WEIGHTING_VERTEX = 2,
}

/// How contacts push. Fill with rayc_default_response_options(), then change what you need.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_response_options {
    /// sizeof(rayc_response_options).
    pub struct_size: usize,
    /// k ≥ 0, in N/m³ with RAYC_WEIGHTING_AREA, in N/m with RAYC_WEIGHTING_VERTEX. Default 1.
    pub stiffness: f64,
    /// Seconds, ≥ 0: the damping along the ray is k · damping_time. Default 0.
    pub damping_time: f64,
    /// A rayc_weighting. Default RAYC_WEIGHTING_AREA.
    pub weighting: u32,
    /// 1: an escaping pair is pushed by one force spread evenly over all vertices of each body, and the coefficients of
    /// its contacts are 0. For bodies so soft that contacts would draw them out instead of moving them. 0: its contacts
    /// push. Default 0.
    pub whole_body_escape: u32,
}

/// How a scene works. Fill with rayc_default_scene_options(), then change what you need.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_scene_options {
    /// sizeof(rayc_scene_options).
    pub struct_size: usize,
    /// Arithmetic of detection, a rayc_scalar; all meshes added must have the same. Default RAYC_SCALAR_F64.
    pub precision: u32,
    /// 1: the caller's own thread only; n: a pool of n threads that the scene owns and that have ended when it is
    /// destroyed; 0: such a pool of one thread for each core. At most 1024. Results do not depend on it. A
    /// step of fewer than about 1000 rays is done by the calling thread alone.
    ///
    /// After fork() a scene may be used and destroyed in the child too, by copies of its handles: its pool's threads are
    /// started anew with the first query that needs them, or where the system gives none the calling thread works alone;
    /// what the old ones held, some KiB each, is not given back. Not promised: anything for a scene or contacts that a
    /// call of another thread was using at the fork (they stay RAYC_STATUS_BUSY in the child), and what the system's
    /// own libraries do not promise: a child of a process with several threads may have to call exec() first. The host
    /// looks after the threads of a parallel_for itself. Default 1.
    pub threads: u32,
    /// The host's threads, to be used instead; `threads` must then be 1. Results do not depend on it either. Default NULL.
    pub parallel_for: rayc_parallel_for,
    /// What parallel_for is called with; it stays the host's. Default NULL.
    pub parallel_context: *mut c_void,
}

impl rayc_detection_options {
    pub(super) fn detection<T: Scalar>(&self) -> Result<DetectionOptions<T>, Failure> {
        let (spacing, tolerance) = (self.sample_spacing, self.force_tolerance);
        if !(0.0..=1.0).contains(&tolerance) || (tolerance > 0.0 && spacing != RAYC_SPACING_AUTOMATIC) {
            let message = text!(
                "force_tolerance is {tolerance}, with sample_spacing {spacing}; give 0, or a part up to 1 with \
                 RAYC_SPACING_AUTOMATIC"
            );
            return Err(Failure::new(rayc_status::RAYC_STATUS_INVALID_OPTION, message));
        }
        let sampling = match spacing {
            RAYC_SPACING_AUTOMATIC if tolerance > 0.0 => Sampling::Tolerance(T::of(tolerance)),
            RAYC_SPACING_AUTOMATIC => Sampling::Automatic,
            0.0 => Sampling::Vertices,
            _ if spacing > 0.0 && spacing.is_finite() => Sampling::Spacing(T::of(spacing)),
            _ => {
                return Err(Failure::new(
                    rayc_status::RAYC_STATUS_INVALID_OPTION,
                    text!("sample_spacing is {spacing}; give 0, a finite length > 0, or RAYC_SPACING_AUTOMATIC"),
                ));
            }
        };
        let law = match self.law {
            law if law == rayc_law::RAYC_LAW_PRESSURE as u32 => ContactLaw::Pressure,
            law if law == rayc_law::RAYC_LAW_RAY_LENGTH as u32 => ContactLaw::RayLength,
            other => return Err(unknown_enum("law", other, "rayc_law")),
        };
        Ok(DetectionOptions {
            law,
            sampling,
            edges: flag("edges", self.edges)?,
            escape: flag("escape", self.escape)?,
            past_folds: flag("past_folds", self.past_folds)?,
        })
    }
}

/// A struct that later versions may add fields to, at its end; callers say how much of it they know.
pub(super) trait Growing: Copy {
    const NAME: &'static str;
    /// Where the last field of the first version ends; programs built then pass no less.
    const SMALLEST: usize;
}

/// An options struct that starts with its own size.
pub(super) trait Options: Growing {
    fn defaults() -> Self;
}

impl Growing for rayc_mesh_options {
    const NAME: &'static str = "rayc_mesh_options";
    const SMALLEST: usize = std::mem::offset_of!(Self, precision) + size_of::<u32>();
}

impl Options for rayc_mesh_options {
    fn defaults() -> Self {
        Self { struct_size: size_of::<Self>(), precision: rayc_scalar::RAYC_SCALAR_F64 as u32, open: 0 }
    }
}

impl Growing for rayc_detection_options {
    const NAME: &'static str = "rayc_detection_options";
    const SMALLEST: usize = std::mem::offset_of!(Self, escape) + size_of::<u32>();
}

impl Options for rayc_detection_options {
    fn defaults() -> Self {
        let sample_spacing = RAYC_SPACING_AUTOMATIC;
        let law = rayc_law::RAYC_LAW_PRESSURE as u32;
        let struct_size = size_of::<Self>();
        Self { struct_size, sample_spacing, edges: 1, escape: 1, past_folds: 0, law, force_tolerance: 0.0 }
    }
}

impl Growing for rayc_response_options {
    const NAME: &'static str = "rayc_response_options";
    const SMALLEST: usize = std::mem::offset_of!(Self, weighting) + size_of::<u32>();
}

impl Options for rayc_response_options {
    fn defaults() -> Self {
        let weighting = rayc_weighting::RAYC_WEIGHTING_AREA as u32;
        let struct_size = size_of::<Self>();
        Self { struct_size, stiffness: 1.0, damping_time: 0.0, weighting, whole_body_escape: 0 }
    }
}

impl Growing for rayc_scene_options {
    const NAME: &'static str = "rayc_scene_options";
    const SMALLEST: usize = std::mem::offset_of!(Self, threads) + size_of::<u32>();
}

impl Options for rayc_scene_options {
    fn defaults() -> Self {
        Self {
            struct_size: size_of::<Self>(),
            precision: rayc_scalar::RAYC_SCALAR_F64 as u32,
            threads: 1,
            parallel_for: None,
            parallel_context: std::ptr::null_mut(),
        }
    }
}

impl rayc_response_options {
    pub(super) fn law(&self) -> Result<PenaltyLaw, Failure> {
        let weighting = match self.weighting {
            w if w == rayc_weighting::RAYC_WEIGHTING_AREA as u32 => Weighting::Area,
            w if w == rayc_weighting::RAYC_WEIGHTING_VERTEX as u32 => Weighting::Vertex,
            other => return Err(unknown_enum("weighting", other, "rayc_weighting")),
        };
        let law = PenaltyLaw::new(self.stiffness, self.damping_time, weighting)?;
        let whole_bodies = flag("whole_body_escape", self.whole_body_escape)?;
        Ok(if whole_bodies { law.pushing_whole_bodies() } else { law })
    }
}

pub(super) fn flag(field: &str, value: u32) -> Result<bool, Failure> {
    match value {
        0 => Ok(false),
        1 => Ok(true),
        _ => {
            let message = text!("{field} is {value}; give 0 for no or 1 for yes");
            Err(Failure::new(rayc_status::RAYC_STATUS_INVALID_OPTION, message))
        }
    }
}

pub(super) fn check_size<O: Growing>(struct_size: usize) -> Result<(), Failure> {
    let (name, largest) = (O::NAME, size_of::<O>());
    let smallest = O::SMALLEST.next_multiple_of(align_of::<O>());
    // A size that is no multiple of the alignment would cut a field.
    if (smallest..=largest).contains(&struct_size) && struct_size.is_multiple_of(align_of::<O>()) {
        return Ok(());
    }
    Err(Failure::new(
        rayc_status::RAYC_STATUS_INVALID_STRUCT_SIZE,
        text!(
            "struct_size of {name} is {struct_size}, not {smallest} to {largest}; fill the struct with its default \
             function first, pass sizeof, and link the library your header belongs to"
        ),
    ))
}

/// The caller's options, or the defaults for NULL and for fields the caller's header did not have yet.
///
/// # Safety
/// `options` is NULL or points to `struct_size` readable bytes.
pub(super) unsafe fn read_options<O: Options>(options: *const O) -> Result<O, Failure> {
    let mut read = O::defaults();
    if !options.is_null() {
        // SAFETY: every options struct starts with its size.
        let struct_size = *unsafe { reference(options.cast::<usize>(), O::NAME) }?;
        check_size::<O>(struct_size)?;
        // SAFETY: struct_size bytes are readable by this function's contract, and no more than `read` holds.
        unsafe { std::ptr::copy_nonoverlapping(options.cast::<u8>(), (&raw mut read).cast::<u8>(), struct_size) };
    }
    Ok(read)
}

/// Writes as much of `value` as the caller knows.
///
/// # Safety
/// `place` is writable for `struct_size` bytes.
pub(super) unsafe fn write_known<V: Growing>(
    struct_size: usize,
    place: *mut V,
    name: &str,
    value: V,
) -> Result<(), Failure> {
    check_size::<V>(struct_size)?;
    Output::new(place, name)?;
    // SAFETY: struct_size bytes are writable by this function's contract, and no more than `value` holds.
    unsafe { std::ptr::copy_nonoverlapping((&raw const value).cast::<u8>(), place.cast::<u8>(), struct_size) };
    Ok(())
}

/// A place for an array of which the caller knows so much of each element.
pub(super) struct Known<V> {
    struct_size: usize,
    place: *mut V,
}

impl<V: Growing> Known<V> {
    pub(super) fn new(struct_size: usize, place: *mut V, count: usize, name: &str) -> Result<Self, Failure> {
        check_size::<V>(struct_size)?;
        Output::array(place, count, name)?;
        Ok(Self { struct_size, place })
    }

    /// # Safety
    /// The place is writable for as many times `struct_size` bytes as `values` yields.
    pub(super) unsafe fn write_all(self, values: impl Iterator<Item = V>) {
        for (index, value) in values.enumerate() {
            // SAFETY: by this function's contract, and `value` holds no less.
            unsafe {
                let place = self.place.byte_add(index * self.struct_size).cast::<u8>();
                std::ptr::copy_nonoverlapping((&raw const value).cast::<u8>(), place, self.struct_size);
            }
        }
    }
}

/// # Safety
/// `place` is writable for `struct_size` bytes.
pub(super) unsafe fn write_defaults<O: Options>(struct_size: usize, place: *mut O) -> Result<(), Failure> {
    // SAFETY: by this function's contract.
    unsafe { write_options(struct_size, place, "options", O::defaults()) }
}

/// # Safety
/// `place` is writable for `struct_size` bytes.
pub(super) unsafe fn write_options<O: Options>(
    struct_size: usize,
    place: *mut O,
    name: &str,
    options: O,
) -> Result<(), Failure> {
    // SAFETY: by this function's contract. The first field is the size, which tells later calls how much of the struct
    // the caller knows.
    unsafe {
        write_known(struct_size, place, name, options)?;
        place.cast::<usize>().write(struct_size);
    }
    Ok(())
}

/// Fills `options` with the defaults. struct_size: sizeof(rayc_mesh_options).
///
/// Errors: RAYC_STATUS_INVALID_STRUCT_SIZE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_default_mesh_options(struct_size: usize, options: *mut rayc_mesh_options) -> rayc_status {
    // SAFETY: the caller's struct has the size it says.
    guard(|| unsafe { write_defaults(struct_size, options) })
}

/// Fills `options` with the defaults. struct_size: sizeof(rayc_detection_options).
///
/// Errors: RAYC_STATUS_INVALID_STRUCT_SIZE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_default_detection_options(
    struct_size: usize,
    options: *mut rayc_detection_options,
) -> rayc_status {
    // SAFETY: the caller's struct has the size it says.
    guard(|| unsafe { write_defaults(struct_size, options) })
}

/// Fills `options` with the defaults. struct_size: sizeof(rayc_response_options).
///
/// Errors: RAYC_STATUS_INVALID_STRUCT_SIZE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_default_response_options(
    struct_size: usize,
    options: *mut rayc_response_options,
) -> rayc_status {
    // SAFETY: the caller's struct has the size it says.
    guard(|| unsafe { write_defaults(struct_size, options) })
}

/// Fills `options` with the defaults. struct_size: sizeof(rayc_scene_options).
///
/// Errors: RAYC_STATUS_INVALID_STRUCT_SIZE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_default_scene_options(
    struct_size: usize,
    options: *mut rayc_scene_options,
) -> rayc_status {
    // SAFETY: the caller's struct has the size it says.
    guard(|| unsafe { write_defaults(struct_size, options) })
}
