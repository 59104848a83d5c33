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
use crate::number::elementary;
use glam::{DMat3, DVec3};

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
            return Err(Error::Invalid("there are no keys".into()));
        }
        for pair in keys.windows(2) {
            let [before, after] = [pair[0].0, pair[1].0];
            if before >= after {
                return Err(Error::Invalid(format!(
                    "a key of frame {after} after one of frame {before}: frames must ascend"
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

/// Spherical linear interpolation of two rotations.
pub(crate) fn slerp(a: &DMat3, b: &DMat3, s: f64) -> DMat3 {
    let (p, mut q) = (quaternion(a), quaternion(b));
    let mut c = dot(p, q);
    // q and -q are the same rotation; the closer one gives the shorter way.
    if c < 0.0 {
        (q, c) = (q.map(|part| -part), -c);
    }
    // Between nearly equal rotations the division by k would lose the digits.
    let turned: [f64; 4] = if c >= 1.0 - 1.0 / 1_099_511_627_776.0 {
        std::array::from_fn(|i| p[i] + s * (q[i] - p[i]))
    } else {
        let k = (1.0 - c * c).sqrt();
        let h = elementary::atan2(k, c);
        let [of_p, of_q] = [elementary::sin((1.0 - s) * h) / k, elementary::sin(s * h) / k];
        std::array::from_fn(|i| p[i] * of_p + q[i] * of_q)
    };
    let length = dot(turned, turned).sqrt();
    matrix(turned.map(|part| part / length))
}

fn dot(p: [f64; 4], q: [f64; 4]) -> f64 {
    ((p[0] * q[0] + p[1] * q[1]) + p[2] * q[2]) + p[3] * q[3]
}

/// The unit quaternion of a rotation.
fn quaternion(m: &DMat3) -> [f64; 4] {
    let [[m00, m10, m20], [m01, m11, m21], [m02, m12, m22]] = m.to_cols_array_2d();
    let squares = [
        ((1.0 + m00) + m11) + m22,
        ((1.0 + m00) - m11) - m22,
        ((1.0 - m00) + m11) - m22,
        ((1.0 - m00) - m11) + m22,
    ];
    let greatest = (1..4).fold(0, |most, i| if squares[i] > squares[most] { i } else { most });
    let g = 2.0 * squares[greatest].sqrt();
    let (own, [x, y, z]) = (g / 4.0, [m21 - m12, m02 - m20, m10 - m01].map(|part| part / g));
    let [xy, xz, yz] = [m10 + m01, m02 + m20, m21 + m12].map(|part| part / g);
    match greatest {
        0 => [own, x, y, z],
        1 => [x, own, xy, xz],
        2 => [y, xy, own, yz],
        _ => [z, xz, yz, own],
    }
}

/// The rotation of a unit quaternion.
fn matrix([w, x, y, z]: [f64; 4]) -> DMat3 {
    DMat3::from_cols(
        DVec3::new(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)),
        DVec3::new(2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)),
        DVec3::new(2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::transform::rotation;
    use proptest::prelude::*;

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
        assert_eq!(words(vec![]), "there are no keys");
        let what = "a key of frame 3 after one of frame 3: frames must ascend";
        assert_eq!(words(vec![(1, one), (3, one), (3, one)]), what);
        let flat = place(DMat3::ZERO, 1.0, 0.0);
        assert!(words(vec![(0, one), (1, flat)]).contains("no rotation"));
    }

    proptest! {
        #[test]
        fn turns_are_even(
            axis in prop::array::uniform3(-1.0..1.0_f64), start in -180.0..180.0_f64,
            turn in -179.0..179.0_f64, s in 0.0..1.0_f64,
        ) {
            let axis = DVec3::from_array(axis);
            prop_assume!(axis.length() > 0.1);
            // About one axis, a part of the way is a part of the angle.
            let [a, b] = [start, start + turn].map(|degrees| rotation(axis, degrees));
            let truth = rotation(axis, start + s * turn);
            let off = (slerp(&a, &b, s) - truth).to_cols_array();
            prop_assert!(off.iter().all(|part| part.abs() < 1e-14), "{off:?}");
        }

        #[test]
        fn quaternions_go_there_and_back(
            axis in prop::array::uniform3(-1.0..1.0_f64), degrees in -360.0..360.0_f64,
        ) {
            let axis = DVec3::from_array(axis);
            prop_assume!(axis.length() > 0.1);
            let m = rotation(axis, degrees);
            let off = (matrix(quaternion(&m)) - m).to_cols_array();
            prop_assert!(off.iter().all(|part| part.abs() < 2e-15), "{off:?}");
        }
    }
}
