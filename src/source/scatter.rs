//! Place many objects at random.
//!
//! The place i of a [`Scatter`], counted from 0, is computed in f64. Each operation is rounded. The
//! numbers `u_j` are [`random::unit`] of the seed and 5 i + j:
//!
//! ```text
//!   translation  low + u_0 (high - low) in x, likewise u_1 in y and u_2 in z
//!   scale        a + u_3 (b - a), of the range a to b
//!   rotation     transform::rotation of the axis and 360 u_4 degrees; with no axis none
//! ```

use crate::error::{Error, Result};
use crate::number::random;
use crate::scene::{Similarity, transform};
use glam::{DMat3, DVec3};

/// Random places, see the [module](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scatter {
    /// The number of places.
    pub count: u32,
    /// The random seed.
    pub seed: u64,
    /// The corner with the least coordinates of the box around the places.
    pub low: DVec3,
    /// The opposite corner.
    pub high: DVec3,
    /// The least and the greatest scale.
    pub scale: [f64; 2],
    /// The axis of a rotation by a random angle; `None` for no rotation.
    pub axis: Option<DVec3>,
}

impl Scatter {
    /// Checks that these numbers describe places.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the count is 0, if a corner is not finite or a coordinate of `low` is
    /// greater than in `high`, if the scales are not 0 < a <= b and finite, or if the axis is 0 or
    /// not finite.
    pub fn check(&self) -> Result<()> {
        let Self { count, low, high, scale: [a, b], axis, .. } = *self;
        let invalid = |what: &str| Err(Error::Invalid(format!("scatter: {what}")));
        if count == 0 {
            return invalid("a count of 0; give at least 1");
        }
        if !(low.is_finite() && high.is_finite() && low.cmple(high).all()) {
            return invalid("low and high must be finite numbers, low at most high");
        }
        if !(a > 0.0 && a <= b && b.is_finite()) {
            return invalid("scale must be two finite numbers > 0, the lower first");
        }
        if axis.is_some_and(|axis| !transform::is_axis(axis)) {
            return invalid("the axis must be finite and not 0");
        }
        Ok(())
    }

    /// The place `i`.
    #[must_use]
    pub fn place(&self, i: u32) -> Similarity {
        let unit = |j: u64| f64::from(random::unit(self.seed, 5 * u64::from(i) + j));
        let [a, b] = self.scale;
        Similarity {
            rotation: self
                .axis
                .map_or(DMat3::IDENTITY, |axis| transform::rotation(axis, 360.0 * unit(4))),
            scale: a + unit(3) * (b - a),
            translation: self.low + DVec3::new(unit(0), unit(1), unit(2)) * (self.high - self.low),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TREES: Scatter = Scatter {
        count: 9,
        seed: 0,
        low: DVec3::new(-8.0, 0.0, 0.0),
        high: DVec3::new(8.0, 0.0, 1.0),
        scale: [0.5, 1.5],
        axis: Some(DVec3::Y),
    };

    /// The first outputs of `SplitMix64` of the seed 0, as [`random`] has them from its author, and the
    /// formulas by hand.
    #[test]
    fn places_are_those_of_the_page() {
        let [u0, u2] = [0x00E2_20A8, 0x0006_C45D].map(|bits: u32| f64::from(bits) / 16_777_216.0);
        let place = TREES.place(0);
        assert_eq!(place.translation, DVec3::new(-8.0 + u0 * 16.0, 0.0, u2));
        assert_eq!((u0, place.translation.x), (0.883_310_794_830_322_3, 6.132_972_717_285_156));
        // Output 3 of the seed 0 is 0xF88BB8A8724C81EC, output 4 is 0x1B39896A51A8749B.
        let [u3, u4] = [0x00F8_8BB8, 0x001B_3989].map(|bits: u32| f64::from(bits) / 16_777_216.0);
        assert_eq!(place.scale, 0.5 + u3);
        assert_eq!(place.rotation, transform::rotation(DVec3::Y, 360.0 * u4));
        // Place 1 begins with output 5, 0x53CB9F0C747EA2EA.
        let u5 = f64::from(0x0053_CB9F) / 16_777_216.0;
        assert_eq!(TREES.place(1).translation.x, -8.0 + u5 * 16.0);
        let unturned = Scatter { axis: None, scale: [2.0, 2.0], ..TREES }.place(3);
        assert_eq!((unturned.rotation, unturned.scale), (DMat3::IDENTITY, 2.0));
    }

    #[test]
    fn every_place_is_one() {
        TREES.check().unwrap();
        for i in 0..TREES.count {
            let place = TREES.place(i);
            place.check().unwrap();
            assert!(place.translation.cmpge(TREES.low).all(), "{place:?}");
            assert!(place.translation.cmple(TREES.high).all(), "{place:?}");
        }
    }

    #[test]
    fn scatters_that_are_none_are_refused() {
        for bad in [
            Scatter { count: 0, ..TREES },
            Scatter { low: DVec3::splat(f64::NAN), ..TREES },
            Scatter { high: DVec3::splat(f64::INFINITY), ..TREES },
            Scatter { low: DVec3::splat(2.0), ..TREES },
            Scatter { scale: [0.0, 1.0], ..TREES },
            Scatter { scale: [1.0, 0.5], ..TREES },
            Scatter { scale: [1.0, f64::INFINITY], ..TREES },
            Scatter { axis: Some(DVec3::ZERO), ..TREES },
            Scatter { axis: Some(DVec3::NAN), ..TREES },
        ] {
            assert!(bad.check().is_err(), "{bad:?}");
        }
    }
}
