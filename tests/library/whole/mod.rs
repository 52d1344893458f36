//! The library as a whole: bad input, invariances, closed forms.

mod bad_geometry;
mod circles;
mod example;
mod faults;
mod figures;
mod layers;
mod metamorphic;
mod number_range;
mod numbering;
