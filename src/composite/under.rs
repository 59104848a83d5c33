//! Alpha-blending of transparent layers from front to back: each goes under what is there.
//!
//! As [Porter, Duff 1984, *Compositing Digital Images*] have it, with the colour over black, that
//! is, multiplied by its opacity:
//!
//! ```text
//!   start    C = 0, A = 0, T = 1
//!   layer    f = T a        if f > 0: C = C + f c, component by component, and A = A + f
//!            T = T (1 - a)
//! ```
//!
//! The layers nearest to the eye lose no digits, and T tells when there is no more to see. A factor
//! of 0 adds nothing, even of an infinite colour. Laws: a = 1 on a clear pixel gives the layer's
//! colour unchanged and hides the rest; a = 0 changes nothing; blending the same layers from back
//! to front gives the same up to rounding.

use crate::number::Exact;

/// Layers that have been blended, and what they let through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Under<R> {
    /// C: linear RGB over black.
    pub color: [R; 3],
    /// A: opacity; rounding of the sum may leave it a few ulp above 1.
    pub alpha: R,
    /// T: the part of what lies behind that is seen. In [0, 1].
    pub through: R,
}

impl<R: Exact> Under<R> {
    /// Nothing: black and transparent.
    pub const CLEAR: Self = Self { color: [R::ZERO; 3], alpha: R::ZERO, through: R::ONE };

    /// The next farther layer, of an opacity in [0, 1] and a colour that is not multiplied by it.
    #[inline(always)]
    #[must_use]
    pub fn under(self, alpha: R, color: [R; 3]) -> Self {
        let factor = self.through * alpha;
        let through = self.through * (R::ONE - alpha);
        if !(factor > R::ZERO) {
            return Self { through, ..self };
        }
        let [r, g, b] = color;
        Self {
            color: [
                self.color[0] + factor * r,
                self.color[1] + factor * g,
                self.color[2] + factor * b,
            ],
            alpha: self.alpha + factor,
            through,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn front_to_back(layers: &[(f64, [f64; 3])]) -> Under<f64> {
        layers.iter().fold(Under::CLEAR, |below, &(alpha, color)| below.under(alpha, color))
    }

    /// From back to front: each layer over what is there.
    fn back_to_front(layers: &[(f64, [f64; 3])]) -> (f64, [f64; 3]) {
        layers.iter().rev().fold((0.0, [0.0; 3]), |(below, behind), &(alpha, color)| {
            let over = |front: f64, behind: f64| alpha * front + (1.0 - alpha) * behind;
            (over(1.0, below), [0, 1, 2].map(|c| over(color[c], behind[c])))
        })
    }

    fn layer() -> impl Strategy<Value = (f64, [f64; 3])> {
        let alpha = prop_oneof![4 => 0.0..=1.0, 1 => Just(0.0), 1 => Just(1.0)];
        (alpha, [0.0..4.0, 0.0..4.0, 0.0..4.0])
    }

    proptest! {
        #[test]
        fn both_directions_agree(layers in prop::collection::vec(layer(), 0..12)) {
            let found = front_to_back(&layers);
            let (alpha, color) = back_to_front(&layers);
            prop_assert!((found.alpha - alpha).abs() < 1e-14);
            prop_assert!((found.alpha + found.through - 1.0).abs() < 1e-14);
            for (found, expected) in found.color.iter().zip(color) {
                prop_assert!((found - expected).abs() < 1e-14 * 4.0);
            }
        }

        #[test]
        fn opaque_hides_and_clear_is_neutral(
            layers in prop::collection::vec(layer(), 0..6),
            (_, color) in layer(),
        ) {
            let mut opaque = vec![(1.0, color)];
            opaque.extend(&layers);
            let found = front_to_back(&opaque);
            prop_assert_eq!(found, Under { color, alpha: 1.0, through: 0.0 });
            let before = front_to_back(&layers);
            prop_assert_eq!(before.under(0.0, [f64::INFINITY; 3]), before);
        }
    }
}
