//! Judge a part of a picture: only what may touch it needs a projection.

use crate::frame::Rect;
use crate::number::{MapInline, Vector3};
use crate::scene::Camera;
use crate::splat::View;

/// A part of a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part<'a> {
    /// Rectangles, each with the number of the tile that it lies in.
    pub(crate) pieces: &'a [(usize, Rect)],
    /// A splat reaches at most this many times as far as its surfel.
    pub(crate) spread: f64,
}

/// The most pieces of a part for which what is near them is looked for.
const MOST_PIECES: usize = 32;

impl Part<'_> {
    /// Whether it pays to look for what is near: many pieces are near almost everything.
    pub(crate) fn is_small(&self) -> bool {
        self.pieces.len() <= MOST_PIECES
    }

    /// Whether a splat with these bounds touches the part.
    pub(crate) fn touches(&self, bounds: &Rect) -> bool {
        self.pieces.iter().any(|(_, rect)| !rect.intersection(bounds).is_empty())
    }
}

/// Finds what may touch a part. This takes a fraction of the time of a projection.
pub(crate) struct Nearby<'a> {
    part: Part<'a>,
    view: View<f64>,
    /// How far the low-pass filter reaches, in pixels, and a few pixels more.
    skirt: f64,
}

/// More pixels than bounds are widened by, and more than a mistake moves a splat by.
const SLACK: f64 = 2.0;

impl<'a> Nearby<'a> {
    /// What is near a part, if splats are wider by `skirt` pixels than what they show.
    pub(crate) fn new(part: Part<'a>, camera: &Camera, skirt: f64) -> Self {
        Self { part, view: View::new(camera), skirt: skirt + SLACK }
    }

    /// Whether a splat may touch the part, whose centre is here, and which reaches this far in the
    /// world. A sphere decides it, where the sphere is far before the eye.
    pub(crate) fn holds(&self, center: Vector3<f64>, reach: f64) -> bool {
        let Self { part, view, skirt } = self;
        let (p, reach) = (view.point(center), reach * part.spread);
        let t = -p.z;
        if view.perspective && !(t > 4.0 * reach) {
            return true;
        }
        // A point of the sphere is at most this far from the projected centre.
        let [m, most] = if view.perspective { [1.0 / t, 1.0 / (t - reach)] } else { [1.0; 2] };
        let side = |focal: f64, along: f64, center: f64| {
            let slope = if view.perspective { 1.0 + (along * m).abs() } else { 1.0 };
            let half = 1.02 * focal.abs() * reach * slope * most + skirt;
            let at = center + focal * along * m;
            [at - half, at + half]
        };
        let [x0, x1] = side(view.fx, p.x, view.cx);
        let [y0, y1] = side(view.fy, -p.y, view.cy);
        part.pieces.iter().any(|(_, rect)| {
            let [left, top, right, bottom] =
                [rect.x0, rect.y0, rect.x1, rect.y1].map_inline(f64::from);
            // Written so that a NaN touches.
            !(x1 < left || x0 > right || y1 < top || y0 > bottom)
        })
    }
}
