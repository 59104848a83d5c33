//! Whether a surfel is drawn, and why not.

use super::shape::PlacedDisc;
use super::{Footprint, Projector};
use crate::frame::Rect;
use crate::number::{Exact, Real};

/// What happens to a surfel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Fate {
    /// It is drawn.
    Visible,
    /// Its centre is not farther than the near plane.
    Behind,
    /// It has no footprint in this arithmetic, see [`mod@super::project`].
    Degenerate,
    /// Its back is seen, and culling is on.
    BackFacing,
    /// None of its pixels is in the picture, or it lies beyond a side of the view.
    Outside,
}

/// Why a surfel is not drawn, in the order of the fates; see [`mod@super::project`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reasons<R: Real> {
    /// The centre is not farther than the near plane: not t > near.
    pub behind: R::Truth,
    /// The surfel has no footprint in this arithmetic.
    pub degenerate: R::Truth,
    /// The back is seen, g >= 0, and culling is on.
    pub back_facing: R::Truth,
    /// The surfel cannot be seen in the picture. Empty bounds are a reason. Bounds that may be
    /// empty raise no doubt, because bounds are rounded outwards, and empty ones have no fragments.
    pub outside: R::Truth,
}

impl<R: Real> Reasons<R> {
    /// Whether there is any reason.
    #[inline(always)]
    #[must_use]
    pub fn any(&self) -> R::Truth {
        self.behind | self.degenerate | self.back_facing | self.outside
    }
}

impl<R: Exact> Reasons<R> {
    /// The first reason that holds; without a branch, so that a loop over surfels vectorizes.
    #[inline(always)]
    #[must_use]
    pub fn fate(&self) -> Fate {
        let fate = if self.outside { Fate::Outside } else { Fate::Visible };
        let fate = if self.back_facing { Fate::BackFacing } else { fate };
        let fate = if self.degenerate { Fate::Degenerate } else { fate };
        if self.behind { Fate::Behind } else { fate }
    }
}

impl<R: Real> Projector<R> {
    /// Whether a surfel is behind the near plane, or turned away.
    #[inline(always)]
    pub(super) fn turned_away(&self, placed: &PlacedDisc<R>) -> R::Truth {
        self.behind(placed) | self.back_facing(placed)
    }

    #[inline(always)]
    fn behind(&self, placed: &PlacedDisc<R>) -> R::Truth {
        !placed.t.gt(self.view.near)
    }

    #[inline(always)]
    fn back_facing(&self, placed: &PlacedDisc<R>) -> R::Truth {
        R::Truth::from(self.cull) & placed.g.ge(R::ZERO)
    }

    /// The reasons not to draw a surfel that follow from its place alone; see the module page.
    #[inline(always)]
    pub(super) fn unseen(&self, placed: &PlacedDisc<R>, radius: R) -> Reasons<R> {
        Reasons {
            behind: self.behind(placed),
            degenerate: R::Truth::from(false),
            back_facing: self.back_facing(placed),
            outside: !self.frustum.touches(placed.p, placed.t, radius),
        }
    }
}

/// All reasons not to draw a surfel: the ones from its place, and the ones from its footprint.
#[inline(always)]
pub(super) fn reasons<R: Real>(
    unseen: Reasons<R>,
    footprint: &Footprint<R>,
    bounds: &Rect,
) -> Reasons<R> {
    let f = footprint;
    // Comparisons with NaN are false, so each test is written as one that a good surfel passes.
    let largest = R::from_f32(LARGEST);
    let sound = f.amplitude.ge(R::from_f32(1.0 / LARGEST))
        & f.wx.abs().le(largest)
        & f.wy.abs().le(largest)
        & f.ux.le(largest)
        & f.uy.abs().le(largest)
        & f.vy.le(largest)
        & f.center.x.abs().le(largest)
        & f.center.y.abs().le(largest)
        & f.w_far.is_finite()
        & f.w_near.is_finite();
    Reasons {
        degenerate: !sound,
        outside: R::Truth::from(bounds.is_empty()) | unseen.outside,
        ..unseen
    }
}

/// 2^96: the largest allowed number of a footprint; its inverse is the least allowed amplitude. A
/// product with any pixel offset (2^17) or any squared term then stays within `f32`.
const LARGEST: f32 = 79_228_162_514_264_337_593_543_950_336.0;
