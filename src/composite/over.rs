//! Alpha-blend transparent layers.
//!
//! Colours are accumulated over black, that is, multiplied by their opacity. Whatever lies behind
//! is blended in at the end, times what the layers let through.

use super::sum;
use crate::number::MapInline;
use crate::number::Real;

/// Blended layers: their colour over black, and their opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend<R> {
    /// Linear RGB over black.
    pub color: [R; 3],
    /// Opacity in [0, 1].
    pub alpha: R,
}

impl<R> Blend<R> {
    /// Converts each number to another arithmetic.
    #[must_use]
    pub fn map<S>(self, f: impl Fn(R) -> S) -> Blend<S> {
        Blend { color: self.color.map(&f), alpha: f(self.alpha) }
    }
}

impl<R: Real> Blend<R> {
    /// Nothing: black and transparent.
    pub const CLEAR: Self = Self { color: [R::ZERO; 3], alpha: R::ZERO };

    /// The sum of two blends, as averaging needs it.
    #[inline(always)]
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self { color: sum::plus(self.color, other.color), alpha: self.alpha + other.alpha }
    }

    /// Puts the layers in front of something opaque: colour + (1 - A) `behind`, with opacity 1.
    #[inline(always)]
    #[must_use]
    pub fn before(self, behind: [R; 3]) -> Self {
        let through = R::ONE - self.alpha;
        Self { color: sum::plus(self.color, behind.map_inline(|c| through * c)), alpha: R::ONE }
    }

    /// Blends the next nearer layer, from back to front: `alpha c + (1 - alpha) below`, for the
    /// colour and, with c = 1, for the opacity \[ZP06, section 3.3\].
    ///
    /// ```
    /// use splatref::composite::over::Blend;
    ///
    /// let wall = Blend::<f32>::CLEAR.over(1.0, [0.0, 0.0, 1.0]);
    /// let behind_glass = wall.over(0.25, [1.0, 0.0, 0.0]);
    /// assert_eq!((behind_glass.color, behind_glass.alpha), ([0.25, 0.0, 0.75], 1.0));
    /// ```
    ///
    /// Laws: alpha = 1 leaves only the layer, and alpha = 0 leaves what was there. The opacity of
    /// layers is 1 - the product of their 1 - alpha, up to rounding.
    #[inline(always)]
    #[must_use]
    pub fn over(self, alpha: R, color: [R; 3]) -> Self {
        let through = R::ONE - alpha;
        let [r, g, b] = color;
        Self {
            color: [
                alpha * r + through * self.color[0],
                alpha * g + through * self.color[1],
                alpha * b + through * self.color[2],
            ],
            alpha: alpha + through * self.alpha,
        }
    }
}
