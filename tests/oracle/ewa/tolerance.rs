//! How far each plane of the 2+1-pass method may be from the oracle, and why.

use crate::oracle::kit::tolerance::Arithmetic::{F32, F64, F64Rounded};
use crate::oracle::kit::tolerance::{Row, row};

pub(crate) const EWA: &[Row] = &[
    row("visibility.Z", F32, 4.0, "three roundings of the nearness, one reciprocal"),
    row("visibility.Z", F64, 4.0, "as in f32"),
    row("visibility.Z", F64Rounded, 1.0, "half the range of depth takes the normal for a unit"),
    row("attributes.weight", F32, 4.0, "sqrt and quotients of the conic, exp, one rounding a term"),
    row("attributes.weight", F64, 4.0, "as in f32; the oracle's determinant cancels as much"),
    row(
        "attributes.weight",
        F64Rounded,
        0.5,
        "area takes the normal for a unit, the covariance not",
    ),
    row("attributes.normal", F32, 4.0, "a product more than the weight"),
    row("attributes.normal", F64, 4.0, "as in f32"),
    row("attributes.normal", F64Rounded, 0.5, "as the weight"),
    row("attributes", F32, 4.0, "a product more than the weight"),
    row("attributes", F64, 4.0, "as in f32"),
    row("attributes", F64Rounded, 0.5, "as the weight"),
    row("resolved", F32, 4.0, "errors of sum and weight partly cancel, a quotient rounds"),
    row("resolved", F64, 4.0, "as in f32"),
    row("resolved", F64Rounded, 0.25, "a common factor of the amplitudes cancels"),
    row("Z", F32, 4.0, "the same numbers as visibility.Z"),
    row("Z", F64, 4.0, "the same numbers as visibility.Z"),
    row("Z", F64Rounded, 1.0, "the same numbers as visibility.Z"),
    row("weight", F32, 4.0, "the same numbers as attributes.weight"),
    row("weight", F64, 4.0, "the same numbers as attributes.weight"),
    row("weight", F64Rounded, 0.5, "the same numbers as attributes.weight"),
    row("normal", F32, 2.0, "three components share one condition, the largest"),
    row("normal", F64, 2.0, "as in f32"),
    row("normal", F64Rounded, 0.25, "a common factor of the amplitudes cancels"),
    row("", F32, 4.0, "without lights the resolved colour; else Phong's own condition is larger"),
    row("", F64, 4.0, "as in f32"),
    row("", F64Rounded, 0.25, "as the resolved colour"),
];
