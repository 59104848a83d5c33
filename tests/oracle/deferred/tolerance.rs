//! How far each plane of deferred splatting may be from the oracle, and why.

use crate::kit::tolerance::Arithmetic::{F32, F64, F64Rounded};
use crate::kit::tolerance::{Row, row};

pub(crate) const DEFERRED: &[Row] =
    &[row("visibility.Z", F32, 4.0, "the visibility of ewa, of fewer surfels")];
#[cfg(any())]
const _: () = (F64, F64Rounded);
