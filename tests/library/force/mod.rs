//! Forces, derivative and energy.

mod laws;
mod spread;
