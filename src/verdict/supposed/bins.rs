//! Other depths for the test of Voronoi rasterization: another bin, or another place within it.

use super::Supposed;
use crate::composite::bins::DepthBins;
use crate::method::single_pass::geometry::ratio;
use crate::number::ball::Profile;
use crate::number::{Ball, MapInline, Real};

/// A distance from the centre of a splat that is not part of its radius.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OtherRatio {
    /// The first fragment of a bin stays.
    Missing,
    /// The ratio is subtracted.
    Subtracted,
    /// The square of the ratio.
    Squared,
    /// The distance in standard deviations.
    NotByCutoff,
    /// The ratio goes up to 1, which is the next bin.
    UpTo1,
    /// The fragment farthest from its centre wins.
    Reversed,
}

/// Another bin of a depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OtherBin {
    /// The nearest one, not the one that is rounded down to.
    Nearest,
    /// The one that is rounded up to.
    Up,
    /// One bin for all depths.
    One,
    /// The next bin: bins are counted from 1.
    Next,
}

impl Supposed {
    /// The least and the greatest bin at these ends of a position in bins.
    pub(crate) fn bins<P: Profile>(self, bins: &DepthBins<Ball<P>>, ends: [f64; 2]) -> [f64; 2] {
        ends.map_inline(|end| {
            let position = match self {
                Self::Bin(OtherBin::Nearest) => end + 0.5,
                Self::Bin(OtherBin::Up) => end.ceil(),
                Self::Bin(OtherBin::One) => 0.0,
                _ => end,
            };
            let bin = bins.bin_of(Ball::exact(position)).middle;
            if self == Self::Bin(OtherBin::Next) { bin + 1.0 } else { bin }
        })
    }

    /// The part of a bin that a fragment lies in.
    pub(crate) fn part<P: Profile>(self, q: Ball<P>, limit: Ball<P>) -> Ball<P> {
        let Self::Ratio(other) = self else { return ratio(q, limit) };
        match other {
            OtherRatio::Missing => Ball::ZERO,
            OtherRatio::Squared => q / limit,
            OtherRatio::NotByCutoff => q.root_of_squares(),
            OtherRatio::Reversed => Ball::ONE - ratio(q, limit),
            OtherRatio::Subtracted | OtherRatio::UpTo1 => ratio(q, limit),
        }
    }

    /// The key of a bin and a part of it.
    pub(crate) fn key<P: Profile>(self, bin: Ball<P>, part: Ball<P>) -> Ball<P> {
        match self {
            Self::Ratio(OtherRatio::Subtracted) => -DepthBins::within(-bin, part),
            Self::Ratio(OtherRatio::UpTo1) => bin + part.at_most(Ball::ONE),
            _ => DepthBins::within(bin, part),
        }
    }
}
