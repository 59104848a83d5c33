//! What a right renderer of Gaussian splats may do otherwise than the crate.

use crate::verify::client::named::named;
use splatref::verdict::client::Rounding;

named! {
    /// What a right implementation may do; the default is plain f32.
    #[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
    pub(crate) enum Habit {
        /// IEEE 754, in the order of the pages.
        #[default]
        Plain,
        /// A product goes into a sum without a rounding of its own.
        Fused,
        /// a + (b + c) in place of (a + b) + c.
        Reassociated,
        /// The conic by a quotient for each of its elements.
        ConicDivided,
        /// x/t as x (1/t).
        Reciprocal,
        /// The covariance in the camera frame by (W M) (W M)^T.
        AxesInCamera,
        /// V by the axes in pixels, (J W M) (J W M)^T.
        AxesInPixels,
        /// exp by exp2.
        Exp2,
        /// exp2, whose factor is in the conic already.
        ConicOfExp2,
        /// 1 / sqrt in place of sqrt.
        InverseSqrt,
        /// Splats are sorted by the bits of their keys.
        SortedByBits,
        /// The transmittance becomes T - T alpha.
        ThroughLess,
        /// Colours are blended from back to front by `over`, with the decisions of front to back.
        Over,
        /// Quadratic forms are summed as squares of a Cholesky factor of the conic.
        Cholesky,
    }
}

impl Habit {
    /// The promises that a client with this habit keeps.
    pub(crate) fn promises(self) -> &'static [Rounding] {
        match self {
            Self::Plain | Self::Fused | Self::SortedByBits => {
                &[Rounding::Ieee, Rounding::Precise, Rounding::Gpu]
            }
            _ => &[Rounding::Gpu],
        }
    }
}
