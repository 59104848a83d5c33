//! How far each plane of Gaussian splats may be from the oracle, and why.
//!
//! The unit is the error that the oracle carries along with a number: each input and each sum of
//! products rounded once, to first order. In f64 that is far less than 1e-9.

use crate::oracle::kit::tolerance::Arithmetic::{F32, F64};
use crate::oracle::kit::tolerance::{Row, row};

pub(crate) const GAUSSIANS: &[Row] = &[
    row("blended", F32, 1.0, "conditions of V, its determinant, q and the colour"),
    row("blended", F64, 1.0, "as in f32"),
    row("T", F32, 1.0, "conditions of V, its determinant and q"),
    row("T", F64, 1.0, "as in f32"),
    row("Z", F32, 2.0, "four products and three sums, each rounded"),
    row("Z", F64, 0.25, "the condition of a ray's depth is wide, and t has few roundings"),
    row("Z.expected", F32, 0.125, "errors of the weights cancel in the mean"),
    row("Z.expected", F64, 0.125, "as in f32"),
    row("Z.median", F32, 2.0, "as Z"),
    row("Z.median", F64, 0.25, "as Z"),
    row("", F32, 1.0, "as blended"),
    row("", F64, 1.0, "as blended"),
    row("A", F32, 1.0, "as T"),
    row("A", F64, 1.0, "as T"),
];
