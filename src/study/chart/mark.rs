//! Marks of points: each series has a shape and a colour, so that either alone tells series apart.

use super::{COLORS, Drawing, Rgb, Stroke};
use crate::number::elementary::{cos, sin};
use std::f64::consts::TAU;

/// The radius of a mark in px.
pub const REACH: f64 = 5.0;

/// The corners on a circle, and the angle of the first in turns, from the right downwards. In a
/// star every other corner is nearer to the centre.
const SHAPES: [(usize, f64, f64); 11] = [
    (24, 0.0, 1.0),   // disc
    (4, 0.125, 1.0),  // square
    (3, 0.75, 1.0),   // triangle
    (4, 0.0, 1.0),    // diamond
    (3, 0.25, 1.0),   // triangle on its head
    (8, 0.0, 0.35),   // star of four points
    (10, 0.75, 0.4),  // star of five
    (6, 0.0, 1.0),    // hexagon
    (8, 0.125, 0.35), // cross, turned
    (3, 0.0, 1.0),    // triangle to the right
    (3, 0.5, 1.0),    // triangle to the left
];

/// The number of series: 66 pairs of a shape and a colour, all different.
pub const MOST_SERIES: usize = SHAPES.len() * COLORS.len();

/// The colour of a series.
#[must_use]
pub fn color(series: usize) -> Rgb {
    COLORS[series % COLORS.len()]
}

/// Draws the mark of a series, filled or as an outline.
pub fn draw(out: &mut Drawing, [x, y]: [f64; 2], series: usize, filled: bool) {
    let (corners, first, inner) = SHAPES[series % SHAPES.len()];
    let corner = |i: usize| {
        let angle = TAU * (first + i as f64 / corners as f64);
        let reach = REACH * if i % 2 == 1 { inner } else { 1.0 };
        [x + reach * cos(angle), y + reach * sin(angle)]
    };
    let color = color(series);
    let fill = if filled { color } else { [0xff; 3] };
    out.surface((0..corners).map(corner), fill, Some(Stroke::solid(color, 1.5)));
}
