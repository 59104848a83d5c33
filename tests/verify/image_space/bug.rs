//! The mistakes that a client can be told to make, each one line where a developer would make it.

use crate::verify::client::named::named;

named! {
    /// One-line mistakes: of both methods, of `template`, of `pyramid`.
    #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Debug)]
    pub(crate) enum Bug {
        /// The pixel of a point is found from half a pixel farther left and up.
        HalfPixelOff,
        /// The principal point is half a pixel too far right.
        PrincipalPointOff,
        /// Normals stay in world space.
        NormalInWorld,
        /// What is seen from behind keeps its normal.
        BackNotReversed,
        /// The front is culled.
        CullingInverted,
        /// Nothing is culled.
        CullingIgnored,
        /// The last surfel of a pixel stays.
        NoDepthTest,
        /// The farthest surfel of a pixel stays.
        DepthTestReversed,
        /// Of equally near surfels the one of the higher index stays.
        TiesReversed,
        /// The depth of a surfel is that of the nearest point of its sphere.
        DepthOfNearPoint,
        /// The radius in pixels is not divided by the depth.
        ExtentNotByDepth,
        /// The diameter in pixels is taken for the radius.
        ExtentIsDiameter,
        /// The middle one of the surfels is not drawn.
        SurfelMissing,
        /// A level is half as large as the finer one, rounded down.
        OddSizeRoundedDown,
        /// The levels are handed in upside down.
        LevelsFlipped,
        /// The levels are half floats.
        HalfLevels,
        /// One cell of level 1 is empty.
        CellDropped,
        /// One cell of level 1 is NaN.
        CellNan,
        /// Averages are a quarter of the sum, whatever takes part.
        AverageOfFour,
        /// Ellipses are circles.
        TiltIgnored,
        /// The tilt down the screen has the wrong sign.
        TiltSign,
        /// The rim is outside.
        RimOutside,
        /// What is outside is taken for inside.
        InsideReversed,
        /// The form is compared with the radius.
        RadiusNotSquared,
        /// The normal is not made a unit vector.
        NormalNotUnit,
        /// The normal of the picture stays in view space.
        NormalNotTurned,
        /// The picture is encoded with a gamma of 2.
        SquareRootOfPicture,
        /// One pixel of the picture is NaN.
        PixelNan,

        /// The levels of a template of 5 x 5 are those of the radius.
        LevelsByRadius,
        /// Every level can show as much as level 0.
        ReachNotDoubled,
        /// A radius equal to the reach moves on.
        ReachStrict,
        /// What is too large for the top level is lost.
        TopMovesOn,
        /// Centres that stay move on too.
        StayingMovesOn,
        /// The foremost is the farthest.
        ForemostIsFarthest,
        /// Of equally near centres the last is the foremost.
        ForemostByLast,
        /// All centres that meet in a cell are merged.
        MergeWithoutDepth,
        /// Touching spheres are not merged.
        MergeStrict,
        /// The radius of the foremost is subtracted.
        MergeRadiusSign,
        /// A merged centre has the id of the last.
        IdOfTheLast,
        /// A merged centre has the place of the foremost.
        PlaceNotMerged,
        /// The coarsest level is searched first.
        CoarseLevelsFirst,
        /// The template reaches a cell less to every side.
        TemplateTooSmall,
        /// The rows of a template are searched from below.
        RowsFromBelow,
        /// The corner of a pixel is taken for its centre.
        CornerOfPixel,
        /// A pixel does not see the centre in it whose ellipse does not hold it.
        OwnPixelLost,
        /// w = 1 - d d.
        WeightWithoutRoot,
        /// No least weight at the rim.
        RimWithoutWeight,
        /// The ternary test knows the radius of the centre alone.
        TernaryOfOneRadius,
        /// The ternary test subtracts the radius of the front.
        TernaryRadiusSign,
        /// A centre before the front is added to the sums.
        HiddenFrontStays,
        /// A centre behind the front is added to the sums.
        HiddenBlended,
        /// The front stays the first centre.
        FrontNotUpdated,
        /// The front is the last centre added.
        FrontIsTheLast,
        /// Normals are added without weights.
        NormalsNotWeighted,
        /// The colour is not divided by the weight.
        ColorNotDivided,
        /// The depth of the picture is that of the nearest centre.
        DepthOfTheNearest,

        /// Averages are not kept within what is averaged; with weights 1 the bounds hold.
        AverageUnbounded,
        /// The interval of depth is [t - r, t + r].
        IntervalAround,
        /// The interval of depth is [t, t].
        IntervalWithoutRadius,
        /// A sample lies where its surfel is, not at the centre of its pixel.
        PlaceWithinPixel,
        /// The side of the cells is 1 at every level.
        SideNotDoubled,
        /// In the pull, finer cells lie a whole side from the new centre.
        DisplacementNotHalved,
        /// In the pull, the left column lies right of the new centre.
        DisplacementSign,
        /// In the pull, a new cell has the displacement of the foremost.
        CornerForgotten,
        /// In the pull, all valid cells are candidates.
        PullOfAll,
        /// In the pull, the interval is that of the foremost.
        BackOfTheForemost,
        /// In the pull, intervals are averaged.
        IntervalAveraged,
        /// The foremost is the last candidate.
        ForemostIsLast,
        /// Of equally near cells the last is the foremost.
        ForemostTiesReversed,
        /// The foremost is that whose interval ends first.
        ForemostByBack,
        /// All candidates are averaged, in the pull and in the push.
        OverlapIgnored,
        /// Intervals that touch do not overlap.
        OverlapStrict,
        /// Level 1 is not pushed.
        LevelNotPushed,
        /// Coarser cells are taken as the pull left them.
        PushFromPulled,
        /// The neighbours of the parent are those on the other side.
        NeighborOtherSide,
        /// The neighbours of the parent lie half a side from the finer centre.
        NeighborTooNear,
        /// Occluded cells without a surface before them become empty.
        OccludedEmptied,
        /// Only empty cells are interpolated.
        OccludedStays,
        /// A cell behind the front of its parent is occluded.
        OccludedByFront,
        /// A cell where its parent's interval ends is occluded.
        OccludedByTouch,
        /// The push averages without the test of depth.
        OccludedBlended,
        /// The push weighs all alike.
        PushUnweighted,
        /// exp(-d d) in place of exp(-2 d d).
        ExpWithoutTwo,
        /// exp(-2 d).
        ExpOfTheRoot,
        /// The depth of the picture is where the interval ends.
        DepthOfBack,
    }
}

impl Bug {
    pub(super) fn of_template(self) -> bool {
        self < Self::AverageUnbounded
    }

    pub(super) fn of_pyramid(self) -> bool {
        self < Self::LevelsByRadius || self >= Self::AverageUnbounded
    }
}
