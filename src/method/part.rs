//! Judge a part of a picture: only the surfels that may touch it need a projection.

use crate::frame::Rect;
use crate::number::MapInline;
use crate::scene::{Camera, Surfels};
use crate::splat::{SplatSettings, View, batch};
use std::ops::Range;

/// A part of a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part<'a> {
    /// Rectangles, each with the number of the tile that it lies in.
    pub(crate) pieces: &'a [(usize, Rect)],
    /// A splat reaches at most this many times as far as its surfel.
    pub(crate) spread: f64,
}

impl Part<'_> {
    /// Whether a splat with these bounds touches the part.
    pub(crate) fn touches(&self, bounds: &Rect) -> bool {
        self.pieces.iter().any(|(_, rect)| !rect.intersection(bounds).is_empty())
    }
}

/// Finds the surfels that may touch a part. This takes a fraction of the time of a projection.
pub(crate) struct Nearby<'a> {
    part: Part<'a>,
    surfels: &'a Surfels,
    view: View<f64>,
    /// How far the low-pass filter reaches, in pixels, and a few pixels more.
    skirt: f64,
}

/// More pixels than bounds are widened by, and more than a mistake moves a splat by.
const SLACK: f64 = 2.0;

impl<'a> Nearby<'a> {
    pub(crate) fn new(
        part: Part<'a>,
        (surfels, camera): (&'a Surfels, &Camera),
        settings: &SplatSettings,
    ) -> Self {
        let kernel = &settings.kernel;
        let skirt = f64::from(kernel.cutoff) * f64::from(kernel.low_pass).sqrt();
        Self { part, surfels, view: View::new(camera), skirt: skirt + SLACK }
    }

    /// The surfels of a range that may touch the part.
    pub(crate) fn of_range(&self, range: Range<usize>) -> Vec<usize> {
        range.filter(|surfel| self.holds(*surfel)).collect()
    }

    /// Whether a surfel may touch the part. A sphere about the surfel decides it, where the sphere is
    /// far before the eye.
    fn holds(&self, surfel: usize) -> bool {
        let Self { part, view, skirt, .. } = self;
        let disc = batch::disc::<f64>(self.surfels, surfel);
        let (p, reach) = (view.point(disc.position), disc.reach() * part.spread);
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
