//! The bugs that a client makes on purpose. Each is one line of a shader or of a pipeline.

/// A seeded bug. Up to [`Bug::NeverOccluded`] a bug has the number that `view.wgsl` gives it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Bug {
    #[default]
    None,
    NoLowPass,
    HalfEpsilon,
    HalfPixel,
    NoWeightGuard,
    SmallCutoff,
    SmallQuads,
    MirroredTilt,
    NoAmplitude,
    BackNotTurned,
    DepthOfCenter,
    CoarseExp,
    RatioAboveOne,
    RoundedBin,
    LevelOff,
    EqualWeights,
    NeverOccluded,
    /// The depth test lets the last of equally near fragments win.
    LastOfTies,
    /// The depth buffer has 16 bits, and nobody says so.
    ShallowDepth,
    /// The last splat is not drawn.
    OneMissing,
    /// The sums have 16 bits, and nobody says so.
    HalfSums,
}

impl Bug {
    /// The bugs of EWA.
    pub(crate) const EWA: [Self; 15] = [
        Self::NoLowPass,
        Self::HalfEpsilon,
        Self::HalfPixel,
        Self::NoWeightGuard,
        Self::SmallCutoff,
        Self::SmallQuads,
        Self::MirroredTilt,
        Self::NoAmplitude,
        Self::BackNotTurned,
        Self::DepthOfCenter,
        Self::CoarseExp,
        Self::LastOfTies,
        Self::ShallowDepth,
        Self::OneMissing,
        Self::HalfSums,
    ];

    pub(crate) const SINGLE_PASS: [Self; 3] =
        [Self::RatioAboveOne, Self::RoundedBin, Self::HalfEpsilon];
    pub(crate) const PYRAMID: [Self; 3] = [Self::LevelOff, Self::EqualWeights, Self::NeverOccluded];

    /// The constants of every pipeline.
    pub(crate) fn constants(self) -> [(&'static str, f64); 1] {
        let number = self as u32;
        [("bug", if number <= Self::NeverOccluded as u32 { number.into() } else { 0.0 })]
    }

    /// The bug in words.
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::NoLowPass => "no low-pass filter",
            Self::HalfEpsilon => "epsilon is half as large",
            Self::HalfPixel => "fragments are half a pixel off",
            Self::NoWeightGuard => "empty pixels are divided by their weight, 0",
            Self::SmallCutoff => "the limit of q is 1 % too small",
            Self::SmallQuads => "quads are 10 % too small",
            Self::MirroredTilt => "ellipses lean to the wrong side",
            Self::NoAmplitude => "weights lack their amplitude",
            Self::BackNotTurned => "normals of backs are not turned",
            Self::DepthOfCenter => "a splat has the depth of its centre everywhere",
            Self::CoarseExp => "exp is a power of 1 - x / 256",
            Self::RatioAboveOne => "the ratio of the Voronoi-enhanced depth exceeds 1",
            Self::RoundedBin => "depths are rounded to bins, not rounded down",
            Self::LevelOff => "the push takes cells of the next level's size",
            Self::EqualWeights => "the push weighs all cells alike",
            Self::NeverOccluded => "the push keeps occluded cells",
            Self::LastOfTies => "the last of equally near fragments wins",
            Self::ShallowDepth => "the depth buffer has 16 bits, undeclared",
            Self::OneMissing => "the last splat is not drawn",
            Self::HalfSums => "sums have 16 bits, undeclared",
        }
    }
}
