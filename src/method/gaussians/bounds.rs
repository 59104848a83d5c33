//! The pixels that a splat may touch.

use super::Support;
use super::splats::Source;
use crate::frame::Rect;
use crate::number::{Real, elementary};
use crate::splat::ray_disc::{DiscBox, RayDisc};

/// Which of the bounds of ranges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// The pixels that the bounds hold for every number of the ranges.
    Least,
    /// Those that they hold for any number.
    Most,
}

impl<R: Real> Source<'_, R> {
    /// The q/2 at which o e^(-q/2) is the least alpha: +inf if that is 0, below 0 if o is less.
    pub(crate) fn reach(&self, alpha: f64) -> f64 {
        let least = f64::from(self.settings.least_alpha);
        match (alpha < least, least > 0.0) {
            (true, _) => f64::NEG_INFINITY,
            (_, true) if alpha == 1.0 => self.opaque_reach,
            (_, true) => elementary::ln(alpha / least),
            _ => f64::INFINITY,
        }
    }

    /// The pixels that a splat of this [`Self::reach`] may touch; from ranges of its numbers, those
    /// that it may touch for any of them.
    #[inline(always)]
    pub(crate) fn bounds(
        &self,
        center: [[f64; 2]; 2],
        [xx, xy, yy]: [f64; 3],
        alpha: f64,
        reach: f64,
    ) -> Rect {
        let k = f64::from(self.settings.cutoff);
        let wide = |q: f64| {
            let side = |v: f64| (q * v).sqrt() * (1.0 + 1.0 / 1024.0) + 1.0;
            rect(center, [side(xx), side(yy)], self.size, Cover::Centers)
        };
        if reach < 0.0 {
            return Rect::default();
        }
        // A fragment beyond this has less than the least alpha.
        let dense = if reach == f64::INFINITY { self.whole() } else { wide(2.0 * reach) };
        let support = match self.settings.support {
            Support::None => dense,
            Support::Ellipse => wide(k * k),
            Support::Tiles => {
                let middle = 0.5 * (xx + yy);
                let square = middle * middle - (xx * yy - xy * xy);
                let square = if square < 0.1 { 0.1 } else { square };
                let side = (k * (middle + square.sqrt()).sqrt()).ceil();
                rect(center, [side, side], self.size, Cover::Square)
            }
            Support::Boxes if alpha * 255.0 < 1.0 => Rect::default(),
            Support::Boxes => {
                let own = (2.0 * elementary::ln(alpha * 255.0)).sqrt();
                let k = if own < k { own } else { k };
                rect(
                    center,
                    [(k * xx.sqrt()).ceil(), (k * yy.sqrt()).ceil()],
                    self.size,
                    Cover::Box,
                )
            }
        };
        support.intersection(&dense)
    }

    /// The pixels that a disc may touch, from ranges of its numbers that `ends` gives. Beyond these, the
    /// square of a half side of its tiles may be off by `slack` times the square of the box's middle.
    pub(crate) fn bounds_of_disc<S: Real>(
        &self,
        disc: &RayDisc<S>,
        ends: impl Fn(S) -> [f64; 2] + Copy,
        reach: f64,
        slack: f64,
        end: End,
    ) -> Rect {
        let k = f64::from(self.settings.cutoff);
        let boxed = |r: f64| disc.boxed(S::from_f32(r as f32));
        let around = |r: f64| self.around_disc(disc, ends, r, end);
        if reach < 0.0 {
            return Rect::default();
        }
        let dense =
            if reach == f64::INFINITY { self.whole() } else { around((2.0 * reach).sqrt()) };
        let support = match self.settings.support {
            Support::None => dense,
            Support::Ellipse => around(k),
            Support::Tiles => {
                let filter = k * f64::from(self.settings.kernel.low_pass).sqrt();
                let tiles = |[x, y]: [f64; 2]| {
                    let side = x.at_least(y).at_least(filter).ceil();
                    [side, side]
                };
                self.tiles_of_disc(&boxed(k), ends, slack, Cover::Square, end, tiles)
            }
            Support::Boxes => {
                let tiles = |[x, y]: [f64; 2]| [(k * x).ceil(), (k * y).ceil()];
                self.tiles_of_disc(&boxed(1.0), ends, slack, Cover::Box, end, tiles)
            }
        };
        support.intersection(&dense)
    }

    /// The pixels where rho may be at most r r.
    fn around_disc<S: Real>(
        &self,
        disc: &RayDisc<S>,
        ends: impl Fn(S) -> [f64; 2] + Copy,
        r: f64,
        end: End,
    ) -> Rect {
        let roomy = |side: f64| side * (1.0 + 1.0 / 1024.0) + 1.0;
        let own = disc.boxed(S::from_f32(r as f32));
        let [least, most] = ends(own.d);
        match end {
            End::Most if !(most < 0.0) => return self.whole(),
            End::Least if least >= 0.0 => return self.whole(),
            End::Least if !(most < 0.0) => return Rect::default(),
            _ => {}
        }
        let side = |square: S| roomy(ends(square)[end as usize].at_least(0.0).sqrt());
        let [xx, yy] = own.squares;
        let middle = own.middle.map(|at| end.center(ends(at)));
        let shown = rect(middle, [side(xx), side(yy)], self.size, Cover::Centers);
        let filter = [disc.filter.x, disc.filter.y].map(|at| end.center(ends(at)));
        let blurred = roomy(r * f64::from(self.settings.kernel.low_pass).sqrt());
        shown.hull(&rect(filter, [blurred; 2], self.size, Cover::Centers))
    }

    /// The tiles that a disc touches, whose box has the extents that `tiles` makes of its half sides.
    fn tiles_of_disc<S: Real>(
        &self,
        own: &DiscBox<S>,
        ends: impl Fn(S) -> [f64; 2] + Copy,
        slack: f64,
        cover: Cover,
        end: End,
        tiles: impl Fn([f64; 2]) -> [f64; 2],
    ) -> Rect {
        let middle = own.middle.map(ends);
        let side = |square: S, [least, most]: [f64; 2]| {
            let [low, high] = ends(square);
            let more = slack * (most * most).at_least(least * least);
            if end == End::Most { high + more } else { low - more }
        };
        let [x, y] = [side(own.squares[0], middle[0]), side(own.squares[1], middle[1])];
        if !middle.as_flattened().iter().chain([&x, &y]).all(|number| number.is_finite()) {
            return if end == End::Most { self.whole() } else { Rect::default() };
        }
        let half = |square: f64| square.at_least(1e-4).sqrt();
        rect(middle.map(|at| end.center(at)), tiles([half(x), half(y)]), self.size, cover)
    }

    /// The picture.
    fn whole(&self) -> Rect {
        Rect { x0: 0, y0: 0, x1: self.size[0], y1: self.size[1] }
    }
}

impl End {
    /// A range of centres as [`rect`] takes it.
    fn center(self, [least, most]: [f64; 2]) -> [f64; 2] {
        if self == Self::Most { [least, most] } else { [most, least] }
    }
}

/// The side of a tile of the original program and of gsplat, in px.
pub(super) const TILE: f64 = 16.0;

/// The pixels that an extent covers.
#[derive(Clone, Copy)]
enum Cover {
    /// Those whose centres are within it.
    Centers,
    /// The tiles that it touches, as gsplat counts them.
    Box,
    /// The tiles that it touches, as the original program counts them.
    Square,
}

/// The pixels of a picture that an extent covers, around a range of centres: (least, greatest) for x
/// and y.
#[inline(always)]
fn rect(center: [[f64; 2]; 2], extent: [f64; 2], size: [u32; 2], cover: Cover) -> Rect {
    let side = |axis: usize| {
        let [low, high] = [center[axis][0] - extent[axis], center[axis][1] + extent[axis]];
        let most = f64::from(size[axis]);
        let (first, end) = match cover {
            Cover::Centers => ((low - 0.5).ceil(), (high - 0.5).floor() + 1.0),
            Cover::Box => ((low / TILE).floor() * TILE, (high / TILE).ceil() * TILE),
            Cover::Square => {
                let [low, high] = [low - 0.5, high - 0.5 + (TILE - 1.0)];
                ((low / TILE).floor() * TILE, (high / TILE).floor() * TILE)
            }
        };
        // A comparison with NaN is false, and a cast saturates.
        if first < most && end > 0.0 { [first as u32, end.at_most(most) as u32] } else { [0, 0] }
    };
    let ([x0, x1], [y0, y1]) = (side(0), side(1));
    Rect { x0, y0, x1, y1 }
}
