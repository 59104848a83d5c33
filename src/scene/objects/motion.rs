//! Move an object over the frames of a sequence.
//!
//! A [`Motion`] is a list of keys, each a frame and a [`Similarity`]. In a frame that has a key,
//! the place is the key's place, bit for bit. Before the first key it is the first place, and after
//! the last key the last. Between the keys a and b everything is computed in f64, for a frame f:
//!
//! ```text
//!   s            (f - f_a) / (f_b - f_a), with the frames of the keys
//!   scale        a + s (b - a)
//!   translation  a + s (b - a), each component
//!   rotation     of the unit quaternions p of a and q of b, see below, with c = p . q, and -q in the
//!                place of q, -c in that of c, if c < 0: the shorter way
//!     c >= 1 - 2^-40   p + s (q - p), each component
//!     else             k = sqrt(1 - c c), h = atan2(k, c)
//!                      p (sin((1 - s) h) / k) + q (sin(s h) / k), each component
//!                then divided by its length, and made a matrix
//! ```
//!
//! p u + q v is a product and a product, then their sum. sin and atan2 are the functions of
//! [`crate::number::elementary`]. A length is the root of the sum of four squares. Sums of four run
//! `((w + x) + y) + z`. Set a key at least every half turn to say which way an object turns; a key
//! after a whole turn means that the object rests.
//!
//! The quaternion (w, x, y, z) of a rotation m (`m.r.c`: row, column) is found from its greatest
//! component. That is the first, in the order w, x, y, z, of the components with the greatest
//! square:
//!
//! ```text
//!   4 w w = ((1 + m00) + m11) + m22        4 x x = ((1 + m00) - m11) - m22
//!   4 y y = ((1 - m00) + m11) - m22        4 z z = ((1 - m00) - m11) + m22
//! ```
//!
//! With g = 2 sqrt of that, the greatest is g / 4 and the others are, divided by g,
//!
//! ```text
//!   w:  x m21 - m12   y m02 - m20   z m10 - m01        x:  w m21 - m12   y m10 + m01   z m02 + m20
//!   y:  w m02 - m20   x m10 + m01   z m21 + m12        z:  w m10 - m01   x m02 + m20   y m21 + m12
//! ```
//!
//! The matrix of a quaternion has the rows
//!
//! ```text
//!   1 - 2 (y y + z z)    2 (x y - w z)        2 (x z + w y)
//!   2 (x y + w z)        1 - 2 (x x + z z)    2 (y z - w x)
//!   2 (x z - w y)        2 (y z + w x)        1 - 2 (x x + y y)
//! ```

use super::super::transform::Similarity;
use crate::error::{Error, Result};
use crate::scene::slerp::slerp;

/// Where an object is over the frames of a sequence, see the [module](self).
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    keys: Vec<(u32, Similarity)>,
}

impl Motion {
    /// A motion that stays at one place.
    #[must_use]
    pub fn still(place: Similarity) -> Self {
        Self { keys: vec![(0, place)] }
    }

    /// Makes a motion from keys in ascending frames.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is no key, if frames do not ascend, or as [`Similarity::check`].
    pub fn new(keys: Vec<(u32, Similarity)>) -> Result<Self> {
        if keys.is_empty() {
            return Err(Error::Invalid("there are no keys; add one".into()));
        }
        for pair in keys.windows(2) {
            let [before, after] = [pair[0].0, pair[1].0];
            if before >= after {
                return Err(Error::Invalid(format!(
                    "the key of frame {after} follows the key of frame {before}; sort keys by frame"
                )));
            }
        }
        keys.iter().try_for_each(|(_, place)| place.check())?;
        Ok(Self { keys })
    }

    /// The keys, in ascending frames.
    #[must_use]
    pub fn keys(&self) -> &[(u32, Similarity)] {
        &self.keys
    }

    /// Whether the place is the same in every frame.
    #[must_use]
    pub fn is_still(&self) -> bool {
        self.keys.iter().all(|(_, place)| *place == self.keys[0].1)
    }

    /// The place in a frame.
    #[must_use]
    pub fn at(&self, frame: u32) -> Similarity {
        let after = self.keys.partition_point(|(of, _)| *of < frame);
        let (Some(&(last, b)), Some(before)) = (self.keys.get(after), after.checked_sub(1)) else {
            let nearest = if after == 0 { 0 } else { self.keys.len() - 1 };
            return self.keys[nearest].1;
        };
        let (first, a) = self.keys[before];
        // No arithmetic, so that the place keeps its bits.
        if last == frame || a == b {
            return b;
        }
        between(&a, &b, f64::from(frame - first) / f64::from(last - first))
    }
}

/// The similarity at the fraction `s` of the way from `a` to `b`.
fn between(a: &Similarity, b: &Similarity, s: f64) -> Similarity {
    Similarity {
        rotation: slerp(&a.rotation, &b.rotation, s),
        scale: a.scale + s * (b.scale - a.scale),
        translation: a.translation + s * (b.translation - a.translation),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::transform::rotation;
    use glam::{DMat3, DVec3};

    fn place(rotation: DMat3, scale: f64, x: f64) -> Similarity {
        Similarity { rotation, scale, translation: DVec3::new(x, 0.0, -x) }
    }

    #[test]
    fn keys_are_met_and_held() {
        let [a, b] = [
            place(rotation(DVec3::ONE, 10.0), 1.0, 0.0),
            place(rotation(DVec3::Y, 70.0), 3.0, 8.0),
        ];
        let motion = Motion::new(vec![(10, a), (14, b)]).unwrap();
        assert_eq!([0, 10].map(|frame| motion.at(frame)), [a; 2]);
        assert_eq!([14, 99].map(|frame| motion.at(frame)), [b; 2]);
        let middle = motion.at(12);
        assert_eq!((middle.scale, middle.translation), (2.0, DVec3::new(4.0, 0.0, -4.0)));
        middle.check().unwrap();
        assert!(!motion.is_still() && Motion::still(a).is_still());
        assert_eq!(Motion::still(a).at(7), a);
    }

    #[test]
    fn keys_that_are_none_are_refused() {
        let one = Similarity::IDENTITY;
        let words = |keys| Motion::new(keys).unwrap_err().to_string();
        assert_eq!(words(vec![]), "there are no keys; add one");
        let what = "the key of frame 3 follows the key of frame 3; sort keys by frame";
        assert_eq!(words(vec![(1, one), (3, one), (3, one)]), what);
        let flat = place(DMat3::ZERO, 1.0, 0.0);
        assert!(words(vec![(0, one), (1, flat)]).contains("not a rotation"));
    }
}
