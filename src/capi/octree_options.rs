use super::checks::check_reserved;
use super::failure::{Failure, rayc_status, unknown_enum};
use super::guard::guard;
use super::sized_structs::{Growing, Options, growing, write_defaults};
use crate::query::Layout;

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
///
/// Errors: RAYC_STATUS_INVALID_STRUCT_SIZE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_default_octree_options(
    struct_size: usize,
    options: *mut rayc_octree_options,
) -> rayc_status {
    // SAFETY: the caller's struct has the size it says.
    guard(|| unsafe { write_defaults(struct_size, options) })
}
