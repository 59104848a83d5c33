//! The mistakes that a client can be told to make, each one line where a developer would make it.

use crate::verify::client;
use crate::verify::client::named::named;

named! {
    /// One-line mistakes: of splats, of the depth-images, of their depth test in bins, of the
    /// compositing pass, of the picture.
    #[derive(Clone, Copy, PartialEq, Eq, Debug)]
    pub(crate) enum Bug {
        /// The corner of a pixel is taken for its centre.
        NoHalfPixel,
        /// The limit of q is too small by 1e-5 of it.
        CutoffSmaller,
        /// The limit of q is too large by 1e-5 of it.
        CutoffLarger,
        /// The rim, q = k k, is outside.
        RimOutside,
        /// exp(-q) in place of exp(-q/2).
        ExpWithoutHalf,
        /// Depth is not clamped to that of the disc.
        DepthClampMissing,
        /// Nothing is culled.
        CullingIgnored,
        /// The middle one of the splats is not drawn.
        SplatMissing,

        /// The group of a surfel is its index modulo K, whatever was given.
        GroupByIndex,
        /// The group of a surfel is its group modulo K - 1.
        GroupsTooFew,
        /// Surfels are drawn in the groups too that an extension added them to.
        AddedDrawn,
        /// Radii are enlarged by the scale of their group.
        ScaleApplied,
        /// The last group is not drawn.
        GroupNotDrawn,
        /// Two images are handed in under each other's name.
        ImagesSwapped,
        /// The last fragment of a pixel stays.
        NoDepthTest,
        /// The farthest fragment of a pixel stays.
        DepthTestReversed,
        /// Of fragments that tie the one of the higher index stays.
        TiesReversed,
        /// Fragments that are discarded have written depth.
        DiscardedWriteDepth,
        /// A depth buffer of 16 bits.
        Depth16,
        /// The images are blended, not overwritten.
        ImagesBlended,
        /// The weight of the first fragment stays.
        WeightOfTheFirst,
        /// The id is written without a depth test.
        IdOfTheLast,
        /// Normals are not multiplied by the weight.
        NormalNotWeighted,
        /// Colours are multiplied by the weight twice.
        ColorWeightedTwice,
        /// What is seen from behind keeps its normal.
        NormalsNotReversed,
        /// The images are of 16 bits.
        HalfImages,
        /// One pixel of one image is empty.
        FragmentMissing,
        /// One weight of one image is NaN.
        WeightNan,
        /// One id of one image is the next one.
        IdNext,
        /// One depth of one image is 2e-5 of it too large.
        DepthOff,

        /// The plain depth test where the Voronoi one is asked for.
        VoronoiIgnored,
        /// Within a bin the first fragment stays.
        RatioMissing,
        /// The ratio is subtracted.
        RatioSign,
        /// The ratio is q / (k k).
        RatioSquared,
        /// The ratio is sqrt(q).
        RatioNotByCutoff,
        /// The ratio goes up to 1.
        RatioUncapped,
        /// Within a bin the fragment farthest from its centre wins.
        RatioReversed,
        /// Bins are ignored: of all fragments the one nearest to its centre wins.
        BinIgnored,
        /// Bins are rounded to the nearest one.
        BinRounded,
        /// Bins are rounded up.
        BinCeiled,
        /// A bin more.
        BinCountOff,
        /// Bins of nearness.
        BinOfNearness,
        /// The range begins at the near plane.
        RangeFromNear,
        /// The range is that of the centres.
        RangeOfCenters,
        /// The paper's values, not in bins.
        VoronoiInDepths,

        /// The first group is left out of the sums.
        GroupNotSummed,
        /// The last group is added twice.
        GroupTwice,
        /// The nearest is that of the groups so far.
        NearestSoFar,
        /// The nearest is that of the first group.
        NearestOfTheFirst,
        /// The visible band begins at the depth of each group: all of them are visible.
        NearestIgnored,
        /// Only the nearest group is summed.
        NearestAlone,
        /// t <= nearest - epsilon.
        EpsilonSubtracted,
        /// t < nearest + epsilon.
        EpsilonStrict,
        /// Epsilon is half of what it should be.
        EpsilonHalf,
        /// Epsilon is twice what it should be.
        EpsilonDouble,
        /// Epsilon is compared with a difference of nearness.
        EpsilonOfNearness,
        /// The count begins at 1.
        CountOffByOne,
        /// All groups that are not empty are counted.
        CountOfAll,
        /// The sums are of 16 bits.
        HalfSums,
        /// The sums of colours saturate at 1.
        SumsSaturate,
        /// One sum of weights is 1e-3 too large.
        WeightOff,
        /// The depth of the picture is that of the last visible group.
        DepthOfTheLast,
        /// The depth of the picture is that of the heaviest group.
        DepthOfTheHeaviest,
        /// The id of the picture is that of the first visible group.
        IdOfTheFirst,
        /// Of equally near groups the last gives the id.
        IdTiesByGroup,
        /// The colour is not divided by the weight.
        ColorNotDivided,
        /// The colour is divided by the count.
        ColorByCount,
        /// The normal is not made a unit vector.
        NormalNotUnit,

        /// The normal is lit in world space.
        NormalNotTurned,
        /// The highlight looks away from the eye.
        SpecularSign,
        /// The picture is encoded as sRGB.
        Srgb,
        /// One pixel of the picture is NaN.
        PixelNan,
        /// The picture is upside down.
        RowsFlipped,
    }
}

impl Bug {
    /// The same mistake where splats are made, drawn and lit.
    pub(super) fn of_splats(self) -> Option<client::Bug> {
        Some(match self {
            Self::NoHalfPixel => client::Bug::NoHalfPixel,
            Self::CutoffSmaller => client::Bug::CutoffSmaller,
            Self::CutoffLarger => client::Bug::CutoffLarger,
            Self::RimOutside => client::Bug::RimOutside,
            Self::ExpWithoutHalf => client::Bug::ExpWithoutHalf,
            Self::DepthClampMissing => client::Bug::DepthClampMissing,
            Self::CullingIgnored => client::Bug::CullingIgnored,
            Self::SplatMissing => client::Bug::SplatMissing,
            Self::Depth16 => client::Bug::Depth16,
            Self::EpsilonHalf => client::Bug::EpsilonHalf,
            Self::EpsilonDouble => client::Bug::EpsilonDouble,
            Self::NormalNotTurned => client::Bug::NormalNotTurned,
            Self::SpecularSign => client::Bug::SpecularSign,
            _ => return None,
        })
    }
}
