//! Low-precision and Voronoi-enhanced depth \[ZP06, eq. 6 and 10\].
//!
//! `d_min` and `d_max` are the nearest and the farthest depth, and n is the number of bins. Both
//! depths below are in units of a bin, that is n times the paper's value. (`Departs:` a final
//! product with 1/n would only round digits away, and no comparison needs it.)
//!
//! ```text
//!   bin(t)        = floor(((t - d_min) / (d_max - d_min)) n), brought into [0, n]          eq. 6
//!   z(t, ratio)   = bin(t) + (ratio, at most 255/256)                                      eq. 10
//!   ratio         = d_i / r_i, the distance from the splat's centre as a part of its radius
//! ```
//!
//! in this order of operations. Bins may be [moved](DepthBins::moved) towards the eye by a part of
//! a bin. That part is then added to `((t - d_min) / (d_max - d_min)) n` before rounding down.
//!
//! `Departs:` at the rim of a splat the ratio is 1, and eq. 10 gives the value of the next bin's
//! centre. The ratio therefore ends at 255/256, which added to a bin up to [`MAX_BINS`] is exact in
//! `f32`.
//!
//! `Departs:` section 5.1 contradicts itself about an overlap. It first says that the splat with
//! the *lower* weight gives colour and weight, then that fragments with *lower* weights are culled.
//! The second is meant: by eq. 10, and the words under it, the fragment nearest to its own centre
//! wins, and that fragment has the higher weight.
//!
//! Laws, for numbers t >= 0 as depths are:
//!
//! - `bin` never falls as t grows: no rounding swaps two layers.
//! - Depths in [`d_min`, `d_max`] that differ by at least (1 + 2^-5) `(d_max - d_min) / n` are in
//!   different bins, and then z decides as the depth does, whatever the ratios. (In exact
//!   arithmetic 1/n is enough; `f32` with the most bins rounds away up to 2^-5 of a bin.) All
//!   depths beyond an end are in the bin of that end.
//! - Within a bin z never falls as the ratio grows: the fragment nearest to its own centre wins.
//!   Two ratios may tie if they differ by no more than the spacing of `f32` at the bin, at most
//!   2^-8; all ratios from 255/256 on tie.

use crate::error::{Error, Result};
use crate::number::Real;

/// The most bins: with so many, z still tells 256 ratios apart in `f32`.
pub const MAX_BINS: u32 = 65_535;

/// The range of depth that is divided, and the number of bins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// `d_min`: the nearest depth.
    pub nearest: f32,
    /// `d_max`: the farthest depth, greater than the nearest.
    pub farthest: f32,
    /// n: how many bins, 1 to [`MAX_BINS`].
    pub count: u32,
}

impl Range {
    /// Makes bins as deep as `epsilon`, or a little less: n = `ceil((d_max - d_min) / epsilon)`, in
    /// f64.
    ///
    /// \[ZP06, section 4.2.1\]: `n >= (d_max - d_min) / epsilon`. At least one bin.
    ///
    /// # Errors
    /// [`Error::Invalid`] if that takes more than [`MAX_BINS`].
    pub fn of_epsilon(nearest: f32, farthest: f32, epsilon: f32) -> Result<Self> {
        let count = ((f64::from(farthest) - f64::from(nearest)) / f64::from(epsilon)).ceil();
        if count <= f64::from(MAX_BINS) {
            // A count below 1 becomes 1.
            let count = if count < 1.0 { 1 } else { count as u32 };
            Ok(Self { nearest, farthest, count })
        } else {
            Err(Error::Invalid(format!(
                "epsilon {epsilon} needs {count} depth bins from {nearest} to {farthest}; give a \
                 larger epsilon, or at most {MAX_BINS} bins"
            )))
        }
    }
}

/// A [`Range`] in the numbers of the arithmetic.
#[derive(Clone, Copy, Debug)]
pub struct DepthBins<R> {
    nearest: R,
    extent: R,
    count: R,
    /// The part of a bin by which the bins are moved towards the eye, if they are moved.
    shift: Option<R>,
}

impl<R: Real> DepthBins<R> {
    /// The bins of a range.
    #[must_use]
    pub fn new(range: &Range) -> Self {
        let nearest = R::from_f32(range.nearest);
        // At most 65,535, so the count is exact.
        let count = R::from_f32(range.count as f32);
        Self { nearest, extent: R::from_f32(range.farthest) - nearest, count, shift: None }
    }

    /// The same bins moved towards the eye by this part of a bin, at least 0 and less than 1. The
    /// first and the last bin still reach beyond the range.
    #[must_use]
    pub fn moved(self, shift: f32) -> Self {
        Self { shift: Some(R::from_f32(shift)), ..self }
    }

    /// The bin of a depth, an integer in [0, n]: the low-precision depth \[ZP06, eq. 6\], times n.
    #[inline(always)]
    pub fn bin(&self, t: R) -> R {
        self.bin_of(self.position(t))
    }

    /// The depth in bins, counted from the start of the first bin, before it is rounded down.
    #[inline(always)]
    pub fn position(&self, t: R) -> R {
        self.moving(self.unmoved(t))
    }

    /// The same for bins that are not moved.
    #[inline(always)]
    pub fn unmoved(&self, t: R) -> R {
        ((t - self.nearest) / self.extent) * self.count
    }

    /// The position in these bins, from the position in the same bins before they were moved.
    #[inline(always)]
    pub fn moving(&self, position: R) -> R {
        match self.shift {
            Some(shift) => position + shift,
            None => position,
        }
    }

    /// The bin of a position.
    #[inline(always)]
    pub fn bin_of(&self, position: R) -> R {
        position.floor().clamped(R::ZERO, self.count)
    }

    /// The Voronoi-enhanced depth \[ZP06, eq. 10\], times n; `ratio` >= 0.
    #[inline(always)]
    pub fn voronoi(&self, t: R, ratio: R) -> R {
        Self::within(self.bin(t), ratio)
    }

    /// The paper's value of a depth in bins: the depth divided by n.
    #[inline]
    pub fn share(&self, z: R) -> R {
        z / self.count
    }

    /// The Voronoi-enhanced depth in a bin.
    #[inline(always)]
    pub fn within(bin: R, ratio: R) -> R {
        bin + ratio.at_most(R::from_f32(255.0 / 256.0))
    }
}
