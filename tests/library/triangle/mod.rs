//! Single rays.

mod single_rays;
