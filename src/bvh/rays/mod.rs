//! TODO

pub(crate) mod exit_culling;
pub(crate) mod packet;
pub(crate) mod single;
pub(crate) mod slabs;
pub(crate) mod trace;
