//! Search trees: hits, nearest points and winding numbers.

mod closest_points;
mod layouts;
mod winding;
