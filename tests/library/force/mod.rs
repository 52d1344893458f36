//! Forces, derivative and energy.

mod laws;
