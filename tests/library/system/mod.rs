//! The contact system against closed forms, finite differences and the laws of motion.

mod bodies;
mod card_house;
mod carriers;
#[allow(dead_code)] // the program energy uses more of it
mod closed;
mod energy;
mod friction;
pub mod laws;
mod midpoint;
mod pairs;
mod potential;
mod range;
mod refusals;
mod restitution;
mod rolling;
mod steps;
