//! The font of charts: widths and outlines of texts.

use std::sync::LazyLock;
use ttf_parser::{Face, GlyphId};

/// Its licence is the file `LICENSE.dejavu` beside it.
static FACE: LazyLock<Face<'static>> = LazyLock::new(|| {
    Face::parse(include_bytes!("dejavu-sans.ttf"), 0).expect("a font that the tests have read")
});

/// The width of a text in px at a font size of `size` px: the sum of its advances.
#[must_use]
pub fn width(text: &str, size: f64) -> f64 {
    text.chars().map(|c| advance(c, size)).sum()
}

/// The text, or as much of its start as fits into `room` px with an ellipsis behind it.
#[must_use]
pub fn shortened(text: &str, size: f64, room: f64) -> String {
    if width(text, size) <= room {
        return text.to_owned();
    }
    let mut left = room - width("\u{2026}", size);
    let fits = |c: &char| {
        left -= advance(*c, size);
        left >= 0.0
    };
    text.chars().take_while(fits).chain(['\u{2026}']).collect()
}

fn advance(c: char, size: f64) -> f64 {
    let units = FACE.glyph_hor_advance(glyph(c)).unwrap_or(0);
    f64::from(units) * size / f64::from(FACE.units_per_em())
}

/// The glyph of a character; 0 is the box for a character that the font lacks.
fn glyph(c: char) -> GlyphId {
    FACE.glyph_index(c).unwrap_or(GlyphId(0))
}

/// Builds the outline of a text. Its baseline begins at the origin, y points up, and the unit is
/// the font's.
pub(super) fn outline(text: &str, builder: &mut impl ttf_parser::OutlineBuilder) -> f32 {
    let mut x = 0.0;
    for c in text.chars() {
        FACE.outline_glyph(glyph(c), &mut Moved { to: builder, x });
        x += f32::from(FACE.glyph_hor_advance(glyph(c)).unwrap_or(0));
    }
    f32::from(FACE.units_per_em())
}

/// Moves the start of the outline to the right.
struct Moved<'a, B> {
    to: &'a mut B,
    x: f32,
}

impl<B: ttf_parser::OutlineBuilder> ttf_parser::OutlineBuilder for Moved<'_, B> {
    fn move_to(&mut self, x: f32, y: f32) {
        self.to.move_to(self.x + x, y);
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.to.line_to(self.x + x, y);
    }
    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.to.quad_to(self.x + x1, y1, self.x + x, y);
    }
    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.to.curve_to(self.x + x1, y1, self.x + x2, y2, self.x + x, y);
    }
    fn close(&mut self) {
        self.to.close();
    }
}
