//! Whether a surfel is drawn, and why not.

use crate::number::{Exact, Real};

/// What became of a surfel.
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

/// Why a surfel is not drawn, in the order of the fates; see
/// [`mod@super::project`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reasons<R: Real> {
    /// The centre is not farther than the near plane: not t > near.
    pub behind: R::Truth,
    /// The surfel has no footprint in this arithmetic.
    pub degenerate: R::Truth,
    /// The back is seen, g >= 0, and culling is on.
    pub back_facing: R::Truth,
    /// The surfel cannot be seen in the picture. Empty bounds are a reason, but bounds that may be
    /// empty are no doubt: bounds are rounded outwards, and empty ones have no fragments.
    pub outside: R::Truth,
}

impl<R: Real> Reasons<R> {
    /// Whether there is any reason.
    #[must_use]
    pub fn any(&self) -> R::Truth {
        self.behind | self.degenerate | self.back_facing | self.outside
    }
}

impl<R: Exact> Reasons<R> {
    /// The first reason there is; without a branch, so that a loop over surfels vectorizes.
    #[inline(always)]
    #[must_use]
    pub fn fate(&self) -> Fate {
        let fate = if self.outside { Fate::Outside } else { Fate::Visible };
        let fate = if self.back_facing { Fate::BackFacing } else { fate };
        let fate = if self.degenerate { Fate::Degenerate } else { fate };
        if self.behind { Fate::Behind } else { fate }
    }
}
