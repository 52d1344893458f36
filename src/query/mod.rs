//! What a host, or the rest of the library, asks about one surface: where a ray meets it, its nearest point, how often it winds
//! around a point.

mod crossings;
mod nearest_point;
mod octree;
mod patch_levels;
mod point_order;
mod surface;
mod surface_groups;
mod tracer;
mod winding_number;

pub(crate) use crossings::{leaves_body_before_end, way_out, way_out_past_folds, winding_number, winding_under};
pub(crate) use nearest_point::PointDistances;
pub(crate) use octree::Tree;
pub use octree::{Layout, Octree, OctreeError};
pub(crate) use surface::Surface;
pub use tracer::Tracer;
