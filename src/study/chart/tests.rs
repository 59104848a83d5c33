use super::axis::Axis;
use super::violin::{density, quantile};
use super::*;
use crate::number::elementary::exp;

impl Drawing {
    /// The texts, with the left, top, right and bottom of each.
    pub(crate) fn boxes(&self) -> Vec<(&str, [f64; 4])> {
        let of = |shape| match shape {
            &Shape::Text { ref text, at: [x, y], size, anchor, turned } => {
                let width = text::width(text, size);
                let before = match anchor {
                    Anchor::Start => 0.0,
                    Anchor::Middle => width / 2.0,
                    Anchor::End => width,
                };
                let (above, below) = (0.76 * size, 0.24 * size);
                Some((
                    text.as_str(),
                    if turned {
                        [x - above, y + before - width, x + below, y + before]
                    } else {
                        [x - before, y - above, x - before + width, y + below]
                    },
                ))
            }
            Shape::Path { .. } | Shape::Spot { .. } => None,
        };
        self.shapes.iter().filter_map(of).collect()
    }

    /// Asserts that texts lie inside the drawing and do not overlap.
    pub(crate) fn assert_readable(&self) {
        let boxes = self.boxes();
        let [width, height] = self.size.map(f64::from);
        for (i, (text, [left, top, right, bottom])) in boxes.iter().enumerate() {
            let inside = *left >= 0.0 && *top >= 0.0 && *right <= width && *bottom <= height;
            assert!(inside, "{text} leaves the drawing: {left} {top} {right} {bottom}");
            for (other, [l, t, r, b]) in &boxes[..i] {
                let apart = l >= right || left >= r || t >= bottom || top >= b;
                assert!(apart, "{text} and {other} collide");
            }
        }
    }
}

fn pixel(picture: &Picture, x: u32, y: u32) -> [u8; 3] {
    let at = 3 * (y * picture.width + x) as usize;
    picture.pixels[at..at + 3].try_into().unwrap()
}

#[test]
fn a_shape_is_at_its_place_in_both_files() {
    let mut drawing = Drawing::new([20, 10], "a", "b");
    drawing.surface([[2.0, 1.0], [6.03, 1.0], [6.03, 4.0], [2.0, 4.0]], COLORS[0], None);
    drawing.line([[0.0, 8.0], [20.0, 8.0]], Stroke { color: INK, width: 2.0, dash: &[4.0, 4.0] });
    let svg = drawing.svg();
    for element in [
        "viewBox=\"0 0 20 10\" width=\"20\" height=\"10\"",
        "<path d=\"M2 1L6 1L6 4L2 4Z\" fill=\"#0072b2\"/>",
        "<path d=\"M0 8L20 8\" stroke=\"#24292f\" stroke-width=\"2\" stroke-dasharray=\"4 4\"/>",
    ] {
        assert!(svg.contains(element), "{element} in {svg}");
    }
    let picture = drawing.picture().unwrap();
    assert_eq!((picture.width, picture.height, picture.pixels.len()), (40, 20, 2400));
    for y in 0..20 {
        for x in 0..40 {
            let square = (4..12).contains(&x) && (2..8).contains(&y);
            let dash = (14..18).contains(&y) && x % 16 < 8;
            let right = if square {
                COLORS[0]
            } else if dash {
                INK
            } else {
                [255; 3]
            };
            assert_eq!(pixel(&picture, x, y), right, "{x} {y}");
        }
    }
    assert_eq!(Drawing::new([0, 9], "", "").picture(), None);
}

#[test]
fn texts_are_no_markup_and_nothing_is_loaded() {
    let hostile = "<script>\"a\" & b</script>\u{1b}\u{ffff}";
    let mut drawing = Drawing::new([300, 40], hostile, hostile);
    drawing.text([10.0, 20.0], &Label::new(hostile, Anchor::Start));
    let svg = drawing.svg();
    let shown = "&lt;script&gt;&quot;a&quot; &amp; b&lt;/script&gt;\u{fffd}\u{fffd}";
    assert_eq!(svg.matches(shown).count(), 3, "{svg}");
    let addresses = svg.matches("://").count();
    assert_eq!((addresses, svg.matches("href").count(), svg.matches("url(").count()), (1, 0, 0));
    assert!(!svg.contains('\u{1b}'));
}

/// The letter l of DejaVu Sans is an upright bar; a turned l lies flat.
#[test]
fn letters_stand_on_their_line_and_are_turned() {
    let ink = |turned, anchor| {
        let mut drawing = Drawing::new([40, 40], "", "");
        drawing.text([20.0, 20.0], &Label { size: 20.0, turned, ..Label::new("l", anchor) });
        let picture = drawing.picture().unwrap();
        let dark = |x: u32, y: u32| pixel(&picture, x, y)[1] < 128;
        let all = (0..80).flat_map(|y| (0..80).map(move |x| (x, y)));
        let all: Vec<_> = all.filter(|&(x, y)| dark(x, y)).collect();
        let (xs, ys): (Vec<u32>, Vec<u32>) = all.into_iter().unzip();
        [*xs.iter().min().unwrap(), *xs.iter().max().unwrap(), ys[0], ys[ys.len() - 1]]
    };
    let [left, right, top, bottom] = ink(false, Anchor::Start);
    assert!(
        left >= 40 && right < 52 && (8..12).contains(&top) && bottom == 39,
        "{left} {right} {top} {bottom}"
    );
    let [left, right, ..] = ink(false, Anchor::End);
    assert!(left > 28 && right < 40, "{left} {right}");
    let [left, right, top, bottom] = ink(true, Anchor::Middle);
    assert!((8..12).contains(&left) && right == 39, "{left} {right}");
    assert!(top >= 34 && bottom <= 46, "{top} {bottom}");
}

#[test]
fn widths_are_those_of_the_font() {
    // Advances of DejaVu Sans, of 2048 units.
    for (text, units) in
        [("l", 569), ("W", 2025), ("0", 1303), ("\u{2264}", 1716), ("a b", 1255 + 651 + 1300)]
    {
        assert_eq!(text::width(text, 2048.0), f64::from(units), "{text}");
    }
    let missing = text::width("\u{4e00}", 10.0);
    for c in ' '..='~' {
        let lacks = text::width(&c.to_string(), 10.0) == missing && c.is_alphanumeric();
        assert!(!lacks, "{c}");
    }
    let name = "a-long-name-of-a-file";
    assert_eq!(text::shortened(name, 11.0, 500.0), name);
    let short = text::shortened(name, 11.0, 60.0);
    assert!(short.ends_with('\u{2026}') && text::width(&short, 11.0) <= 60.0, "{short}");
}

#[test]
fn axes_have_round_numbers() {
    let of = |most| Axis::from_zero(most, [100.0, 0.0]);
    let axis = of(2.31);
    assert_eq!((axis.values, axis.at(0.0), axis.at(2.5)), ([0.0, 2.5], 100.0, 0.0));
    let words = |axis: &Axis| axis.ticks().iter().map(|t| axis.word(*t)).collect::<Vec<_>>();
    assert_eq!(words(&axis), ["0.0", "0.5", "1.0", "1.5", "2.0", "2.5"]);
    assert_eq!(words(&of(7.0)).len(), 8);
    assert_eq!(words(&of(0.031)).last().unwrap(), "0.035");
    for bad in [0.0, 1e300, f64::INFINITY, f64::NAN] {
        assert!(of(bad).ticks().len() < 20, "{bad}");
    }
}

#[test]
fn quantiles_and_densities_by_hand() {
    let values: Vec<f64> = (0..8).map(f64::from).collect();
    assert_eq!(
        [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| quantile(&values, t)),
        [0.0, 2.0, 4.0, 6.0, 7.0]
    );
    assert!(density(&[]).is_empty() && density(&[1.0]).is_empty() && density(&[2.0; 9]).is_empty());
    // The inverse of the triangle's distribution: least and greatest are rare, 1/2 is not.
    let triangle = |i: i32| {
        let u = (f64::from(i) + 0.5) / 20_000.0;
        if u < 0.5 { (u / 2.0).sqrt() } else { 1.0 - ((1.0 - u) / 2.0).sqrt() }
    };
    let found = density(&(0..20_000).map(triangle).collect::<Vec<_>>());
    assert_eq!((found.len(), found[64][1]), (129, 1.0));
    for [v, d] in &found[8..121] {
        let right = 1.0 - 2.0 * (v - 0.5).abs();
        assert!((d - right).abs() < 0.05, "{d} at {v}, not {right}");
    }
    // Two values: two bells of the width 0.9 s 2^(-1/5), s = 1 as their quartiles are 2 apart over 1.34.
    let found = density(&[-1.0, 1.0]);
    let h = 0.9 * crate::number::elementary::pow(2.0, -0.2);
    let bells = |v: f64| {
        exp(-((v + 1.0) / h) * ((v + 1.0) / h) / 2.0)
            + exp(-((v - 1.0) / h) * ((v - 1.0) / h) / 2.0)
    };
    let most = found.iter().map(|[v, _]| bells(*v)).fold(0.0, |a, b| if b > a { b } else { a });
    assert!(found.iter().all(|[v, d]| (d - bells(*v) / most).abs() < 1e-12), "{found:?}");
}

/// Simulated by the matrices of Viénot, Brettel and Mollon (1999), on linear light.
#[test]
fn the_colour_blind_tell_colours_apart() {
    let linear = |c: u8| crate::number::srgb::to_linear(f64::from(c) / 255.0);
    let seen = |color: Rgb, [a, b, c]: [f64; 3]| {
        let [r, g, blue] = color.map(linear);
        let yellow = a * r + b * g;
        [yellow, yellow, c * (r - g) + blue].map(crate::number::srgb::from_linear)
    };
    for matrix in [[0.11238, 0.88762, 0.00401], [0.29275, 0.70725, -0.02234]] {
        for (i, one) in COLORS.iter().enumerate() {
            for other in &COLORS[..i] {
                let (a, b) = (seen(*one, matrix), seen(*other, matrix));
                let apart: f64 = (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum();
                assert!(apart.sqrt() > 0.12, "{one:?} and {other:?} are {}", apart.sqrt());
            }
        }
    }
}
