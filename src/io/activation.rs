//! Activate the numbers of trained Gaussians, and find the numbers that give activated ones.

use crate::number::elementary;
use crate::scene::GaussianArrays;
use glam::DVec3;

/// What a file holds: activated numbers, which nobody has checked yet.
#[derive(Clone, Debug, PartialEq)]
pub struct GaussianFile {
    /// The Gaussians, for [`crate::scene::Gaussians::new`].
    pub arrays: GaussianArrays,
    /// What the reader subtracted from the positions of the file, because `f32` would merge places
    /// that are far from 0.
    pub offset: DVec3,
    /// How the file stores its numbers, in words.
    pub convention: String,
    /// What the reader doubts about the file, and what mends it: one line each, without the name of
    /// the file.
    pub warnings: Vec<String>,
}

/// The scale for its logarithm.
pub(super) fn scale(logarithm: f64) -> f32 {
    let narrow = logarithm as f32;
    if f64::from(narrow) == logarithm {
        elementary::exp_f32(narrow)
    } else {
        elementary::exp(logarithm) as f32
    }
}

/// The opacity for its logit.
pub(super) fn opacity(logit: f64) -> f32 {
    (1.0 / (1.0 + elementary::exp(-logit))) as f32
}

/// Finite numbers that are activated to 0 and to 1 in `f32`.
#[cfg(feature = "cli")]
const TO_ZERO: f32 = -120.0;
#[cfg(feature = "cli")]
const TO_ONE: f32 = 20.0;

/// The logarithm of a scale: one that gives the scale again if there is one, else the nearest.
#[cfg(feature = "cli")]
pub(super) fn logarithm(value: f32) -> f32 {
    match value {
        0.0 => TO_ZERO,
        _ => inverse(value, elementary::ln(value.into()) as f32, scale),
    }
}

/// The logit of an opacity, chosen as [`logarithm`].
#[cfg(feature = "cli")]
pub(super) fn logit(value: f32) -> f32 {
    let wide = f64::from(value);
    match value {
        0.0 => TO_ZERO,
        1.0 => TO_ONE,
        _ => inverse(value, (elementary::ln(wide) - elementary::ln(1.0 - wide)) as f32, opacity),
    }
}

/// The number next to `near` that is activated to `value`; `near` if there is none.
#[cfg(feature = "cli")]
fn inverse(value: f32, near: f32, activate: fn(f64) -> f32) -> f32 {
    let all = [near, near.next_up(), near.next_down()];
    all.into_iter().find(|&other| activate(other.into()) == value).unwrap_or(near)
}

#[cfg(all(test, feature = "cli"))]
mod tests {
    use super::*;

    #[test]
    fn inverses_give_the_number_again_where_f32_has_one() {
        for value in [0.0, 0.5, 0.75, 1.0, 1.25, 2.0] {
            assert_eq!(scale(logarithm(value).into()), value);
        }
        for value in [0.0, 0.25, 0.5, 0.75, 0.9, 1.0] {
            assert_eq!(opacity(logit(value).into()), value, "{value}");
        }
        // Logarithms above 1 are further apart than the scales.
        let off = scale(logarithm(1234.567).into()) / 1234.567 - 1.0;
        assert!(off != 0.0 && off.abs() < 1e-6, "{off}");
    }
}
