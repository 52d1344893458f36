//! Surfaces: files, orientation, and what no mesh can have.

mod obj_files;
mod orientation;
mod refused_numbers;
