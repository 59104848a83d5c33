//! Turn a number of the file into a number of the cloud.

use crate::number::srgb;

/// How a number of the file becomes a number of the cloud.
#[derive(Clone, Copy)]
pub(super) enum Decode {
    /// Rounded to `f32`.
    Keep,
    /// Less an offset, then rounded to `f32`.
    Shift(f64),
    /// Divided by the code of 1, then rounded to `f32`.
    Divide(f64),
    /// A code of sRGB, looked up.
    Srgb(&'static [f32]),
    /// A number of sRGB, of which this one is white; decoded in f64 and rounded once.
    Encoded(f64),
}

impl Decode {
    pub(super) fn apply(self, value: f64) -> f32 {
        match self {
            Self::Keep => value as f32,
            Self::Shift(offset) => (value - offset) as f32,
            Self::Divide(one) => (value / one) as f32,
            Self::Srgb(table) => table[value as usize], // the type of the file bounds the code
            Self::Encoded(white) => srgb::to_linear(value / white) as f32,
        }
    }
}
