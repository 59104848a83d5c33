//! What a right client may do otherwise than the crate.

use super::named::named;
use splatref::verdict::client::Rounding;

named! {
    /// What a right implementation may do; the default is plain f32.
    ///
    /// WGSL's chapter on floating point evaluation, and Vulkan's on precision, allow all of these
    /// but [`Habit::TiesToTheLast`].
    #[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
    pub(crate) enum Habit {
        /// IEEE 754: every operation rounded once, to nearest, in the order of the pages.
        #[default]
        Plain,
        /// A product goes into a sum without a rounding of its own (WGSL: fusion; C: contraction).
        Fused,
        /// a + (b + c) in place of (a + b) + c in dot products, planes and offsets (WGSL:
        /// reassociation).
        Reassociated,
        /// a / b is a times the rounded reciprocal of b (WGSL and Vulkan: division within 2.5 ulp).
        Reciprocal,
        /// sqrt(x) is x inversesqrt(x) (WGSL and Vulkan: sqrt inherits from inversesqrt).
        InverseSqrt,
        /// exp and pow by exp2 and log2 (WGSL: pow inherits from exp2(y log2(x)), exp is within
        /// 3 + 2 |x| ulp).
        Exp2,
        /// Quotients up to 2 ulp off, powers of e up to 3 (WGSL and Vulkan: 2.5 ulp, 3 + 2 |x| ulp).
        Coarse,
        /// Every result rounded to either neighbour by a coin (WGSL: the rounding mode is open).
        EitherNeighbor,
        /// Every result rounded towards zero (Vulkan: RTZ is a rounding mode).
        TowardsZero,
        /// Subnormal operands and results are 0 (WGSL and Vulkan: they may be flushed).
        FlushDenormals,
        /// Fragments are blended from the last splat to the first (sums have no order of their own:
        /// a GPU client sorts as it likes).
        LastFirst,
        /// Fragments are blended in a pseudo-random order (atomics).
        Shuffled,
        /// Quads reach three pixels farther than needed; what is outside is discarded.
        WideQuads,
        /// Depth is r (2 - w r), r being 1/w to 16 bits: a step of Newton's on the reciprocal of a
        /// table (WGSL and Vulkan: 1/w within 2.5 ulp).
        DepthByNewton,
        /// The upper bound of a clamp before the lower one (WGSL: either formula of clamp).
        ClampHighFirst,
        /// Of equally near fragments the one of the higher index wins. *Not* the crate's rule: what
        /// a client declares whose depth test is <=.
        TiesToTheLast,
    }
}

impl Habit {
    /// The promises that a client with this habit keeps.
    pub(crate) fn promises(self) -> &'static [Rounding] {
        match self {
            Self::Plain | Self::Fused | Self::WideQuads | Self::ClampHighFirst => {
                &[Rounding::Ieee, Rounding::Precise, Rounding::Gpu]
            }
            Self::Reciprocal
            | Self::InverseSqrt
            | Self::Exp2
            | Self::Coarse
            | Self::FlushDenormals
            | Self::DepthByNewton => &[Rounding::Precise, Rounding::Gpu],
            Self::Reassociated
            | Self::EitherNeighbor
            | Self::TowardsZero
            | Self::LastFirst
            | Self::Shuffled
            | Self::TiesToTheLast => &[Rounding::Gpu],
        }
    }
}
