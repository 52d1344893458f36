//! Overlaps that contacts alone cannot part.

mod beyond_the_paper;
mod completeness;
mod escape_push;
