//! How a client stores a plane, and how much of a value that loses.

use crate::number::ball::{Ball, Profile};
use crate::number::srgb;
use crate::number::{MapInline, Real};
use crate::verdict::checks::widened;

/// The storage format of a plane: it says how far a stored value may lie from the computed one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Storage {
    /// `f32`: the value as computed.
    #[default]
    Single,
    /// `f32`, rounded once to nearest from a number with more digits: 2^-24 of the value. The next
    /// stage continued from the number before it was rounded. See [`Client::rounded`].
    ///
    /// [`Client::rounded`]: super::client::Client::rounded
    Rounded,
    /// `f16`, rounded to either neighbour: 2^-10 of the value, at least 2^-24.
    Half,
    /// A float of fewer digits. A value may be off by `relative` of itself, or by `least` if that
    /// is more.
    Float {
        /// The fraction of the value that storing may lose.
        relative: f64,
        /// The loss that is always allowed.
        least: f64,
    },
    /// Equal steps of this size, in the unit of the plane, rounded to either neighbour. UNORM of n
    /// bits has steps of 1 / (2^n - 1).
    Steps(f64),
    /// A depth buffer with equal steps of z in \[0, 1\], for a perspective camera:
    /// `z = far (t - near) / (t (far - near))`, or 1 - z. The plane holds t.
    DepthBuffer {
        /// The step of z.
        step: f64,
        /// The depth of z = 0.
        near: f64,
        /// The depth of z = 1; may be +inf.
        far: f64,
    },
    /// `v = scale / t` stored in place of the depth t. Each v may be off by `relative` of itself,
    /// or by `least` if that is more.
    Inverse {
        /// The depth where v = 1; for `1/t` it is 1.
        scale: f64,
        /// The fraction of v that storing may lose.
        relative: f64,
        /// The loss of v that is always allowed.
        least: f64,
    },
    /// `v = (t - near) / (far - near)` stored in place of the depth t. Each v may be off by
    /// `relative` of itself, or by `least` if that is more.
    Linear {
        /// The depth of v = 0.
        near: f64,
        /// The depth of v = 1.
        far: f64,
        /// The fraction of v that storing may lose.
        relative: f64,
        /// The loss of v that is always allowed.
        least: f64,
    },
    /// A colour encoded as sRGB, see [`crate::number::srgb`]. Each code may be off by `relative` of
    /// itself, or by `least` if that is more. The plane holds linear light.
    Srgb {
        /// The fraction of a code that storing may lose.
        relative: f64,
        /// The loss of a code that is always allowed.
        least: f64,
    },
}

/// What rounding to `f32` may lose of a stored value. A little more than 2^-24, because the fraction
/// is of the value before it was rounded.
const ROUNDED: f64 = 1.000_001 / 16_777_216.0;
/// Half the least `f32` above 0: 2^-150.
const HALF_A_DENORMAL: f64 = 0.5 * 1.401_298_464_324_817e-45;

/// How far off a stored v may be: `|v|` times `relative`, at least `least`.
fn v_radius(v: f64, relative: f64, least: f64) -> f64 {
    (v.abs() * relative).at_least(least)
}

/// How far off `scale / v` may be if v is off by `radius`, at the end where that is most.
fn inverse_radius(value: f64, scale: f64, radius: f64) -> f64 {
    let part = radius * value.abs() / scale;
    // If v may be 0, the quotient has no bound.
    if part < 1.0 { value.abs() * part / (1.0 - part) } else { f64::INFINITY }
}

impl Storage {
    /// How far the computed value may lie from this stored one, in the unit of the plane.
    #[must_use]
    pub fn radius(self, value: f64) -> f64 {
        match self {
            Self::Single => 0.0,
            _ if !value.is_finite() => 0.0,
            // 0 stays exact, because it says that a pixel is empty.
            Self::Rounded if value == 0.0 => 0.0,
            Self::Rounded => v_radius(value, ROUNDED, HALF_A_DENORMAL),
            Self::Half => v_radius(value, 1.0 / 1024.0, 1.0 / 16_777_216.0),
            Self::Float { relative, least } => v_radius(value, relative, least),
            Self::Steps(step) => step,
            // z is v = scale / t, except for a constant and the sign.
            Self::DepthBuffer { step, near, far } => {
                inverse_radius(value, 1.0 / (1.0 / near - 1.0 / far), step)
            }
            Self::Inverse { scale, relative, least } => {
                inverse_radius(value, scale, v_radius(scale / value, relative, least))
            }
            Self::Linear { near, far, relative, least } => {
                let range = far - near;
                range.abs() * v_radius((value - near) / range, relative, least)
            }
            // Decoding is convex, so the way up is the longer one.
            Self::Srgb { relative, least } => {
                let code = srgb::from_linear(value);
                srgb::to_linear(code + v_radius(code, relative, least)) - value
            }
        }
    }

    /// A depth as a test in this format compares it with others: all depths whose stored number may
    /// be the same. Both the depth and the other were stored, so both may be off.
    pub(crate) fn tested<P: Profile>(self, depth: Ball<P>) -> Ball<P> {
        if self == Self::Single {
            return depth;
        }
        let ends = [depth.middle - depth.radius, depth.middle + depth.radius];
        let [a, b] = ends.map_inline(|end| {
            let once = self.radius(end);
            once + self.radius(end - once).at_least(self.radius(end + once))
        });
        widened(depth, a.at_least(b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_test_takes_depths_two_steps_apart_for_equal() {
        use crate::number::ball::Ieee;
        let tested = |storage: Storage, depth| storage.tested(Ball::<Ieee>::exact(depth)).radius;
        assert_eq!(tested(Storage::Single, 3.0), 0.0);
        assert_eq!(tested(Storage::Steps(0.25), 3.0), 0.5);
        assert_eq!(tested(Storage::Steps(0.25), f64::INFINITY), 0.0, "an empty pixel");
        let buffer = Storage::DepthBuffer { step: 1e-3, near: 1.0, far: 100.0 };
        let z = |t: f64| 100.0 * (t - 1.0) / (t * 99.0);
        let other = 5.0 + tested(buffer, 5.0);
        assert!((2e-3..2.1e-3).contains(&(z(other) - z(5.0))), "{}", z(other) - z(5.0));
    }

    #[test]
    fn what_a_format_may_lose() {
        assert_eq!(Storage::Single.radius(0.7), 0.0);
        assert_eq!(Storage::Rounded.radius(0.0), 0.0, "an empty pixel");
        for value in [1.0 / 3.0, -0.1, 1e30 / 7.0, 1e-42 / 3.0, 1.000_000_059_604_644_6] {
            let stored = f64::from(value as f32);
            let radius = Storage::Rounded.radius(stored);
            let lost = (value - stored).abs();
            assert!(lost <= radius && radius < 1e-7 * value.abs() + 1e-45, "{value:e}");
        }
        // Neighbours of f16 in [1, 2) are 2^-10 apart, denormals 2^-24.
        assert_eq!(Storage::Half.radius(1.0), 1.0 / 1024.0);
        assert_eq!(Storage::Half.radius(1e-9), 1.0 / 16_777_216.0);
        assert_eq!(Storage::Steps(1.0 / 255.0).radius(0.3), 1.0 / 255.0);
        assert_eq!(Storage::Half.radius(f64::INFINITY), 0.0, "an empty pixel");
    }

    #[test]
    fn what_is_stored_in_place_of_a_value() {
        // v = 2 / t: t = 4 is v = 0.5, and 0.5 minus an eighth of it is v = 0.4375, t = 4.571...
        let inverse = Storage::Inverse { scale: 2.0, relative: 0.125, least: 0.0 };
        assert!((inverse.radius(4.0) - (2.0 / 0.4375 - 4.0)).abs() < 1e-15);
        let inverse = Storage::Inverse { scale: 2.0, relative: 0.0, least: 0.6 };
        assert_eq!(inverse.radius(4.0), f64::INFINITY, "v may be 0");
        // v = (3 - 1) / 4 = 0.5, and a quarter of it is 0.5 units; at least 0.25, 1 unit.
        let linear = |least| Storage::Linear { near: 1.0, far: 5.0, relative: 0.25, least };
        assert_eq!((linear(0.0).radius(3.0), linear(0.25).radius(3.0)), (0.5, 1.0));
        // The codes 188 and 189 of 8 bits are 0.50289 and 0.50888 in the tables of sRGB.
        let srgb = Storage::Srgb { relative: 0.0, least: 1.0 / 255.0 };
        assert!((srgb.radius(0.502_886_5) - 0.005_994).abs() < 1e-5);
        // The straight part: a step is 1 / 12.92 of a step.
        assert!((srgb.radius(0.001) - 1.0 / 255.0 / 12.92).abs() < 1e-12);
    }

    #[test]
    fn a_step_of_a_depth_buffer_holds_the_depths_beside_it() {
        let (near, far, step) = (0.5, 20.0, 1.0 / 65_535.0);
        let z = |t: f64| far * (t - near) / (t * (far - near));
        let t = |z: f64| far * near / (far - z * (far - near));
        for depth in [0.5, 1.0, 3.0, 19.0] {
            let radius = Storage::DepthBuffer { step, near, far }.radius(depth);
            let beside = t(z(depth) + step) - depth;
            assert!(beside <= radius * (1.0 + 1e-9) && radius < 1.01 * beside, "{depth}");
            assert!(depth - t(z(depth) - step) <= radius);
        }
    }
}
