//! Forces, derivative and energy.

mod friction;
mod laws;
mod spread;
