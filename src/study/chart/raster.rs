//! Rasterizes a drawing.

use super::{Anchor, Drawing, INK, Rgb, Shape, Stroke, text};
use tiny_skia::{FillRule, Paint, Path, PathBuilder, Pixmap, StrokeDash, Transform};

/// Pixels of a [`Picture`] for each px of its drawing: sharp on dense screens and in print.
pub const SCALE: u32 = 2;

/// Pixels of 8 bits a channel, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// The number of columns.
    pub width: u32,
    /// The number of rows.
    pub height: u32,
    /// Red, green and blue of each pixel, in sRGB.
    pub pixels: Vec<u8>,
}

impl Drawing {
    /// The pixels; `None` if the drawing has no area, or too many pixels for 32 bits.
    #[must_use]
    pub fn picture(&self) -> Option<Picture> {
        let [width, height] = self.size.map(|side| side.saturating_mul(SCALE));
        let mut map = Pixmap::new(width, height)?;
        map.fill(tiny_skia::Color::WHITE);
        for shape in &self.shapes {
            draw(&mut map, shape);
        }
        // Every shape is opaque.
        let pixels = map.pixels().iter().flat_map(|p| [p.red(), p.green(), p.blue()]).collect();
        Some(Picture { width, height, pixels })
    }
}

fn draw(map: &mut Pixmap, shape: &Shape) {
    let scale = SCALE as f32;
    let whole = Transform::from_scale(scale, scale);
    match shape {
        Shape::Path { points, closed, fill, stroke } => {
            let mut builder = PathBuilder::new();
            for (i, [x, y]) in points.iter().map(|p| p.map(|v| v as f32)).enumerate() {
                if i == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
            }
            if *closed {
                builder.close();
            }
            let Some(path) = builder.finish() else { return };
            if let Some(fill) = fill {
                map.fill_path(&path, &paint(*fill), FillRule::Winding, whole, None);
            }
            if let Some(stroke) = stroke {
                let Stroke { color, width, dash } = *stroke;
                let dash = StrokeDash::new(dash.to_vec(), 0.0);
                let how = tiny_skia::Stroke { width, dash, ..tiny_skia::Stroke::default() };
                map.stroke_path(&path, &paint(color), &how, whole, None);
            }
        }
        Shape::Spot { .. } => {}
        Shape::Text { text, at: [x, y], size, anchor, turned } => {
            let Some((letters, units)) = letters(text) else { return };
            let width = text::width(text, *size) as f32;
            let before = match anchor {
                Anchor::Start => 0.0,
                Anchor::Middle => width / 2.0,
                Anchor::End => width,
            };
            let size = *size as f32 / units;
            // From font units to px upwards from the baseline, then to pixels.
            let line = Transform::from_row(size, 0.0, 0.0, -size, -before, 0.0);
            let quarter = Transform::from_row(0.0, -1.0, 1.0, 0.0, 0.0, 0.0);
            let line = if *turned { line.post_concat(quarter) } else { line };
            let place = line.post_translate(*x as f32, *y as f32).post_concat(whole);
            map.fill_path(&letters, &paint(INK), FillRule::Winding, place, None);
        }
    }
}

fn paint([r, g, b]: Rgb) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(r, g, b, 255);
    paint
}

/// The outline of a text, and the font size in the same units; `None` for blanks.
fn letters(text: &str) -> Option<(Path, f32)> {
    let mut letters = Letters(PathBuilder::new());
    let units = text::outline(text, &mut letters);
    letters.0.finish().map(|path| (path, units))
}

struct Letters(PathBuilder);

impl ttf_parser::OutlineBuilder for Letters {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to(x, y);
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to(x, y);
    }
    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.0.quad_to(x1, y1, x, y);
    }
    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.0.cubic_to(x1, y1, x2, y2, x, y);
    }
    fn close(&mut self) {
        self.0.close();
    }
}
