//! Use a latitude-longitude picture as an environment.
//!
//! ```text
//!    u  0      1/4     1/2     3/4     1
//!       ┌───────┬───────┬───────┬──────┐ v = 0    +y, up
//!       │  -z   +x      +z      -x  -z │ v = 1/2  the horizon
//!       └──────────────────────────────┘ v = 1    -y
//!
//!   u = atan2(x, -z) / 2 pi      v = atan2(sqrt(x^2 + z^2), y) / pi
//! ```
//!
//! Seen from within, u grows to the right: the map is not mirrored. This is the orientation of
//! Mitsuba and of OpenEXR's environment maps (latitude 0, longitude 0 is +z, longitude pi/2 is +x,
//! longitude falls from left to right). Departs: OpenEXR puts the centres of the first and the last
//! pixel on the borders u, v = 0 and 1. Here the centre of pixel (i, j) is at ((i + 1/2) / width,
//! (j + 1/2) / height), as in every texture unit and in the maps that you can download.

use crate::error::{Error, Result};
use crate::frame::Plane;
use crate::number::{Exact, MapInline, Real, Vector3};
use crate::scene::camera::MAX_EXTENT;
use crate::scene::light::MAX_RADIANCE;

/// A latitude-longitude map: twice as wide as high, linear RGB.
#[derive(Clone, Debug, PartialEq)]
pub struct Map(Plane<[f32; 3]>);

impl Map {
    /// Makes a map from these pixels.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the plane is empty, not twice as wide as high or wider than
    /// [`MAX_EXTENT`], or if a component is not in [0, [`MAX_RADIANCE`]]; the error names the
    /// pixel.
    pub fn new(mut pixels: Plane<[f32; 3]>) -> Result<Self> {
        let width = pixels.width();
        Self::check_size(width, pixels.height())?;
        let bad = |v: &f32| !(0.0..=MAX_RADIANCE).contains(v);
        if let Some(i) = pixels.values().iter().position(|pixel| pixel.iter().any(bad)) {
            let [r, g, b] = pixels.values()[i];
            let (x, y) = (i % width as usize, i / width as usize);
            return Err(Error::Invalid(format!(
                "environment: pixel ({x}, {y}) is [{r}, {g}, {b}]; clamp the map to \
                 [0, {MAX_RADIANCE}]"
            )));
        }
        // Adding 0 turns -0 into 0.
        pixels.values_mut().as_flattened_mut().iter_mut().for_each(|value| *value += 0.0);
        Ok(Self(pixels))
    }

    /// Checks that a map may have this size.
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`Map::new`].
    pub fn check_size(width: u32, height: u32) -> Result<()> {
        if height == 0 || !width.is_multiple_of(2) || width / 2 != height || width > MAX_EXTENT {
            return Err(Error::Invalid(format!(
                "environment: a map of {width} x {height} pixels; give one twice as wide as high, \
                 at most {MAX_EXTENT} wide"
            )));
        }
        Ok(())
    }

    /// The pixels, row by row from the top left.
    #[must_use]
    pub fn pixels(&self) -> &Plane<[f32; 3]> {
        &self.0
    }

    /// Linear RGB radiance from a unit direction, bilinear between the four nearest pixel centres.
    ///
    /// For a map of W x H pixels, every operation is rounded in this order:
    ///
    /// ```text
    ///   u = atan2(x, 0 - z) / (2 pi)           s = u W - 1/2     i = floor(s)    f = s - i
    ///   v = atan2(sqrt(x x + z z), y) / pi     t = v H - 1/2, at least 0
    ///                                          j = floor(t)     g = t - j
    ///   columns i and i + 1, W added to what is negative; rows j and min(j + 1, H - 1)
    ///   row      a + (b - a) f
    ///   result   upper + (lower - upper) g
    /// ```
    ///
    /// pi is atan2(0, -1), rounded like every angle. u wraps around. Half a pixel from the poles
    /// the first and the last row are repeated, as a texture unit clamps. So at a pole itself the
    /// light depends on the side from which you approach it. A vertical direction has u = 0,
    /// whatever the signs of its zeros. Where the columns have one colour, the result is exactly
    /// that colour.
    #[must_use]
    pub fn radiance<R: Exact>(&self, direction: Vector3<R>) -> [R; 3] {
        let width = R::from_f32(self.0.width() as f32);
        let [s, t] = self.place(direction, R::ZERO.atan2(-R::ONE), R::atan2);
        let (i, j) = (s.floor(), t.floor());
        // u is at most 1/2, so i and i + 1 are valid columns as they are, or once the width is
        // added.
        let column = |i: R| (if i < R::ZERO { i + width } else { i }).to_pixel();
        self.between([column(i), column(i + R::ONE)], j.to_pixel(), [s - i, t - j])
    }

    /// s and t. `pi` is the constant, and `angle`, called with y and x, gives the angle of the
    /// point (x, y) from the x axis.
    pub(crate) fn place<R: Real>(
        &self,
        direction: Vector3<R>,
        pi: R,
        angle: impl Fn(R, R) -> R,
    ) -> [R; 2] {
        let Vector3 { x, y, z } = direction;
        let half = R::from_f32(0.5);
        let [width, height] =
            [self.0.width(), self.0.height()].map_inline(|size| R::from_f32(size as f32));
        // 0 - z is +0 for either zero, so the angle does not depend on the sign of z.
        let u = angle(x, R::ZERO - z) / (pi + pi);
        let v = angle((x * x + z * z).root_of_squares(), y) / pi;
        [u * width - half, (v * height - half).at_least(R::ZERO)]
    }

    /// Interpolates between two columns in a row and the next row, f and g away from the first
    /// ones.
    pub(crate) fn between<R: Real>(&self, columns: [u32; 2], upper: u32, [f, g]: [R; 2]) -> [R; 3] {
        let lower = if upper < self.0.height() - 1 { upper + 1 } else { upper };
        let mix = |a: R, b: R, by: R| a + (b - a) * by;
        let row = |row: u32| {
            let [a, b] =
                columns.map_inline(|column| self.0.at(column, row).map_inline(R::from_f32));
            [mix(a[0], b[0], f), mix(a[1], b[1], f), mix(a[2], b[2], f)]
        };
        let (upper, lower) = (row(upper), row(lower));
        [0, 1, 2].map_inline(|c| mix(upper[c], lower[c], g))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::elementary::{cos, sin};
    use crate::number::random;

    /// The direction of a place on the map, by the picture in the module page: from -z to +x to +z.
    fn direction(u: f64, v: f64) -> Vector3<f64> {
        let (longitude, polar) = (u * 2.0 * std::f64::consts::PI, v * std::f64::consts::PI);
        Vector3::new(sin(polar) * sin(longitude), cos(polar), -(sin(polar) * cos(longitude)))
    }

    fn center(i: u32, j: u32, height: u32) -> Vector3<f64> {
        let height = f64::from(height);
        direction((f64::from(i) + 0.5) / (2.0 * height), (f64::from(j) + 0.5) / height)
    }

    fn single(d: Vector3<f64>) -> Vector3<f32> {
        Vector3::new(d.x as f32, d.y as f32, d.z as f32)
    }

    /// A map whose pixel is f of the direction of its centre.
    fn map_of(height: u32, f: impl Fn(Vector3<f64>) -> [f64; 3]) -> Map {
        let pixels = (0..height).flat_map(|j| (0..2 * height).map(move |i| (i, j)));
        let values = pixels.map(|(i, j)| f(center(i, j, height)).map(|v| v as f32)).collect();
        Map::new(Plane::from_values(2 * height, height, values)).unwrap()
    }

    /// The colour that encodes its direction.
    fn shown(d: Vector3<f64>) -> [f64; 3] {
        [d.x + 1.0, d.y + 1.0, d.z + 1.0]
    }

    #[test]
    fn the_axes_are_where_the_page_draws_them() {
        let at = |u: f64, v: f64| direction(u, v);
        for (d, [x, y, z]) in [
            (at(0.0, 0.5), [0.0, 0.0, -1.0]),
            (at(0.25, 0.5), [1.0, 0.0, 0.0]),
            (at(0.5, 0.5), [0.0, 0.0, 1.0]),
            (at(0.75, 0.5), [-1.0, 0.0, 0.0]),
            (at(0.5, 0.0), [0.0, 1.0, 0.0]),
        ] {
            assert!((d - Vector3::new(x, y, z)).length() < 1e-15, "the test's own map");
        }
        // One pixel with its own colour for each eighth of the horizon: its corners meet at the
        // axes.
        let columns: Vec<[f32; 3]> = (0..8).map(|i| [i as f32, 0.0, 0.0]).collect();
        let map = Map::new(Plane::from_values(8, 4, columns.repeat(4))).unwrap();
        let red = |x: f32, z: f32| map.radiance(Vector3::new(x, 0.0, z))[0];
        for (found, between) in [
            (red(0.0, -1.0), 3.5), // columns 7 and 0
            (red(1.0, 0.0), 1.5),
            (red(0.0, 1.0), 3.5),
            (red(-0.0, 1.0), 3.5),
            (red(-1.0, 0.0), 5.5),
        ] {
            assert!((found - between).abs() < 1e-6, "{found} {between}");
        }
    }

    #[test]
    fn a_pixel_center_gives_the_pixel() {
        let map = map_of(16, shown);
        for j in 0..16 {
            for i in 0..32 {
                let [expected, found] =
                    [map.pixels().at(i, j).map(f64::from), map.radiance(center(i, j, 16))];
                let single = map.radiance(single(center(i, j, 16)));
                for c in 0..3 {
                    assert!((found[c] - expected[c]).abs() < 1e-7, "({i}, {j})");
                    assert!((f64::from(single[c]) - expected[c]).abs() < 1e-5, "({i}, {j})");
                }
            }
        }
        let one = Map::new(Plane::filled(6, 3, [0.1_f32, 0.2, 65_536.0])).unwrap();
        for i in 0..1000 {
            let [x, y, z] = [0, 1, 2].map(|c| random::unit(1, 3 * i + c) - 0.5);
            let d = Vector3::new(x, y, z).normalized();
            assert_eq!(one.radiance(d), [0.1, 0.2, 65_536.0], "one colour is given exactly");
        }
    }

    /// The error of linear interpolation is at most h^2/8 times the second derivative, once for
    /// each axis; every second derivative of a direction by its angles is at most 1.
    #[test]
    fn a_known_function_comes_back_within_the_bound_of_interpolation() {
        for height in [8, 32, 128] {
            let map = map_of(height, shown);
            let h = std::f64::consts::PI / f64::from(height);
            for i in 0..20_000 {
                let [u, v] = [0, 1].map(|c| f64::from(random::unit(u64::from(height), 2 * i + c)));
                let d = direction(u, v);
                let (expected, found) = (shown(d), map.radiance(d));
                // Above the first centres, the first row stands for directions up to h/2 away.
                let clamped = v < 0.5 / f64::from(height) || v > 1.0 - 0.5 / f64::from(height);
                let bound = if clamped { h / 2.0 + h * h / 8.0 } else { h * h / 4.0 } + 1e-6;
                for c in 0..3 {
                    let error = (found[c] - expected[c]).abs();
                    assert!(error <= bound, "u {u} v {v}: {error} > {bound}");
                    let rounding = (f64::from(map.radiance(single(d))[c]) - found[c]).abs();
                    assert!(rounding < 1e-5, "u {u} v {v}: {rounding}");
                }
            }
        }
    }

    /// Across the seam, and across a pole where the rows beside it have one colour.
    #[test]
    fn nothing_jumps() {
        // Random pixels, except in the rows at the poles.
        let values = (0..512_u64).map(|i| match i {
            0..32 => [1.0, 2.0, 3.0],
            480.. => [3.0, 2.0, 1.0],
            _ => [0, 1, 2].map(|c| 8.0 * random::unit(5, 3 * i + c)),
        });
        let map = Map::new(Plane::from_values(32, 16, values.collect())).unwrap();
        let step = 1e-6;
        for i in 0..=200 {
            let t = f64::from(i) / 200.0;
            let pairs = [
                (direction(-step, t), direction(step, t)),
                (direction(0.5 - step, t), direction(0.5 + step, t)),
                (direction(t, step), direction(t + 0.5, step)),
                (direction(t, 1.0 - step), direction(t + 0.5, 1.0 - step)),
            ];
            for (a, b) in pairs {
                let (a, b) = (map.radiance(a), map.radiance(b));
                // 32 pixels around, 8 of difference each: a slope of 256 over twice the step.
                let near = |c: usize| (a[c] - b[c]).abs() <= 600.0 * step;
                assert!((0..3).all(near), "{t}: {a:?} {b:?}");
            }
        }
        for (y, [r, ..]) in [(1.0_f32, [1.0, 2.0, 3.0]), (-1.0, [3.0, 2.0, 1.0])] {
            for (x, z) in [(0.0, 0.0), (-0.0, 0.0), (0.0, -0.0), (-0.0, -0.0)] {
                assert_eq!(map.radiance(Vector3::new(x, y, z))[0], r);
            }
        }
    }

    #[test]
    fn the_sign_of_a_zero_is_not_seen() {
        let map = map_of(4, shown);
        for (y, z) in [(1.0_f32, 0.0), (-1.0, 0.0), (0.0, -1.0), (0.0, 1.0), (0.6, 0.8)] {
            let other = if z == 0.0 { -z } else { z };
            let signs = [(0.0, z), (-0.0, z), (0.0, other), (-0.0, other)];
            let lights = signs.map(|(x, z)| map.radiance(Vector3::new(x, y, z)));
            assert_eq!(lights, [lights[0]; 4], "(0, {y}, {z})");
        }
    }

    #[test]
    fn what_is_no_map_is_refused_in_one_line() {
        let refused = |width, height, pixel| {
            let line = Map::new(Plane::filled(width, height, pixel)).unwrap_err().to_string();
            assert!(!line.contains('\n'), "{line}");
            line
        };
        for (width, height) in [(2, 2), (3, 1), (1, 2), (5, 2), (0, 0), (2, 0)] {
            let line = refused(width, height, [0.0; 3]);
            assert!(line.contains(&format!("{width} x {height} pixels")), "{line}");
            assert!(line.contains("twice as wide"), "{line}");
        }
        for bad in [-1e-6, f32::NAN, f32::INFINITY, 65_540.0] {
            let line = refused(4, 2, [0.0, bad, 0.0]);
            assert!(line.contains("pixel (0, 0)") && line.contains("65536"), "{line}");
        }
        assert!(Map::new(Plane::filled(4, 2, [MAX_RADIANCE, 0.0, -0.0])).is_ok());
    }
}
