//! Activate the numbers of trained Gaussians.

use crate::number::elementary;

/// The scale for its logarithm.
pub(in crate::io) fn scale(logarithm: f64) -> f32 {
    let narrow = logarithm as f32;
    if f64::from(narrow) == logarithm {
        elementary::exp_f32(narrow)
    } else {
        elementary::exp(logarithm) as f32
    }
}

/// The opacity for its logit.
pub(in crate::io) fn opacity(logit: f64) -> f32 {
    (1.0 / (1.0 + elementary::exp(-logit))) as f32
}
