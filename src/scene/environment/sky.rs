//! A sky in closed form: a gradient from the horizon to the zenith, a ground, a sun with its glow,
//! and a soft pattern that shows how directions are bent.
//!
//! Decided, all of it: no paper prescribes a sky. It is smooth, uses only + - * /, and all of its
//! constants are exact in `f32`.

use crate::number::{MapInline, Real, Vector3};

/// Linear RGB straight above.
pub const ZENITH: [f32; 3] = [0.125, 0.25, 0.625];
/// Linear RGB of the sky at the horizon.
pub const HORIZON: [f32; 3] = [0.75, 0.8125, 0.875];
/// Linear RGB of the ground.
pub const GROUND: [f32; 3] = [0.1875, 0.15625, 0.125];
/// Linear RGB that the sun adds at its centre.
pub const SUN: [f32; 3] = [24.0, 20.0, 16.0];
/// Linear RGB that the glow around the sun adds in its middle.
pub const GLOW: [f32; 3] = [0.75, 0.625, 0.375];
/// Seven times the unit direction towards the sun. The sun is to the left, above and behind a
/// camera that looks along -z.
pub const TOWARDS_SUN: [f32; 3] = [-2.0, 3.0, 6.0];

/// Linear RGB radiance from the unit direction (x, y, z).
///
/// | constant | value |
/// |---|---|
/// | `ZENITH` | (0.125, 0.25, 0.625) |
/// | `HORIZON` | (0.75, 0.8125, 0.875) |
/// | `GROUND` | (0.1875, 0.15625, 0.125) |
/// | `SUN` | (24, 20, 16) |
/// | `GLOW` | (0.75, 0.625, 0.375) |
///
/// S(a) = (a a)(3 - 2 a), with a brought into [0, 1]. T(a) is the Chebyshev polynomial of degree
/// 32, computed by doing a <- 2 (a a) - 1 five times:
///
/// ```text
///   h = 1 - y, at most 1     sky = ZENITH + (HORIZON - ZENITH) ((h h)(h h))
///   base = GROUND + (sky - GROUND) S(8 y + 1/2)
///   pattern = 1 + ((T(x) T(y)) T(z)) / 2
///   k = ((-2 x + 3 y) + 6 z) / 7, at least 0: the cosine of the angle to the sun
///   sun = S((k - (1 - 2^-10)) 2^11)       glow = k^32, k squared five times
///   radiance = base pattern + (SUN sun + GLOW glow)
/// ```
///
/// The pattern has three families of soft rings, 16 around each axis. It does not change with the
/// signs of the components or their order. The disc of the sun fades between 1.8 and 2.5 degrees
/// from its middle.
#[must_use]
pub fn radiance<R: Real>(direction: Vector3<R>) -> [R; 3] {
    let Vector3 { x, y, z } = direction;
    let c = R::from_f32;
    let h = (R::ONE - y).at_most(R::ONE);
    let h2 = h * h;
    let towards_horizon = h2 * h2;
    let above = smooth(c(8.0) * y + c(0.5));
    let pattern = R::ONE + ((chebyshev(x) * chebyshev(y)) * chebyshev(z)) / c(2.0);
    let k = (((c(TOWARDS_SUN[0]) * x + c(TOWARDS_SUN[1]) * y) + c(TOWARDS_SUN[2]) * z) / c(7.0))
        .at_least(R::ZERO);
    let sun = smooth((k - c(1.0 - 1.0 / 1024.0)) * c(2048.0));
    let glow = (0..5).fold(k, |power, _| power * power);
    [0, 1, 2].map_inline(|i| {
        let [zenith, horizon, ground] = [c(ZENITH[i]), c(HORIZON[i]), c(GROUND[i])];
        let sky = zenith + (horizon - zenith) * towards_horizon;
        let base = ground + (sky - ground) * above;
        base * pattern + (c(SUN[i]) * sun + c(GLOW[i]) * glow)
    })
}

/// Rises from 0 to 1 between 0 and 1, with level ends.
fn smooth<R: Real>(a: R) -> R {
    let a = a.at_least(R::ZERO).at_most(R::ONE);
    (a * a) * (R::from_f32(3.0) - R::from_f32(2.0) * a)
}

/// cos(32 angle) from cos(angle), by cos(2 angle) = 2 cos(angle)^2 - 1.
fn chebyshev<R: Real>(a: R) -> R {
    (0..5).fold(a, |a, _| R::from_f32(2.0) * (a * a) - R::ONE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::elementary::{cos, pow, sin};
    use crate::number::random;
    use std::f64::consts::PI;

    #[test]
    fn the_page_has_the_constants() {
        let page = include_str!("sky.rs");
        for (name, [r, g, b]) in [
            ("ZENITH", ZENITH),
            ("HORIZON", HORIZON),
            ("GROUND", GROUND),
            ("SUN", SUN),
            ("GLOW", GLOW),
        ] {
            assert!(page.contains(&format!("/// | `{name}` | ({r}, {g}, {b}) |")), "{name}");
        }
    }

    fn directions(seed: u64, count: u64) -> impl Iterator<Item = Vector3<f64>> {
        (0..count).map(move |i| {
            let [a, b] = [0, 1].map(|c| f64::from(random::unit(seed, 2 * i + c)));
            let y = 2.0 * a - 1.0;
            let r = (1.0 - y * y).sqrt();
            Vector3::new(r * sin(2.0 * PI * b), y, r * cos(2.0 * PI * b))
        })
    }

    fn single(d: Vector3<f64>) -> Vector3<f32> {
        Vector3::new(d.x as f32, d.y as f32, d.z as f32)
    }

    /// The same sky by angles and powers instead of polynomials.
    fn by_angles(d: Vector3<f64>) -> [f64; 3] {
        let ring = |a: f64| {
            let other = (1.0 - a * a).sqrt();
            cos(32.0 * crate::number::elementary::atan2(other, a))
        };
        let pattern = 1.0 + 0.5 * ring(d.x) * ring(d.y) * ring(d.z);
        let k = (6.0 * d.z + 3.0 * d.y - 2.0 * d.x) / 7.0;
        let ramp = |a: f64| {
            if a <= 0.0 {
                0.0
            } else if a >= 1.0 {
                1.0
            } else {
                a * a * (3.0 - 2.0 * a)
            }
        };
        let [above, sun] = [ramp((d.y + 0.0625) / 0.125), ramp(2048.0 * (k - 1.0) + 2.0)];
        let height = if d.y > 0.0 { d.y } else { 0.0 };
        [0, 1, 2].map(|i| {
            let [zenith, horizon, ground, sun_color, glow] =
                [ZENITH[i], HORIZON[i], GROUND[i], SUN[i], GLOW[i]].map(f64::from);
            let fade = pow(1.0 - height, 4.0);
            let sky = zenith * (1.0 - fade) + horizon * fade;
            let base = (sky * above + ground * (1.0 - above)) * pattern;
            base + sun_color * sun + if k > 0.0 { glow * pow(k, 32.0) } else { 0.0 }
        })
    }

    #[test]
    fn the_polynomials_are_the_angles_that_they_stand_for() {
        let sun = Vector3::new(-2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0);
        let beside = directions(2, 2000).map(|d| (sun + d * 0.05).normalized());
        for d in directions(1, 20_000).chain(beside) {
            let (expected, found) = (by_angles(d), radiance(d));
            let single = radiance(single(d));
            for c in 0..3 {
                assert!((found[c] - expected[c]).abs() < 1e-10, "{d:?}");
                // Half an ulp of k, 2^-25, times the slope of the sun's edge, 1.5 * 2^11 * 24; plus
                // the roundings on the way to k.
                assert!((f64::from(single[c]) - expected[c]).abs() < 0.02, "{d:?}");
                assert!(found[c] >= 0.06 && found[c] <= 26.0, "{d:?} {found:?}");
            }
        }
    }

    #[test]
    fn away_from_the_sun_left_is_right_and_front_is_side() {
        let mut compared = 0;
        for d in directions(3, 4000).map(single) {
            let sun_side = |d: Vector3<f32>| -2.0 * d.x + 3.0 * d.y + 6.0 * d.z > 0.0;
            let others = [Vector3::new(-d.x, d.y, d.z), Vector3::new(d.z, d.y, d.x)];
            // In exact arithmetic the pattern does not depend on the order; here the product is
            // rounded in order.
            let close = |a: [f32; 3], b: [f32; 3]| (0..3).all(|c| (a[c] - b[c]).abs() <= 2e-7);
            for other in others.into_iter().filter(|&o| !sun_side(o) && !sun_side(d)) {
                assert!(close(radiance(d), radiance(other)), "{d:?}");
                compared += 1;
            }
        }
        assert!(compared > 1000, "{compared}");
    }

    #[test]
    fn the_sun_is_where_it_is_said_to_be_and_the_ground_is_below() {
        let sun = radiance(Vector3::new(-2.0_f64 / 7.0, 3.0 / 7.0, 6.0 / 7.0));
        assert!(sun[0] > 24.0 && directions(4, 5000).all(|d| radiance(d)[0] <= sun[0]));
        let blue_above_brown = |d: Vector3<f64>| {
            let [r, _, b] = radiance(d);
            if d.y > 0.5 && d.z < 0.0 {
                b > r
            } else if d.y < -0.1 && d.z < -0.5 {
                r > b
            } else {
                true
            }
        };
        assert!(directions(5, 5000).all(blue_above_brown));
    }

    /// The steepest part is the edge of the sun: 24 * 1.5 * 2^11 per unit of k, and there k changes
    /// by at most sin(2.6 degrees) per angle.
    #[test]
    fn it_is_smooth() {
        let step = 1e-7;
        for (d, by) in directions(6, 20_000).zip(directions(7, 20_000)) {
            let other = (d + by * step).normalized();
            let (a, b) = (radiance(d), radiance(other));
            assert!((0..3).all(|c| (a[c] - b[c]).abs() <= 4000.0 * step), "{d:?}");
        }
    }
}
