//! Surround a scene with light from infinitely far away, a function of direction alone.
//!
//! - [`map`]: a latitude-longitude picture.
//! - [`mod@sky`]: a procedural sky, if you have no picture.

mod balls;
pub mod map;
pub mod sky;

pub use map::Map;

use crate::number::{Exact, Real, Vector3};

/// Light from all directions.
#[derive(Clone, Debug, PartialEq)]
pub enum Environment {
    /// The sky of [`sky::radiance`].
    Sky,
    /// A picture.
    Map(Map),
}

impl Environment {
    /// Linear RGB radiance that arrives from a world-space direction of any length > 0: finite
    /// numbers >= 0.
    ///
    /// The unit direction is computed in this order. First each component is divided by the largest
    /// magnitude of the three, so that no square leaves the range; then [`Vector3::normalized`].
    /// Decided: the null vector and a direction that is not finite look straight up.
    #[must_use]
    pub fn radiance<R: Exact>(&self, direction: Vector3<R>) -> [R; 3] {
        let direction = unit(direction);
        match self {
            Self::Sky => sky::radiance(direction),
            Self::Map(map) => map.radiance(direction),
        }
    }
}

/// A direction of length 1; the null vector and directions that are not finite give no unit vector.
pub(crate) fn scaled<R: Real>(d: Vector3<R>) -> Vector3<R> {
    let largest = d.x.abs().at_least(d.y.abs()).at_least(d.z.abs());
    Vector3::new(d.x / largest, d.y / largest, d.z / largest).normalized()
}

/// The unit direction, see [`Environment::radiance`].
fn unit<R: Exact>(d: Vector3<R>) -> Vector3<R> {
    let scaled = scaled(d);
    // 0/0 and inf/inf are NaN, and a vector with NaN has no length.
    if scaled == Vector3::ZERO { Vector3::new(R::ZERO, R::ONE, R::ZERO) } else { scaled }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Plane;

    fn both() -> [Environment; 2] {
        let values = vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]];
        [Environment::Sky, Environment::Map(Map::new(Plane::from_values(2, 1, values)).unwrap())]
    }

    #[test]
    fn the_length_of_a_direction_does_not_matter() {
        for environment in both() {
            let expected = environment.radiance(Vector3::new(0.5_f32, -0.25, 0.125));
            // 2^120 and 2^-140: the square of the first overflows f32, the second is subnormal.
            for scale in [4.0, f32::from_bits(0x7B80_0000), f32::from_bits(1 << 9)] {
                let direction = Vector3::new(0.5 * scale, -0.25 * scale, 0.125 * scale);
                assert_eq!(environment.radiance(direction), expected, "{scale}");
            }
        }
    }

    #[test]
    fn no_direction_gives_anything_but_finite_light() {
        let odd = [0.0, -0.0, 1.0, -1.0, 1e-45, f32::MAX, f32::INFINITY, f32::NAN, -1e-20];
        for environment in both() {
            let up = environment.radiance(Vector3::new(0.0_f32, 1.0, 0.0));
            for x in odd {
                for y in odd {
                    for z in odd {
                        let d = Vector3::new(x, y, z);
                        let light = environment.radiance(d);
                        assert!(
                            light.iter().all(|v| v.is_finite() && *v >= 0.0),
                            "{d:?} {light:?}"
                        );
                        let nothing = x == 0.0 && y == 0.0 && z == 0.0;
                        if nothing || !(x.is_finite() && y.is_finite() && z.is_finite()) {
                            assert_eq!(light, up, "{d:?}");
                        }
                    }
                }
            }
        }
    }
}
