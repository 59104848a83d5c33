//! Mistakes that are supposed to be the rule, while the mistake behind a wrong picture is searched.
//!
//! [`crate::verdict::causes`] judges a client again, as if one of these were the rule. Each is one
//! change to the reference, where an author of a renderer would make it: in the projection of a
//! splat, in the weight of a fragment, in the sums, or in the averages.

mod bins;
mod splats;

pub(crate) use bins::{OtherBin, OtherRatio};

use crate::composite::sum;
use crate::method::ewa::attributes::Sums;
use crate::method::pyramid::pull;
use crate::number::ball::{Profile, Three};
use crate::number::{Ball, MapInline, Real, Vector3};
use crate::splat::{Footprint, View};
use crate::verdict::checks::widened;
use crate::verdict::storage::Storage;

/// A rule in place of the method's own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Supposed {
    /// The method's own rules.
    #[default]
    Nothing,
    /// Ellipses lean to the other side: the covariance of column and row has the other sign.
    Mirrored,
    /// Columns and rows of the covariance are exchanged.
    Transposed,
    /// The standard deviation of a splat is this many times as large.
    Spread(f64),
    /// The low-pass filter is added to the radius in pixels, not to the variance.
    FilterOnRadius,
    /// The weight at a centre is 1, whatever the low-pass filter is.
    NoAmplitude,
    /// Depth changes the wrong way across, or down, the screen.
    SlopeAcross,
    SlopeDown,
    /// All fragments of a splat have the depth of its centre.
    DepthOfCenter,
    /// Depths are not clamped to those of the disc.
    DepthNotClamped,
    /// Quads have this many times their size.
    Quads(f64),
    /// The half side of a quad is rounded down to whole pixels.
    QuadsWhole,
    /// No half side of a quad is larger than this, in pixels.
    QuadsAtMost(f64),
    /// The limit of q is this many times as large.
    Limit(f64),
    /// The fragments of a splat are moved by so many pixels within its quad.
    Moved([f32; 2]),
    /// Centres are rounded to the centres of pixels.
    CentersWhole,
    /// Colours are sums, not averages.
    ColorsNotDivided,
    /// Colours are divided by the number of fragments.
    ColorsByCount,
    /// exp(-q) in place of exp(-q/2).
    ExpWithoutHalf,
    /// Weights that may be off by this part of themselves.
    CoarseExp(f64),
    /// Weights in half floats.
    HalfWeights,
    /// What is seen from behind keeps its normal.
    BacksNotTurned,
    /// Sums of colours end at 1.
    ColorsSaturate,
    /// The count of fragments begins at 1.
    CountFromOne,
    /// The nearest fragment is added twice.
    NearestTwice,
    /// One surfel is added twice.
    Twice(u32),
    /// Normals are averages, not unit vectors.
    NormalsNotUnit,
    /// Normals in world space meet lights in view space.
    LitUnturned,
    /// Another distance from the centre in the depth of Voronoi rasterization.
    Ratio(OtherRatio),
    /// Another bin of a depth.
    Bin(OtherBin),
    /// Normals of the picture stay in view space.
    NormalsOfView,
    /// The pull, or the push, takes cells of this many times their side.
    PullSide(f32),
    PushSide(f32),
    /// The side of the cells is 1 at every level.
    SidesOf1,
    /// All cells are averaged, whatever their depths are.
    AllOverlap,
    /// No cell that the pull has filled is occluded.
    NothingOccluded,
    /// Gaussians come in the reverse order.
    BackToFront,
    /// Of Gaussians with the same key, the one of the higher index is in front.
    HigherIndexFirst,
    /// No Gaussian is too near, not even one behind the camera.
    NearIgnored,
    /// Blending of Gaussians ends after the fragment that takes the transmittance below the stop.
    StopAfter,
    /// Colours of Gaussians are multiplied by alpha twice.
    ColorsTwice,
    /// The light behind Gaussians is added twice.
    BackgroundTwice,
    /// Covariances of Gaussians may be rounded to half floats.
    HalfCovariance,
    /// The surface has no effect.
    SurfaceIgnored,
    /// Gaussians behind the surface are drawn.
    SurfaceNotTested,
    /// The surface's colour is not multiplied by the transmittance.
    SurfaceWhole,
    /// What is seen behind Gaussians is the background, where there is a surface too.
    SurfaceNotSeen,
}

impl Supposed {
    /// The weight of a fragment.
    #[inline(always)]
    pub(crate) fn weight<P: Profile>(self, of: &Footprint<Ball<P>>, q: Ball<P>) -> Ball<P> {
        match self {
            Self::ExpWithoutHalf => of.amplitude * (-q).exp(),
            Self::CoarseExp(part) => {
                let weight = of.weight(q);
                widened(weight, part * weight.middle.abs())
            }
            Self::HalfWeights => {
                let weight = of.weight(q);
                widened(weight, Storage::Half.radius(weight.middle))
            }
            _ => of.weight(q),
        }
    }

    /// The limit of q.
    pub(crate) fn limit<P: Profile>(self, limit: Ball<P>) -> Ball<P> {
        if let Self::Limit(by) = self { limit * Ball::exact(by) } else { limit }
    }

    /// How many times as far as its surfel a splat may reach.
    pub(crate) fn spread(self) -> f64 {
        match self {
            Self::Spread(by) => by.at_least(1.0),
            // Sides are exchanged. One is at most 1 + tan(a/2) times as long as the other, in a
            // field of view a that is at most 143 degrees.
            Self::Transposed => 4.0,
            _ => 1.0,
        }
    }

    /// Whether a normal is turned.
    #[inline(always)]
    pub(crate) fn turned(self, back: Three) -> Three {
        if self == Self::BacksNotTurned { false.into() } else { back }
    }

    /// How often a fragment is added, which is the nearest one or not.
    #[inline(always)]
    pub(crate) fn times(self, surfel: u32, is_nearest: bool) -> u32 {
        match self {
            Self::NearestTwice if is_nearest => 2,
            Self::Twice(twice) if twice == surfel => 2,
            _ => 1,
        }
    }

    /// Sums as the client may have added them.
    pub(crate) fn sums<P: Profile>(self, sums: Sums<Ball<P>>) -> Sums<Ball<P>> {
        match self {
            Self::ColorsSaturate => {
                Sums { color: sums.color.map_inline(|part| part.at_most(Ball::ONE)), ..sums }
            }
            Self::CountFromOne => Sums { count: sums.count.saturating_add(1), ..sums },
            _ => sums,
        }
    }

    /// A normal of the picture, which is in world space.
    pub(crate) fn in_space<P: Profile>(
        self,
        view: &View<Ball<P>>,
        normal: [Ball<P>; 3],
    ) -> [Ball<P>; 3] {
        let [x, y, z] = normal;
        if self == Self::NormalsOfView {
            let turned = view.direction(Vector3::new(x, y, z));
            [turned.x, turned.y, turned.z]
        } else {
            normal
        }
    }

    /// The side of the cells that the pull reads at a level.
    pub(crate) fn pull_side<R: Real>(self, level: usize) -> R {
        match self {
            Self::PullSide(by) => pull::side::<R>(level) * R::from_f32(by),
            Self::SidesOf1 => R::ONE,
            _ => pull::side(level),
        }
    }

    /// The side of the cells that the push leaves at a level.
    pub(crate) fn push_side<R: Real>(self, level: usize) -> R {
        match self {
            Self::PushSide(by) => pull::side::<R>(level) * R::from_f32(by),
            Self::SidesOf1 => R::ONE,
            _ => pull::side(level),
        }
    }

    /// The average of a sum of colours.
    pub(crate) fn color<P: Profile>(
        self,
        color: [Ball<P>; 3],
        weight: Ball<P>,
        count: Option<u8>,
    ) -> [Ball<P>; 3] {
        match (self, count) {
            (Self::ColorsNotDivided, _) => color,
            (Self::ColorsByCount, Some(count)) => sum::average(color, Ball::from_f32(count.into())),
            _ => sum::average(color, weight),
        }
    }

    /// The direction of a sum of normals.
    pub(crate) fn direction<P: Profile>(
        self,
        normal: [Ball<P>; 3],
        weight: Ball<P>,
    ) -> [Ball<P>; 3] {
        if self == Self::NormalsNotUnit {
            sum::average(normal, weight)
        } else {
            sum::direction(normal, weight)
        }
    }
}
