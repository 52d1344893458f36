//! The contact system against closed forms, finite differences and the laws of motion.

mod energy;
mod friction;
mod laws;
