//! The contact system against closed forms, finite differences and the laws of motion.

mod bodies;
#[allow(dead_code)] // the example energy uses more of it
mod closed;
mod conduct;
mod energy;
mod friction;
mod laws;
mod parts;
mod refusals;
mod shared;
mod steps;
