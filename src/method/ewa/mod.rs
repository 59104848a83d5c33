//! EWA surface splatting in two geometry passes and a normalization.
//!
//! The passes of \[GBP04, section 3\] (after \[GP03\]) and of the 2+1-pass method of \[ZP06,
//! section 3.1\]:
//!
//! 1. **Projection.** Each surfel becomes a [`Splat`] (see [`mod@crate::splat::project`]).
//! 2. **Visibility splatting.** Each pixel keeps the greatest nearness of all fragments that are
//!    inside (q <= k^2), and the surfel it came from. Ties: the lower surfel index.
//! 3. **Attribute splatting.** Each fragment that is inside and whose depth passes the epsilon-z
//!    test `t <= t_nearest + epsilon` adds its weight, weight times normal and weight times colour,
//!    in ascending surfel index. A surfel seen from behind adds its normal reversed, so that
//!    surfels without a consistent orientation do not cancel (`Decided:`).
//! 4. **Normalization.** Depth from nearness; colour = sum / weight; normal = direction of sum /
//!    weight. A pixel without weight is empty.
//! 5. **Deferred shading**, see [`crate::shade`].
//!
//! [`plain`] is the definition, over any [`Exact`] number and one fragment at a time; [`fast`] gives
//! the same bits for `f32`. [`explain`] lists every decision at one pixel.
//!
//! [`Splat`]: crate::splat::Splat
//! [`Exact`]: crate::number::Exact

pub mod explain;
pub mod fast;
mod picture;
pub mod plain;

pub use picture::{render, render_f32, render_f32_again};

use crate::error::{Error, Result};
use crate::scene::Surfels;
use crate::splat::Kernel;

/// What is computed; everything here may change the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Reconstruction kernel and low-pass filter.
    pub kernel: Kernel,
    /// Depth of the band that belongs to the visible surface.
    pub epsilon: Epsilon,
    /// Whether surfels seen from behind are dropped. On by default: at the silhouette of a closed
    /// surface, discs of its far side stick out.
    pub cull: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { kernel: Kernel::DEFAULT, epsilon: Epsilon::default(), cull: true }
    }
}

/// A depth, in one of two units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Epsilon {
    /// World units.
    World(f32),
    /// Multiples of the median radius of the scene's surfels.
    MedianRadii(f32),
}

impl Default for Epsilon {
    /// One median radius.
    fn default() -> Self {
        Self::MedianRadii(1.0)
    }
}

impl Epsilon {
    /// The depth in world units; the product with the median is rounded once.
    #[must_use]
    pub fn resolve(&self, surfels: &Surfels) -> f32 {
        match *self {
            Self::World(depth) => depth,
            Self::MedianRadii(count) => count * surfels.median_radius(),
        }
    }
}

impl Settings {
    /// Whether the numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the kernel is out of range, or epsilon is negative or NaN.
    pub fn check(&self) -> Result<()> {
        self.kernel.check()?;
        let (Epsilon::World(value) | Epsilon::MedianRadii(value)) = self.epsilon;
        if value >= 0.0 {
            Ok(())
        } else {
            Err(Error::Invalid(format!("epsilon: {value}; give a number >= 0")))
        }
    }
}
