//! The mistakes that a client can be told to make, each one line where a developer would make it.

use super::named::named;

named! {
    /// One-line mistakes.
    #[derive(Clone, Copy, PartialEq, Eq, Debug)]
    pub(crate) enum Bug {
        /// The corner of a pixel is taken for its centre.
        NoHalfPixel,
        /// The principal point is half a pixel too far right.
        PrincipalPointOff,
        /// Normals are turned by the transpose of the view's rotation.
        NormalsTransposed,
        /// The radius is the standard deviation, not divided by k.
        RadiusNotDivided,
        /// No low-pass filter.
        LowPassMissing,
        /// Twice the variance of the low-pass filter.
        LowPassDoubled,
        /// h is added to the radius in pixels, not to the variance.
        LowPassOnRadius,
        /// The ellipse is mirrored: the sign of the covariance xy.
        SkewSign,
        /// The weight at the centre is 1 whatever the filter does.
        AmplitudeMissing,
        /// The front is culled.
        CullingInverted,
        /// Nothing is culled.
        CullingIgnored,
        /// Quads reach 0.9 of the extent.
        QuadsTooSmall,
        /// Quads have an integer radius, rounded down.
        QuadsFloored,
        /// The slope of the plane down the screen has the wrong sign.
        SlopeSign,
        /// The depth of a fragment is that of the disc's centre.
        DepthOfCenter,
        /// Depth is not clamped to that of the disc.
        DepthClampMissing,
        /// q is compared with k.
        CutoffNotSquared,
        /// The limit of q is too small by 1e-5 of it.
        CutoffSmaller,
        /// The limit of q is too large by 1e-5 of it.
        CutoffLarger,
        /// The limit of q is too small by 2e-6 of it.
        CutoffBarelySmaller,
        /// The limit of q is too large by 2e-6 of it.
        CutoffBarelyLarger,
        /// The limit of q is too small by 4e-5 of it.
        CutoffVisiblySmaller,
        /// The limit of q is too large by 4e-5 of it.
        CutoffVisiblyLarger,
        /// The rim, q = k k, is outside.
        RimOutside,
        /// The attribute pass divides the form by w0 w0 in place of w w.
        RaysAffine,
        /// exp(-q) in place of exp(-q/2).
        ExpWithoutHalf,
        /// A fast exp, 1e-4 too large.
        FastExp,
        /// Fragments in the quad that are discarded have written depth.
        DiscardedWriteDepth,
        /// Of equally near fragments the one of the higher index wins.
        TiesReversed,
        /// A depth buffer of 16 bits.
        Depth16,
        /// The id is written without a depth test.
        IdOfTheLast,
        /// t <= nearest - epsilon.
        EpsilonSubtracted,
        /// t < nearest + epsilon.
        EpsilonStrict,
        /// Epsilon is half of what it should be.
        EpsilonHalf,
        /// Epsilon is twice what it should be.
        EpsilonDouble,
        /// Every fragment is visible.
        EpsilonIgnored,
        /// Epsilon is compared with a difference of nearness.
        EpsilonOfNearness,
        /// Epsilon is compared with a difference of what a depth buffer holds.
        EpsilonOfDepthBuffer,
        /// Epsilon is a distance along the ray of the pixel.
        EpsilonAlongRay,
        /// Epsilon in radii is in those of the nearest surfel.
        EpsilonOfNearestRadius,
        /// Epsilon in radii is in world units, or the reverse.
        EpsilonOtherUnit,
        /// t > nearest + epsilon.
        EpsilonReversed,
        /// The visibility pass draws discs that are moved back by epsilon, and hands in their depth.
        DiscsMovedBack,
        /// It draws discs that are moved towards the eye.
        DiscsMovedForward,
        /// What is seen from behind keeps its normal.
        NormalsNotReversed,
        /// The sums are of 16 bits.
        HalfSums,
        /// The sums of colours saturate at 1, as in a target of unorm.
        SumsSaturate,
        /// The count of fragments begins at 1.
        CountOffByOne,
        /// Sums begin with the nearest fragment, which is then added again.
        NearestTwice,
        /// The middle one of the splats is not drawn.
        SplatMissing,
        /// The middle one of the splats is drawn twice in the attribute pass.
        SplatTwice,
        /// The second tile of the second row, 16 x 16 pixels, is not drawn.
        TileDropped,
        /// The colour is not divided by the weight.
        ColorNotDivided,
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
        /// One pixel's weight is 1e-3 too large.
        WeightOff,
        /// The picture is upside down.
        RowsFlipped,
    }
}
