//! How far each plane of depth peeling may be from the oracle, and why.

use crate::oracle::kit::tolerance::Arithmetic::{F32, F64, F64Rounded};
use crate::oracle::kit::tolerance::{Row, row};

pub(crate) const PEELING: &[Row] = &[
    row("layer", F32, 4.0, "as the picture of the 2+1-pass method"),
    row("layer", F64, 2.0, "as in f32"),
    row("layer", F64Rounded, 0.25, "a common factor of the amplitudes cancels"),
    row("layer.A", F32, 4.0, "as an average colour"),
    row("layer.A", F64, 2.0, "as in f32"),
    row("layer.A", F64Rounded, 0.25, "a common factor of the amplitudes cancels"),
    row("layer.Z", F32, 4.0, "as visibility.Z"),
    row("layer.Z", F64, 4.0, "as visibility.Z"),
    row("layer.Z", F64Rounded, 1.0, "as visibility.Z"),
    row("Z", F32, 4.0, "as visibility.Z"),
    row("Z", F64, 4.0, "as visibility.Z"),
    row("Z", F64Rounded, 1.0, "as visibility.Z"),
    row("A", F32, 4.0, "three roundings a layer"),
    row("A", F64, 2.0, "as in f32"),
    row("A", F64Rounded, 0.125, "as the opacity of a layer"),
    row("", F32, 4.0, "the conditions of all layers and of the environment"),
    row("", F64, 4.0, "as in f32"),
    row("", F64Rounded, 0.25, "as a layer"),
];
