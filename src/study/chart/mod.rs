//! Charts: paths and texts, written as SVG and as PNG.
//!
//! A [`Drawing`] is a list of shapes in px with y downwards, on white; each shape covers those
//! before it. Both files are made from this list, so they show the same picture; the PNG has
//! [`SCALE`] pixels a px. Coordinates are rounded to 1/16 px, `floor(16 v + 1/2) / 16`, when a
//! shape is added. Every shape is opaque.
//!
//! The font is DejaVu Sans, which is part of the crate, without kerning. An SVG stores a text as
//! text with its width, so that another font takes the same room. A character that the font lacks
//! is an empty box in a PNG.
//!
//! - [`axis`]: linear axes, with round numbers for ticks.
//! - [`curve`]: errors over a sweep.
//! - [`label`]: labels that do not collide.
//! - [`log`]: logarithmic axes.
//! - [`mark`]: shapes and colours of points.
//! - [`scatter`]: points on two logarithmic axes, with their front.
//! - [`text`]: widths of texts.
//! - [`violin`]: distributions of values.
//! - [`walk`]: times of the frames of a sequence.

pub mod axis;
pub mod curve;
pub mod label;
pub mod log;
pub mod mark;
mod raster;
pub mod scatter;
mod svg;
pub mod text;
pub mod violin;
pub mod walk;

pub use raster::{Picture, SCALE};
pub use svg::escaped;

/// Red, green and blue in sRGB.
pub type Rgb = [u8; 3];

/// The colour of text and axes.
pub const INK: Rgb = [0x24, 0x29, 0x2f];
/// The colour of grid lines.
pub const GRID: Rgb = [0xd8, 0xde, 0xe4];
/// Colours that differ in lightness as well as in hue \[Okabe, Ito 2008\], so that the colour-blind
/// can tell them apart. A chart adds a dash or a name to each.
pub const COLORS: [Rgb; 6] = [
    [0x00, 0x72, 0xb2],
    [0xd5, 0x5e, 0x00],
    [0x00, 0x9e, 0x73],
    [0xcc, 0x79, 0xa7],
    [0xe6, 0x9f, 0x00],
    [0x56, 0xb4, 0xe9],
];
/// A dash for each of [`COLORS`]: lengths in px, alternately drawn and left out.
pub const DASHES: [&[f32]; 6] =
    [&[], &[8.0, 3.0], &[2.0, 3.0], &[10.0, 3.0, 2.0, 3.0], &[5.0, 5.0], &[14.0, 4.0]];

/// The colour at this position, from 0 to 1, between white and a colour.
#[must_use]
pub fn tint(color: Rgb, share: f64) -> Rgb {
    color.map(|c| (255.0 - (255.0 - f64::from(c)) * share + 0.5) as u8)
}

/// A picture of shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Width and height in px, whole.
    size: [u32; 2],
    title: String,
    about: String,
    shapes: Vec<Shape>,
}

/// The style of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// The colour.
    pub color: Rgb,
    /// The width in px.
    pub width: f32,
    /// The dash, as in [`DASHES`].
    pub dash: &'static [f32],
}

/// The part of a text that lies at the given point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its left end.
    Start,
    /// Its middle.
    Middle,
    /// Its right end.
    End,
}

/// A text on its baseline.
#[derive(Clone, Debug, PartialEq)]
pub struct Label<'a> {
    /// The text, one line.
    pub text: &'a str,
    /// The font size in px.
    pub size: f64,
    /// Where on the baseline the point is.
    pub anchor: Anchor,
    /// Whether the text reads upwards.
    pub turned: bool,
}

/// A shape.
#[derive(Clone, Debug, PartialEq)]
enum Shape {
    Path { points: Vec<[f64; 2]>, closed: bool, fill: Option<Rgb>, stroke: Option<Stroke> },
    Text { text: String, at: [f64; 2], size: f64, anchor: Anchor, turned: bool },
    Spot { at: [f64; 2], reach: f64, index: usize, title: String },
}

impl Stroke {
    /// A solid line.
    #[must_use]
    pub fn solid(color: Rgb, width: f32) -> Self {
        Self { color, width, dash: &[] }
    }
}

impl<'a> Label<'a> {
    /// A horizontal text of 13 px.
    #[must_use]
    pub fn new(text: &'a str, anchor: Anchor) -> Self {
        Self { text, size: 13.0, anchor, turned: false }
    }
}

impl Drawing {
    /// An empty drawing. Screen readers read the title and the description.
    #[must_use]
    pub fn new(size: [u32; 2], title: &str, about: &str) -> Self {
        Self { size, title: title.to_owned(), about: about.to_owned(), shapes: Vec::new() }
    }

    /// A line through points.
    pub fn line(&mut self, points: impl IntoIterator<Item = [f64; 2]>, stroke: Stroke) {
        self.path(points, false, None, Some(stroke));
    }

    /// A filled polygon with its edge.
    pub fn surface(
        &mut self,
        points: impl IntoIterator<Item = [f64; 2]>,
        fill: Rgb,
        edge: Option<Stroke>,
    ) {
        self.path(points, true, Some(fill), edge);
    }

    /// A text.
    pub fn text(&mut self, at: [f64; 2], label: &Label<'_>) {
        let Label { text, size, anchor, turned } = *label;
        let text = text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
        self.shapes.push(Shape::Text { text, at: at.map(rounded), size, anchor, turned });
    }

    /// An invisible disc. In an SVG it shows a title to the pointer, and gives the index of the
    /// thing that it belongs to, for pages that answer a click.
    pub fn spot(&mut self, at: [f64; 2], reach: f64, index: usize, title: &str) {
        self.shapes.push(Shape::Spot {
            at: at.map(rounded),
            reach,
            index,
            title: title.to_owned(),
        });
    }

    fn path(
        &mut self,
        points: impl IntoIterator<Item = [f64; 2]>,
        closed: bool,
        fill: Option<Rgb>,
        stroke: Option<Stroke>,
    ) {
        let mut points: Vec<_> = points.into_iter().map(|p| p.map(rounded)).collect();
        points.dedup();
        self.shapes.push(Shape::Path { points, closed, fill, stroke });
    }
}

fn rounded(value: f64) -> f64 {
    (16.0 * value + 0.5).floor() / 16.0 + 0.0
}

#[cfg(test)]
mod tests;
