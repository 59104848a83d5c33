//! Writes a drawing as SVG.

use super::{Anchor, Drawing, INK, Rgb, Shape, text};
use std::fmt::Write;

impl Drawing {
    /// The whole file. It loads nothing from outside.
    #[must_use]
    pub fn svg(&self) -> String {
        let [width, height] = self.size;
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
             width=\"{width}\" height=\"{height}\" role=\"img\" \
             font-family=\"DejaVu Sans, Verdana, sans-serif\" fill=\"none\">\n\
             <title>{}</title>\n<desc>{}</desc>\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n",
            escaped(&self.title),
            escaped(&self.about)
        );
        for shape in &self.shapes {
            element(&mut out, shape);
        }
        out + "</svg>\n"
    }
}

/// Writes an element on a line of its own. Writing into a `String` cannot fail.
fn element(out: &mut String, shape: &Shape) {
    match shape {
        Shape::Path { points, closed, fill, stroke } => {
            out.push_str("<path d=\"");
            for (i, [x, y]) in points.iter().enumerate() {
                let _ = write!(out, "{}{x} {y}", if i == 0 { 'M' } else { 'L' });
            }
            out.push_str(if *closed { "Z\"" } else { "\"" });
            if let Some(fill) = fill {
                let _ = write!(out, " fill=\"{}\"", hexadecimal(*fill));
            }
            if let Some(stroke) = stroke {
                let color = hexadecimal(stroke.color);
                let _ = write!(out, " stroke=\"{color}\" stroke-width=\"{}\"", stroke.width);
                if !stroke.dash.is_empty() {
                    let dash: Vec<String> = stroke.dash.iter().map(f32::to_string).collect();
                    let _ = write!(out, " stroke-dasharray=\"{}\"", dash.join(" "));
                }
            }
            out.push_str("/>\n");
        }
        Shape::Spot { at: [x, y], reach, index, title } => {
            let title = escaped(title);
            let _ = writeln!(
                out,
                "<g data-point=\"{index}\" tabindex=\"0\" role=\"button\" aria-label=\"{title}\">\
                 <title>{title}</title><circle class=\"ring\" cx=\"{x}\" cy=\"{y}\" r=\"{reach}\" \
                 pointer-events=\"all\"/></g>"
            );
        }
        Shape::Text { text, at: [x, y], size, anchor, turned } => {
            let anchor = match anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
                Anchor::End => "end",
            };
            let place = if *turned {
                format!("transform=\"translate({x} {y}) rotate(-90)\"")
            } else {
                format!("x=\"{x}\" y=\"{y}\"")
            };
            let (width, color) = (text::width(text, *size), hexadecimal(INK));
            let _ = writeln!(
                out,
                "<text {place} font-size=\"{size}\" fill=\"{color}\" text-anchor=\"{anchor}\" \
                 textLength=\"{width:.2}\" lengthAdjust=\"spacingAndGlyphs\">{}</text>",
                escaped(text)
            );
        }
    }
}

fn hexadecimal([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Escapes text for XML and HTML.
#[must_use]
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // XML allows no other control characters, nor these two.
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}
