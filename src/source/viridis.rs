//! Colour points by a number of each, with the colour map viridis of `matplotlib`.
//!
//! ```text
//!   t      = (value - low) / (high - low)         0 if high = low
//!   k      = floor(9 t), at most 8
//!   code   = a + (b - a) (9 t - k)                a and b are stops k and k + 1, for each channel
//!   colour = to_linear(code / 255)                rounded to f32 once; all else in f64
//! ```
//!
//! `low` and `high` are the least and the greatest finite value. Ten stops of the map's table are
//! used, and codes between them are interpolated in sRGB.

use crate::number::srgb;
use crate::scene::light::Phong;
use glam::Vec3;

/// Every ninth part of the map, in codes of sRGB.
const STOPS: [[u8; 3]; 10] = [
    [0x44, 0x01, 0x54],
    [0x48, 0x28, 0x78],
    [0x3e, 0x4a, 0x89],
    [0x31, 0x68, 0x8e],
    [0x26, 0x82, 0x8e],
    [0x1f, 0x9e, 0x89],
    [0x35, 0xb7, 0x79],
    [0x6d, 0xcd, 0x59],
    [0xb4, 0xde, 0x2c],
    [0xfd, 0xe7, 0x25],
];

/// Colours of values, and the range that they show.
#[derive(Clone, Debug, PartialEq)]
pub struct Colored {
    /// Linear RGB of each value; [the colour of no colour](Phong::color) for a value that is not
    /// finite.
    pub color: Vec<Vec3>,
    /// The least finite value.
    pub low: f32,
    /// The greatest finite value.
    pub high: f32,
    /// How many values are not finite.
    pub without: u64,
}

/// Colours values; `None` if none is finite.
#[must_use]
pub fn colored(values: &[f32]) -> Option<Colored> {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let first = finite().next()?;
    let low = finite().fold(first, |low, value| if value < low { value } else { low });
    let high = finite().fold(first, |high, value| if value > high { value } else { high });
    let none = Phong::default().color;
    let of = |&value: &f32| if value.is_finite() { color(value, low, high) } else { none };
    let without = (values.len() - finite().count()) as u64;
    Some(Colored { color: values.iter().map(of).collect(), low, high, without })
}

fn color(value: f32, low: f32, high: f32) -> Vec3 {
    let [value, low, high] = [value, low, high].map(f64::from);
    let t = if high > low { (value - low) / (high - low) } else { 0.0 };
    let place = 9.0 * t;
    let k = if place < 8.0 { place as usize } else { 8 };
    let channel = |c: usize| {
        let [a, b] = [STOPS[k][c], STOPS[k + 1][c]].map(f64::from);
        srgb::to_linear((a + (b - a) * (place - k as f64)) / 255.0) as f32
    };
    Vec3::new(channel(0), channel(1), channel(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(color: Vec3) -> [f64; 3] {
        color.to_array().map(|value| srgb::from_linear(value.into()) * 255.0)
    }

    #[test]
    fn values_get_the_codes_of_the_map() {
        let Colored { color, low, high, without } =
            colored(&[-4.0, 5.0, f32::NAN, 0.5, f32::INFINITY]).unwrap();
        assert_eq!((low, high, without), (-4.0, 5.0, 2));
        let near = |color: Vec3, expected: [f64; 3]| {
            let found = code(color);
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-3), "{found:?}");
        };
        near(color[0], [68.0, 1.0, 84.0]);
        near(color[1], [253.0, 231.0, 37.0]);
        // The middle lies between the stops 4 and 5; matplotlib has 33, 145, 140 there.
        near(color[3], [34.5, 144.0, 139.5]);
        assert_eq!([color[2], color[4]], [Phong::default().color; 2]);
    }

    #[test]
    fn one_value_alone_is_the_lowest_and_none_is_nothing() {
        let same = colored(&[2.0, 2.0]).unwrap();
        assert_eq!((same.low, same.high, same.color[0]), (2.0, 2.0, same.color[1]));
        assert_eq!(colored(&[f32::NAN]), None);
        let wide = colored(&[f32::MIN, f32::MAX]).unwrap();
        assert!(wide.color.iter().all(|color| color.is_finite()));
    }
}
