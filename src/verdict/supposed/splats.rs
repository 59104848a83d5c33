//! Other splats: changes of a projected splat.

use super::Supposed;
use crate::frame::Rect;
use crate::method::ewa::possible::PossibleSplat;
use crate::number::ball::Profile;
use crate::number::{Ball, Real};
use crate::splat::{Footprint, Kernel, Outline};

/// More than any nearness, in either direction.
const BEYOND: f64 = 1e28;

impl Supposed {
    /// The splat that a client with this mistake draws, in a picture of these pixels.
    #[inline(always)]
    pub(crate) fn splat<P: Profile>(
        self,
        possible: PossibleSplat<P>,
        kernel: &Kernel,
        picture: &Rect,
    ) -> PossibleSplat<P> {
        if self == Self::Nothing { possible } else { self.other(possible, kernel, picture) }
    }

    #[inline(never)]
    fn other<P: Profile>(
        self,
        mut possible: PossibleSplat<P>,
        kernel: &Kernel,
        picture: &Rect,
    ) -> PossibleSplat<P> {
        let ray_cast = kernel.outline == Outline::RayCast;
        let f = &mut possible.splat.footprint;
        match self {
            Self::Mirrored => f.uy = -f.uy,
            Self::SlopeAcross => f.wx = -f.wx,
            Self::SlopeDown => f.wy = -f.wy,
            Self::Moved([dx, dy]) => {
                f.center.x = f.center.x + Ball::from_f32(dx);
                f.center.y = f.center.y + Ball::from_f32(dy);
            }
            Self::CentersWhole => {
                let half = Ball::exact(0.5);
                (f.center.x, f.center.y) = (f.center.x.floor() + half, f.center.y.floor() + half);
                let Rect { x0, y0, x1, y1 } = possible.splat.bounds;
                let wide = Rect {
                    x0: x0.saturating_sub(1),
                    y0: y0.saturating_sub(1),
                    x1: x1 + 1,
                    y1: y1 + 1,
                };
                possible.splat.bounds = wide.intersection(picture);
            }
            Self::NoAmplitude => f.amplitude = Ball::ONE,
            Self::DepthOfCenter => (f.w_far, f.w_near) = (f.w0, f.w0),
            Self::DepthNotClamped => {
                (f.w_far, f.w_near) = (Ball::exact(-BEYOND), Ball::exact(BEYOND));
            }
            Self::Spread(by) if ray_cast => {
                for side in [&mut f.ux, &mut f.uy, &mut f.vy] {
                    *side = *side / Ball::exact(by);
                }
                possible.splat.bounds = *picture;
            }
            Self::Transposed | Self::Spread(_) | Self::FilterOnRadius if !ray_cast => {
                let shape = Shape::of_footprint(f).changed(self, kernel);
                shape.put(f);
                possible.splat.bounds = shape.bounds(f, kernel).intersection(picture);
            }
            Self::Quads(_) | Self::QuadsWhole | Self::QuadsAtMost(_) if !ray_cast => {
                let shape = Shape::of_footprint(f);
                let quad = shape.quad(f, kernel, |half| match self {
                    Self::Quads(by) => half * by,
                    Self::QuadsAtMost(most) => half.at_most(most),
                    _ => half.floor(),
                });
                let rect = quad.intersection(&possible.splat.bounds);
                possible.splat.bounds = rect;
            }
            _ => {}
        }
        let Rect { x0, y0, .. } = possible.splat.bounds;
        if possible.splat.bounds.is_empty() {
            // A record without pixels is not binned, so leave one that is outside anyway.
            let (x0, y0) = (x0.min(picture.x1 - 1), y0.min(picture.y1 - 1));
            possible.splat.bounds = Rect::pixel((x0, y0));
            possible.splat.footprint.center.x = Ball::exact(-1e9);
            possible.certain = false;
        }
        possible
    }
}

/// A Gaussian on the screen, with the low-pass filter.
struct Shape<P: Profile> {
    xx: Ball<P>,
    xy: Ball<P>,
    yy: Ball<P>,
    det: Ball<P>,
    /// The area without the filter.
    area: Ball<P>,
}

impl<P: Profile> Shape<P> {
    /// The shape that has this factor.
    fn of_footprint(f: &Footprint<Ball<P>>) -> Self {
        let yy = Ball::ONE / (f.vy * f.vy);
        let det = yy / (f.ux * f.ux);
        let xy = -((f.uy / f.ux) * yy);
        let xx = (det + xy * xy) / yy;
        Self { xx, xy, yy, det, area: f.amplitude * det.sqrt() }
    }

    fn changed(self, supposed: Supposed, kernel: &Kernel) -> Self {
        let h = Ball::from_f32(kernel.low_pass);
        let Self { xx, xy, yy, area, det } = self;
        let (h, more, by) = match supposed {
            Supposed::Transposed => return Self { xx: yy, yy: xx, xy, det, area },
            Supposed::Spread(by) => (h, h, Ball::exact(by * by)),
            _ => (h, h * (area.sqrt() * Ball::exact(2.0) + h), Ball::ONE),
        };
        // Without the filter, and with the other one.
        let (xx, xy, yy) = ((xx - h) * by, xy * by, (yy - h) * by);
        let area = area * by;
        let det = (area * area + more * (xx + yy)) + more * more;
        Self { xx: xx + more, xy, yy: yy + more, det, area }
    }

    fn put(&self, f: &mut Footprint<Ball<P>>) {
        f.ux = (self.yy / self.det).sqrt();
        f.uy = -((self.xy / self.yy) * f.ux);
        f.vy = Ball::ONE / self.yy.sqrt();
        f.amplitude = self.area / self.det.sqrt();
    }

    /// The pixels that may be inside.
    fn bounds(&self, f: &Footprint<Ball<P>>, kernel: &Kernel) -> Rect {
        self.quad(f, kernel, |half| half + 2.0)
    }

    /// The pixels whose centres lie in a rectangle around the centre. `of` gets each half side of
    /// the ellipse.
    fn quad(&self, f: &Footprint<Ball<P>>, kernel: &Kernel, of: impl Fn(f64) -> f64) -> Rect {
        let side = |center: Ball<P>, variance: Ball<P>| {
            let half = of(f64::from(kernel.cutoff) * variance.middle.sqrt());
            // The conversion saturates.
            let first = (center.middle - half - 0.5).ceil() as u32;
            let past = ((center.middle + half - 0.5).floor() + 1.0) as u32;
            [first, past]
        };
        let ([x0, x1], [y0, y1]) = (side(f.center.x, self.xx), side(f.center.y, self.yy));
        Rect { x0, y0, x1, y1 }
    }
}
