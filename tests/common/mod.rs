//! What the integration tests share.
#![allow(dead_code)] // each test uses a part of it

pub mod shapes;

/// Debug builds are some thirty times as slow, and try only every eighth of many similar cases.
pub const STRIDE: usize = if cfg!(debug_assertions) { 8 } else { 1 };
