//! Scenes and contact systems that share bodies, against one that has all of them.

mod ghosts;
mod parts;
mod shared_bodies;
