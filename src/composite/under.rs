//! Alpha-blend transparent layers from front to back: each goes under what is there.
//!
//! The rule comes from [Porter, Duff 1984, *Compositing Digital Images*], with the colour over
//! black, that is, multiplied by its opacity:
//!
//! ```text
//!   start    C = 0, A = 0, T = 1
//!   layer    f = T a        if f > 0: C = C + f c, component by component, and A = A + f
//!            T = T (1 - a)
//! ```
//!
//! The layers nearest to the eye lose no digits, and T tells when nothing more can be seen. A
//! factor of 0 adds nothing, not even from an infinite colour. Laws:
//!
//! - a = 1 on a clear pixel gives the layer's colour unchanged and hides the rest.
//! - a = 0 changes nothing.
//! - Blending the same layers from back to front gives the same up to rounding.

use crate::number::Real;

/// Blended layers, and the light that they let through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Under<R> {
    /// C: linear RGB over black.
    pub color: [R; 3],
    /// A: opacity; rounding of the sum may leave it a few ulp above 1.
    pub alpha: R,
    /// T: how much of the background is seen. In [0, 1].
    pub through: R,
}

impl<R> Under<R> {
    /// Converts each number to another arithmetic.
    #[must_use]
    pub fn map<S>(self, f: impl Fn(R) -> S) -> Under<S> {
        Under { color: self.color.map(&f), alpha: f(self.alpha), through: f(self.through) }
    }
}

impl<R: Real> Under<R> {
    /// Nothing: black and transparent.
    pub const CLEAR: Self = Self { color: [R::ZERO; 3], alpha: R::ZERO, through: R::ONE };

    /// Blends the next farther layer; the opacity is in [0, 1], and the colour is not multiplied by
    /// it.
    #[inline(always)]
    #[must_use]
    pub fn under(self, alpha: R, color: [R; 3]) -> Self {
        let factor = self.through * alpha;
        let through = self.through * (R::ONE - alpha);
        let adds = factor.gt(R::ZERO);
        let part = |sum: R, value: R| R::select(adds, sum + factor * value, sum);
        let [r, g, b] = self.color;
        Self {
            color: [part(r, color[0]), part(g, color[1]), part(b, color[2])],
            alpha: R::select(adds, self.alpha + factor, self.alpha),
            through,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::{Lawful, under};
    use proptest::prelude::*;

    fn operator(above: Under<f64>, alpha: f64, color: [f64; 3]) -> Under<f64> {
        above.under(alpha, color)
    }

    fn lawful(found: Lawful) -> Result<(), TestCaseError> {
        found.map_err(|counterexample| TestCaseError::fail(counterexample.to_string()))
    }

    fn layer() -> impl Strategy<Value = (f64, [f64; 3])> {
        let alpha = prop_oneof![4 => 0.0..=1.0, 1 => Just(0.0), 1 => Just(1.0)];
        (alpha, [0.0..4.0, 0.0..4.0, 0.0..4.0])
    }

    proptest! {
        #[test]
        fn both_directions_agree(layers in prop::collection::vec(layer(), 0..12)) {
            lawful(under::closed_form(&operator, &layers))?;
        }

        #[test]
        fn opaque_hides_and_clear_is_neutral(
            layers in prop::collection::vec(layer(), 0..6),
            (_, color) in layer(),
        ) {
            lawful(under::ends(&operator, &layers, [color; 2]))?;
            lawful(under::infinite(&operator, &layers))?;
        }
    }
}
