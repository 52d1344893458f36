use crate::capi::base::rayc_status;
use crate::capi::ffi::{
    Failure, Growing, Handle, HandleKind, InPrecision, Options, Output, changing, check_reserved, give, growing, guard,
    guard_end, read_options, reading, take_back, unknown_enum, with_precision, write_defaults,
};
use crate::capi::mesh::{AnyMesh, rayc_mesh};
use crate::own_exits::OwnExits;
use crate::query::{Layout, Octree};

/// The search structure over one mesh's triangles, for one state of its positions.
///
/// Threads: several threads may make calls with a const octree at the same time. The caller frees the octree with
/// rayc_octree_destroy(), before or after its mesh. rayc_mesh_set_positions() makes an octree stale. Every use of a
/// stale octree is refused until rayc_octree_update().
pub struct rayc_octree {
    pub(super) octree: AnyOctree,
    pub(super) own_exits: AnyOwnExits,
}

impl Handle for rayc_octree {
    const KIND: HandleKind = HandleKind::OCTREE;
}

/// An octree of either precision.
pub(super) type AnyOctree = InPrecision<Octree<f32>, Octree<f64>>;

/// The own exits found last, and the memory that finding them takes.
pub(super) type AnyOwnExits = InPrecision<OwnExits<f32>, OwnExits<f64>>;

/// How an octree's cells are laid out. Every answer is the same, bit for bit; only contacts come in another order.
#[repr(C)]
#[derive(Clone, Copy)]
pub enum rayc_octree_layout {
    /// A bounding volume hierarchy of up to sixteen children a node, over leaves of up to sixteen adjacent triangles, which
    /// are kept when positions change: the fast one, and that of scenes.
    RAYC_OCTREE_LAYOUT_WIDE = 1,
    /// The paper's octree (Hermann, Faure, Raffin 2008, section 3): eight equal cells a node, built anew for new positions,
    /// and traversed after Revelles, Ureña, Lastra 2000. To compare with.
    RAYC_OCTREE_LAYOUT_CLASSIC = 2,
}

/// How an octree is built. Fill with rayc_default_octree_options(), then change what you need.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_octree_options {
    /// sizeof(rayc_octree_options).
    pub struct_size: usize,
    /// How its cells are laid out, a rayc_octree_layout. Default RAYC_OCTREE_LAYOUT_WIDE.
    pub layout: u32,
    /// Always 0.
    pub reserved: u32,
}

growing!(rayc_octree_options);

impl Options for rayc_octree_options {
    fn defaults() -> Self {
        let layout = rayc_octree_layout::RAYC_OCTREE_LAYOUT_WIDE as u32;
        Self { struct_size: size_of::<Self>(), layout, reserved: 0 }
    }
}

impl rayc_octree_options {
    pub(super) fn layout(&self) -> Result<Layout, Failure> {
        check_reserved(Self::NAME, self.reserved)?;
        match self.layout {
            layout if layout == rayc_octree_layout::RAYC_OCTREE_LAYOUT_WIDE as u32 => Ok(Layout::Bvh),
            layout if layout == rayc_octree_layout::RAYC_OCTREE_LAYOUT_CLASSIC as u32 => Ok(Layout::PaperOctree),
            other => Err(unknown_enum("layout", other, "rayc_octree_layout")),
        }
    }
}

/// Fills `options` with the defaults. struct_size: sizeof(rayc_octree_options).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_default_octree_options(
    struct_size: usize,
    options: *mut rayc_octree_options,
) -> rayc_status {
    guard(|| write_defaults(struct_size, options))
}

/// Builds the octree of `mesh` for its present positions. options: NULL for the defaults. *octree: the new handle.
///
/// Errors: RAYC_STATUS_OUT_OF_MEMORY, RAYC_STATUS_INVALID_STRUCT_SIZE, RAYC_STATUS_UNKNOWN_ENUM.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_octree_create(
    options: *const rayc_octree_options,
    mesh: *const rayc_mesh,
    octree: *mut *mut rayc_octree,
) -> rayc_status {
    guard(|| {
        let layout = read_options(options)?.layout()?;
        let mesh = reading(mesh, "mesh")?;
        let place = Output::new(octree, "octree")?;
        let (octree, own_exits) = match &mesh.mesh {
            AnyMesh::F32(mesh) => {
                (AnyOctree::F32(Octree::with_layout(mesh, layout)), AnyOwnExits::F32(OwnExits::default()))
            }
            AnyMesh::F64(mesh) => {
                (AnyOctree::F64(Octree::with_layout(mesh, layout)), AnyOwnExits::F64(OwnExits::default()))
            }
        };
        give(place, rayc_octree { octree, own_exits })
    })
}

/// Makes the octree follow its mesh to the present positions; its memory is reused.
///
/// Errors: RAYC_STATUS_OCTREE_OF_OTHER_MESH, RAYC_STATUS_PRECISION_MISMATCH.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_octree_update(octree: *mut rayc_octree, mesh: *const rayc_mesh) -> rayc_status {
    guard(|| {
        let mut octree = changing(octree, "octree")?;
        with_precision!(&mut octree.octree, &reading(mesh, "mesh")?.mesh, |octree, mesh| Ok(octree.update(mesh)?))
    })
}

/// Frees an octree; NULL does nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_octree_destroy(octree: *mut rayc_octree) -> rayc_status {
    guard_end(|| take_back(octree, "octree"))
}
