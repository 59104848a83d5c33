//! The mistakes that the renderer of Gaussian splats can be told to make, each one line where a
//! developer would make it.

use crate::verify::client::named::named;

named! {
    /// One-line mistakes.
    #[derive(Clone, Copy, PartialEq, Eq, Debug)]
    pub(crate) enum Bug {
        /// The low-pass filter has 0.1 px^2.
        LowPassSmall,
        /// The low-pass filter has 0.3 px^2.
        LowPassLarge,
        /// Opacities are not compensated for the filter.
        CompensationMissing,
        /// Opacities are compensated for the filter, although they should not be.
        CompensationAdded,
        /// The sign of the conic's xy: the quad is mirrored.
        ConicMirrored,
        /// xx and yy of the conic are exchanged.
        ConicExchanged,
        /// The rotation is read by columns.
        RotationTransposed,
        /// S = M^T M, in which the rotation cancels out.
        CovarianceReversed,
        /// The covariance is turned by W^T, not by W.
        ViewTransposed,
        /// A quaternion in memory is taken for one with w first.
        QuaternionWFirst,
        /// A quaternion whose w moved to the front is taken for one with w last.
        QuaternionWLast,
        /// The scales of x and y are exchanged.
        ScalesExchanged,
        /// The exponential is missing: the scales are what a PLY stores.
        ScaleLogarithm,
        /// The covariance is kept in half floats.
        HalfCovariance,
        /// The Jacobian is not bounded beside the picture.
        JacobianUnbounded,
        /// Degree 3 of the harmonics is not added.
        DegreeThreeMissing,
        /// The direction of the harmonics goes from the splat to the camera.
        DirectionReversed,
        /// The direction of the harmonics is in camera space, y down.
        DirectionOfCamera,
        /// The direction of the harmonics is in view space, y up.
        DirectionOfView,
        /// `f_rest` is read by coefficient, but stored by channel.
        RestByCoefficient,
        /// The harmonics lack their 1/2.
        HalfMissing,
        /// Colours below 0 stay.
        ColorsUnbounded,
        /// sRGB colours are decoded before they are blended.
        BlendedAsLinear,
        /// The picture is not decoded: the values on the screen are handed in.
        PictureNotDecoded,
        /// The opacity is 1.
        OpacityIgnored,
        /// The sigmoid is missing: the opacity is what a PLY stores.
        OpacityLogit,
        /// alpha may be 1.
        AlphaUnbounded,
        /// alpha is bounded by 0.99.
        AlphaBounded,
        /// Fragments from 1/256 of alpha count.
        LeastAlpha256,
        /// No alpha is too small.
        LeastAlphaMissing,
        /// exp(-q) in place of exp(-q/2).
        ExpWithoutHalf,
        /// Splats end at an ellipse of 3 standard deviations.
        CutoffThree,
        /// Splats end at an ellipse of sqrt(8) standard deviations.
        CutoffRootEight,
        /// Tiles of 8 pixels bound a splat.
        TilesOf8,
        /// No splat is too near, not even one behind the camera.
        NearMissing,
        /// Splats are sorted by their distance.
        SortedByDistance,
        /// Splats are sorted by their depth.
        SortedByDepth,
        /// Splats come from back to front.
        BackToFront,
        /// Ties go to the higher index.
        TiesReversed,
        /// Blending stops after the fragment that takes T below the stop, not before it.
        StopAfter,
        /// Blending never stops.
        StopMissing,
        /// Colours are multiplied by alpha twice.
        PremultipliedTwice,
        /// The background is added once too often.
        BackgroundTwice,
        /// Splats are not compared with the surface's depth, and its colour is not shown.
        SurfaceIgnored,
        /// Splats are not compared with the surface's depth.
        SurfaceNotTested,
        /// The surface's colour is not multiplied by the transmittance.
        SurfaceWhole,
        /// The background is shown in place of the surface's colour.
        SurfaceNotSeen,
        /// Weights are alpha, not T alpha.
        TransmittanceMissing,
        /// The rows are filled up to a multiple of 16 with splat 0.
        PaddingDrawn,
        /// The last splat is not drawn.
        LastMissing,
        /// Centres are rounded to the centres of pixels.
        CentersWhole,
        /// The corner of a pixel is taken for its centre.
        NoHalfPixel,
        /// The picture is upside down.
        RowsFlipped,
        /// The principal point is the middle of the picture.
        PrincipalPointIgnored,
        /// fx is taken for fy.
        FocalLengthOfX,
    }
}
