//! What a hit means: whether a ray leaves the other body before its own, whatever folds either has.

pub(crate) mod past_folds;
pub(crate) mod starts_outside;
