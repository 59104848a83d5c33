//! The times of a walk's frames as violins: placing, drawing, and both.

use super::axis::Axis;
use super::{Anchor, COLORS, DASHES, Drawing, GRID, INK, Label, Stroke, violin};
use crate::number::Real;

/// What a frame took, in milliseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameTimes {
    /// Choosing, reading and placing what is drawn.
    pub placing: f64,
    /// Drawing it.
    pub drawing: f64,
}

impl FrameTimes {
    /// Placing and drawing.
    #[must_use]
    pub fn frame(&self) -> f64 {
        self.placing + self.drawing
    }
}

/// The size of the chart in px.
const SIZE: [u32; 2] = [460, 330];
/// The ends of the axes: left and right, top and bottom.
const ACROSS: [f64; 2] = [64.0, 440.0];
const DOWN: [f64; 2] = [48.0, 264.0];

/// The chart of some frames, with a line at the time that was wanted.
#[must_use]
pub fn chart(frames: &[FrameTimes], wanted: f64) -> Drawing {
    let (title, note) = ("Times of frames", "Box: quartiles and median. Line: the wanted time.");
    let mut out = Drawing::new(SIZE, title, note);
    let [left, right] = ACROSS;
    out.text([left, 24.0], &Label { size: 15.0, ..Label::new(title, Anchor::Start) });
    let columns = ["placing", "drawing", "frame"];
    let of = |one: &FrameTimes| [one.placing, one.drawing, one.frame()];
    let most = frames.iter().map(FrameTimes::frame).fold(wanted, f64::at_least);
    let axis = Axis::from_zero(most, [DOWN[1], DOWN[0]]);
    for tick in axis.ticks() {
        let (y, word) = (axis.at(tick), axis.word(tick));
        out.line([[left, y], [right, y]], Stroke::solid(GRID, 1.0));
        out.text([left - 6.0, y + 4.0], &Label { size: 11.0, ..Label::new(&word, Anchor::End) });
    }
    let label = Label { size: 12.0, turned: true, ..Label::new("milliseconds", Anchor::Middle) };
    out.text([18.0, (DOWN[0] + DOWN[1]) / 2.0], &label);
    let slot = (right - left) / columns.len() as f64;
    for (i, (name, color)) in columns.into_iter().zip(COLORS).enumerate() {
        let mut times: Vec<f64> = frames.iter().map(|one| of(one)[i]).collect();
        times.sort_by(f64::total_cmp);
        let x = left + slot * (i as f64 + 0.5);
        violin::draw(&mut out, &times, &axis, x, slot / 3.0, color);
        out.text([x, DOWN[1] + 18.0], &Label::new(name, Anchor::Middle));
    }
    let y = axis.at(wanted);
    out.line([[left, y], [right, y]], Stroke { color: INK, width: 1.25, dash: DASHES[1] });
    let below = [left, DOWN[1] + 46.0];
    out.text(below, &Label { size: 11.0, ..Label::new(note, Anchor::Start) });
    out
}
