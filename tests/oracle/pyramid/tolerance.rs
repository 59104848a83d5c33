//! How far each plane of the pull-push pyramid may be from its oracle, and why.
//!
//! The unit is the running error bound of [`crate::oracle::kit::number`]: with the documented operations
//! in the documented order an error of 1 is the worst that rounding can do, so no row is above 1.
//! In `f64` the oracle makes the same operations and 0 means the same bits.

use crate::oracle::kit::tolerance::Arithmetic::{F32, F64};
use crate::oracle::kit::tolerance::{Row, row};

const BITS: &str = "the same operations on the same numbers";
const CHOSEN: &str = "chosen from given numbers, not computed";
const WORST: &str = "the bound is rigorous";
const EXP: &str = "std's exp and pow are off by a unit or so, the rest is the same";

pub(crate) const PYRAMID: &[Row] = &[
    row("projection.kind", F32, 0.0, CHOSEN),
    row("projection.kind", F64, 0.0, CHOSEN),
    row("projection.Z", F32, 1.0, WORST),
    row("projection.Z", F64, 0.0, BITS),
    row("projection.normal", F32, 1.0, WORST),
    row("projection.normal", F64, 0.0, BITS),
    row("projection.tangent", F32, 1.0, WORST),
    row("projection.tangent", F64, 0.0, BITS),
    row("projection.extent", F32, 1.0, WORST),
    row("projection.extent", F64, 0.0, BITS),
    row("projection.radius", F32, 1.0, WORST),
    row("projection.radius", F64, 0.0, BITS),
    row("projection.center", F32, 1.0, WORST),
    row("projection.center", F64, 0.0, BITS),
    row("projection", F32, 1.0, WORST),
    row("projection", F64, 0.0, BITS),
    row("pull.kind", F32, 0.0, CHOSEN),
    row("pull.kind", F64, 0.0, CHOSEN),
    row("pull.front", F32, 0.0, CHOSEN),
    row("pull.front", F64, 0.0, CHOSEN),
    row("pull.back", F32, 0.0, CHOSEN),
    row("pull.back", F64, 0.0, CHOSEN),
    row("pull.extent", F32, 1.0, WORST),
    row("pull.extent", F64, 0.0, BITS),
    row("pull.displacement", F32, 1.0, WORST),
    row("pull.displacement", F64, 0.0, BITS),
    row("pull.normal", F32, 1.0, WORST),
    row("pull.normal", F64, 0.0, BITS),
    row("pull.tangent", F32, 1.0, WORST),
    row("pull.tangent", F64, 0.0, BITS),
    row("pull", F32, 1.0, WORST),
    row("pull", F64, 0.0, BITS),
    row("push.kind", F32, 0.0, CHOSEN),
    row("push.kind", F64, 0.0, CHOSEN),
    row("push.front", F32, 1.0, WORST),
    row("push.front", F64, 0.5, EXP),
    row("push.back", F32, 1.0, WORST),
    row("push.back", F64, 0.5, EXP),
    row("push.extent", F32, 1.0, WORST),
    row("push.extent", F64, 0.5, EXP),
    row("push.displacement", F32, 1.0, WORST),
    row("push.displacement", F64, 0.5, EXP),
    row("push.normal", F32, 1.0, WORST),
    row("push.normal", F64, 0.5, EXP),
    row("push.tangent", F32, 1.0, WORST),
    row("push.tangent", F64, 0.5, EXP),
    row("push", F32, 1.0, WORST),
    row("push", F64, 0.5, EXP),
    row("normal", F32, 1.0, WORST),
    row("normal", F64, 0.0, BITS),
    row("tangent", F32, 1.0, WORST),
    row("tangent", F64, 0.0, BITS),
    row("", F32, 1.0, WORST),
    row("", F64, 0.5, EXP),
];
