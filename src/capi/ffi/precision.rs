//! Values of either precision, and what calls do with those of one.

use super::failure::Failure;
use crate::capi::base::rayc_status;

/// A value in the precision that its handle was created with.
#[derive(Clone)]
pub(in crate::capi) enum InPrecision<S, D> {
    F32(S),
    F64(D),
}

/// What a call does with values, in the precision that they have; several have to be of the same one.
macro_rules! with_precision {
    ($a:expr, |$p:ident| $call:expr) => {
        match $a {
            $crate::capi::ffi::InPrecision::F32($p) => $call,
            $crate::capi::ffi::InPrecision::F64($p) => $call,
        }
    };
    ($a:expr, $b:expr, |$p:ident, $q:ident| $call:expr) => {
        $crate::capi::ffi::with_all!(($a, $b), ($p, $q), $call)
    };
    ($a:expr, $b:expr, $c:expr, |$p:ident, $q:ident, $r:ident| $call:expr) => {
        $crate::capi::ffi::with_all!(($a, $b, $c), ($p, $q, $r), $call)
    };
    ($a:expr, $b:expr, $c:expr, $d:expr, |$p:ident, $q:ident, $r:ident, $s:ident| $call:expr) => {
        $crate::capi::ffi::with_all!(($a, $b, $c, $d), ($p, $q, $r, $s), $call)
    };
}

macro_rules! with_all {
    ($values:expr, ($($name:ident),+), $call:expr) => {
        match $values {
            ($($crate::capi::ffi::InPrecision::F32($name)),+) => $call,
            ($($crate::capi::ffi::InPrecision::F64($name)),+) => $call,
            _ => return Err($crate::capi::ffi::precision_mismatch()),
        }
    };
}

pub(in crate::capi) use {with_all, with_precision};

/// Handles of both precisions in one call.
#[cold]
pub(in crate::capi) fn precision_mismatch() -> Failure {
    Failure::new(
        rayc_status::RAYC_STATUS_PRECISION_MISMATCH,
        "handles of float and of double precision were used together; create them with the same precision",
    )
}
