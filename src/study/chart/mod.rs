//! Drawings: paths and texts, written as SVG and as PNG.
//!
//! A [`Drawing`] is a list of shapes in px, y downwards, each over those before it, on white. Both
//! files are made of this list, so that they are one picture; the PNG has [`SCALE`] pixels a px.
//! Coordinates are rounded to 1/16 px, `floor(16 v + 1/2) / 16`, when a shape is added. Every shape
//! is opaque.
//!
//! Letters are those of DejaVu Sans, which is part of the crate, without kerning. In an SVG a text
//! stays a text, with its width beside it, so that another font takes as much room. A character that
//! the font lacks is an empty box in a PNG.
//!
//! - [`axis`]: where values lie, and round numbers for ticks.
//! - [`curve`]: errors over a sweep.
//! - [`label`]: labels that do not collide.
//! - [`log`]: logarithmic axes.
//! - [`mark`]: shapes and colours of points.
//! - [`scatter`]: points on two logarithmic axes, with their front.
//! - [`text`]: how wide texts are.
//! - [`violin`]: how values are spread.

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

pub use raster::{Picture, SCALE};
pub use svg::escaped;

/// Red, green and blue, as sRGB has them.
pub type Rgb = [u8; 3];

/// Text and axes.
pub const INK: Rgb = [0x24, 0x29, 0x2f];
/// Lines of a grid.
pub const GRID: Rgb = [0xd8, 0xde, 0xe4];
/// Colours that differ in lightness as well as in hue \[Okabe, Ito 2008\], so that they are told apart
/// by the colour-blind; a chart has a dash or a name beside each.
pub const COLORS: [Rgb; 6] = [
    [0x00, 0x72, 0xb2],
    [0xd5, 0x5e, 0x00],
    [0x00, 0x9e, 0x73],
    [0xcc, 0x79, 0xa7],
    [0xe6, 0x9f, 0x00],
    [0x56, 0xb4, 0xe9],
];
/// A dash for each of [`COLORS`]: lengths in px, drawn and left out in turn.
pub const DASHES: [&[f32]; 6] =
    [&[], &[8.0, 3.0], &[2.0, 3.0], &[10.0, 3.0, 2.0, 3.0], &[5.0, 5.0], &[14.0, 4.0]];

/// The colour of a surface that is this far, from 0 to 1, from white to a colour.
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

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// The colour.
    pub color: Rgb,
    /// The width in px.
    pub width: f32,
    /// As those of [`DASHES`].
    pub dash: &'static [f32],
}

/// Which place of a text is at the point that is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its left end.
    Start,
    /// Its middle.
    Middle,
    /// Its right end.
    End,
}

/// A text on its base line.
#[derive(Clone, Debug, PartialEq)]
pub struct Label<'a> {
    /// What it says, in one line.
    pub text: &'a str,
    /// The size of the font in px.
    pub size: f64,
    /// Where on the base line the point is.
    pub anchor: Anchor,
    /// Whether it is read from below to above.
    pub turned: bool,
}

/// What can be drawn.
#[derive(Clone, Debug, PartialEq)]
enum Shape {
    Path { points: Vec<[f64; 2]>, closed: bool, fill: Option<Rgb>, stroke: Option<Stroke> },
    Text { text: String, at: [f64; 2], size: f64, anchor: Anchor, turned: bool },
    Spot { at: [f64; 2], reach: f64, index: usize, title: String },
}

impl Stroke {
    /// A line without gaps.
    #[must_use]
    pub fn solid(color: Rgb, width: f32) -> Self {
        Self { color, width, dash: &[] }
    }
}

impl<'a> Label<'a> {
    /// A text of 13 px that is not turned.
    #[must_use]
    pub fn new(text: &'a str, anchor: Anchor) -> Self {
        Self { text, size: 13.0, anchor, turned: false }
    }
}

impl Drawing {
    /// Nothing yet. Programs that read pages aloud say the title and what it is about.
    #[must_use]
    pub fn new(size: [u32; 2], title: &str, about: &str) -> Self {
        Self { size, title: title.to_owned(), about: about.to_owned(), shapes: Vec::new() }
    }

    /// A line through points.
    pub fn line(&mut self, points: impl IntoIterator<Item = [f64; 2]>, stroke: Stroke) {
        self.path(points, false, None, Some(stroke));
    }

    /// A surface within points, and its edge.
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

    /// A disc that is not seen: in an SVG it says a title to who points at it, and which of the
    /// things that are shown it belongs to, for pages that answer a click.
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
