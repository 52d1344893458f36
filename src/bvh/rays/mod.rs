//! Where rays meet the triangles: one ray, a ray's way through all triangles, and packets of sixteen rays.

pub(crate) mod exit_culling;
pub(crate) mod packet;
pub(crate) mod single;
pub(crate) mod slabs;
pub(crate) mod trace;
