//! The rays of a rectangle of pixels.

use super::triangles::Reach;
use crate::frame::Rect;
use crate::scene::Camera;

/// Rays in rows: this many places along each side of a pixel, and more before the first pixel to
/// the left and above.
///
/// Ray i of n places a pixel, with m before, is at the place X = X0 + (i - m + 1/2) / n of pixels
/// that begin at X0. Its x is (X - cx) / fx, and its y is -(Y - cy) / fy.
#[derive(Clone, Debug)]
pub(super) struct Rays {
    /// Ascending.
    pub(super) x: Vec<f64>,
    /// Descending.
    pub(super) y: Vec<f64>,
    columns: Axis,
    rows: Axis,
}

/// The places along one axis.
#[derive(Clone, Copy, Debug)]
struct Axis {
    /// The first pixel.
    from: f64,
    samples: f64,
    before: f64,
    focal: f64,
    center: f64,
}

impl Rays {
    pub(super) fn new(camera: &Camera, rect: &Rect, samples: u32, before: u32) -> Self {
        let axis = |from: u32, focal: f32, center: f32| Axis {
            from: from.into(),
            samples: samples.into(),
            before: before.into(),
            focal: focal.into(),
            center: center.into(),
        };
        let columns = axis(rect.x0, camera.fx, camera.cx);
        let rows = axis(rect.y0, camera.fy, camera.cy);
        let places = |axis: &Axis, pixels: usize| {
            (0..pixels * samples as usize + before as usize).map(|i| axis.at(i)).collect::<Vec<_>>()
        };
        let x = places(&columns, rect.columns());
        let y = places(&rows, rect.rows()).into_iter().map(|y| -y).collect();
        Self { x, y, columns, rows }
    }

    /// How far the rays of a picture reach, with the rays before it.
    pub(super) fn reach(camera: &Camera) -> Reach {
        let most = |size: u32, focal: f32, center: f32| {
            let [focal, center] = [focal, center].map(f64::from);
            let [first, last] = [-1.0, f64::from(size)].map(|v| ((v - center) / focal).abs());
            if first > last { first } else { last }
        };
        Reach {
            x: most(camera.width, camera.fx, camera.cx),
            y: most(camera.height, camera.fy, camera.cy),
        }
    }

    /// The number of rays.
    pub(super) fn len(&self) -> usize {
        self.x.len() * self.y.len()
    }

    /// x and y of each ray, and its number, row by row.
    pub(super) fn each(&self) -> impl Iterator<Item = (usize, [f64; 2])> {
        let rows = self.y.iter().flat_map(|&y| self.x.iter().map(move |&x| [x, y]));
        rows.enumerate()
    }

    /// The columns within bounds in px, the end exclusive.
    pub(super) fn columns(&self, [low, high]: [f64; 2]) -> [usize; 2] {
        let place = |px: f64| self.columns.place(px);
        within([place(low), place(high)], [0, self.x.len()])
    }

    /// The rows within bounds in px.
    pub(super) fn rows(&self, [low, high]: [f64; 2]) -> [usize; 2] {
        let place = |px: f64| self.rows.place(px);
        within([place(low), place(high)], [0, self.y.len()])
    }

    /// The rays of some columns whose x is in a range.
    #[inline(always)]
    pub(super) fn span(&self, range: [f64; 2], columns: [usize; 2]) -> [usize; 2] {
        let axis = &self.columns;
        let place = |x: f64| axis.place(x * axis.focal + axis.center);
        within([place(range[0]), place(range[1])], columns)
    }
}

impl Axis {
    fn at(&self, i: usize) -> f64 {
        let place = self.from + (i as f64 - self.before + 0.5) / self.samples;
        (place - self.center) / self.focal
    }

    /// The fractional number of the ray at a place in px.
    #[inline(always)]
    fn place(&self, px: f64) -> f64 {
        (px - self.from) * self.samples + self.before - 0.5
    }
}

/// The integers of a range between these numbers, or less than [`SLACK`] beyond.
#[inline(always)]
fn within([low, high]: [f64; 2], [first, end]: [usize; 2]) -> [usize; 2] {
    let (low, high) = (-(SLACK - low).floor(), (high + SLACK).floor() + 1.0);
    let low =
        if low > first as f64 { if low < end as f64 { low as usize } else { end } } else { first };
    let high =
        if high < end as f64 { if high > low as f64 { high as usize } else { low } } else { end };
    [low, high]
}

/// Rounding moves no place by this much, in places.
const SLACK: f64 = 1.0 / 1024.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_between_bounds() {
        let inf = f64::INFINITY;
        assert_eq!(within([2.5, 4.5], [0, 9]), [3, 5]);
        assert_eq!(within([3.0, 4.0], [0, 9]), [3, 5]);
        assert_eq!(within([-7.0, 99.0], [2, 9]), [2, 9]);
        assert_eq!(within([-inf, inf], [2, 9]), [2, 9]);
        assert_eq!(within([f64::NAN, f64::NAN], [2, 9]), [2, 9]);
        for nothing in [[5.2, 5.8], [-9.0, -8.0], [40.0, 50.0], [6.0, 3.0], [inf, -inf]] {
            let [first, end] = within(nothing, [2, 9]);
            assert!(first == end && first >= 2 && end <= 9, "{nothing:?}");
        }
    }
}
