//! Many bodies, and what a scene remembers of them.

mod body_numbers;
mod crowds;
mod differential;
mod pair_memory;
mod poses;
mod sharing;
mod steps;
