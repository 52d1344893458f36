//! One triangle, and a ray or a point: hits and nearest points, one by one and sixteen at a time.

mod closest_point;
mod main_axis;
mod moller_trumbore;
mod nearest;
mod nearest_lanes;
mod point_packet;
mod prepared_ray;
mod query_point;
mod ray;
mod ray_packet;
mod watertight;
mod watertight_lanes;

pub use closest_point::ClosestPoint;
pub use moller_trumbore::moller_trumbore;
pub(crate) use nearest::{TrianglePoint, ascending};
pub(crate) use nearest_lanes::{NearTriangles, TrianglePoints};
pub(crate) use point_packet::PointPacket;
pub use prepared_ray::{PreparedRay, TriangleTest};
pub(crate) use query_point::{MeshScale, QueryPoint};
pub use ray::{Hit, Ray};
pub(crate) use ray_packet::RayPacket;
pub use watertight::ShearedRay;
pub(crate) use watertight_lanes::{HitLanes, ProjectedTriangles, TriangleLanes};
