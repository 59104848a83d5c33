//! Skip fragments quickly: most are far from every limit, and `f64` with a bound on the radii shows
//! this.
//!
//! The radius of a sum or a product grows with the magnitudes and with the radii of its operands.
//! So evaluate the formulas of a fragment at the greatest offset in the splat's bounds, with all
//! terms positive. No fragment of the splat has larger radii.

use crate::composite::decide;
use crate::frame::Rect;
use crate::method::Job;
use crate::method::ewa::Settings;
use crate::method::ewa::possible::{self, PossibleSplat};
use crate::method::fragment::each_pixel;
use crate::method::prepare::Prepared;
use crate::number::ball::{Profile, Three};
use crate::number::{Ball, MapInline, Real, Truth};
use crate::splat::{Footprint, Shared, Splat};
use crate::verdict::marks::TilePart;
use crate::verdict::supposed::Supposed;

/// More than the rounding of the few operations that the bounds do not include.
const ROUNDINGS: f64 = 16.0 / 16_777_216.0;

/// The splats of a picture, each with bounds on its fragments, if there are any.
pub(crate) type SwiftSplats<P> = Prepared<Ball<P>, SwiftSplat<P>>;

/// A surfel that may be drawn, and bounds on its fragments.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SwiftSplat<P: Profile> {
    pub(super) possible: PossibleSplat<P>,
    swift: Option<Swift>,
}

/// Midpoints of a footprint, and the greatest radii of the terms of its fragments.
#[derive(Clone, Copy, Debug)]
struct Swift {
    footprint: Footprint<f64>,
    u: f64,
    v: f64,
    w: f64,
    offset: f64,
    /// Upper bounds on the least and on the greatest nearness of the disc.
    range: [f64; 2],
}

impl<P: Profile> SwiftSplat<P> {
    /// A splat with bounds on its fragments.
    pub(super) fn new(possible: PossibleSplat<P>) -> Self {
        let swift = Swift::new(&possible.splat);
        Self { possible, swift }
    }

    /// The pixels that may be inside.
    pub(super) fn bounds(&self) -> Rect {
        self.possible.splat.bounds
    }
}

/// Projects the surfels that may be drawn, by the rules that are supposed.
pub(super) fn project<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    supposed: Supposed,
) -> SwiftSplats<P> {
    let picture = job.picture();
    let record = |possible| SwiftSplat::new(supposed.splat(possible, &settings.kernel, &picture));
    possible::project_into(job, settings, record, SwiftSplat::bounds)
}

/// Projects a part of a scene. `whole` gives each of its surfels the number in the whole scene, and
/// whether the surfel certainly is drawn.
pub(crate) fn project_part<P: Profile>(
    part: &Job<'_>,
    settings: &Settings,
    whole: &[(u32, bool)],
) -> SwiftSplats<P> {
    let record = |PossibleSplat { mut splat, certain }| {
        let (surfel, sure) = whole[splat.surfel as usize];
        splat.surfel = surfel;
        SwiftSplat::new(PossibleSplat { splat, certain: certain && sure })
    };
    possible::project_into(part, settings, record, SwiftSplat::bounds)
}

/// A fragment that is not certainly outside.
pub(super) struct Fragment<'a, P: Profile> {
    pub(super) splat: &'a Splat<Ball<P>>,
    /// Whether the surfel certainly is drawn.
    pub(super) drawn: bool,
    pub(super) q: Ball<P>,
    /// The nearness of the fragment.
    w: Ball<P>,
    pub(super) inside: Three,
    shared: &'a Shared<Ball<P>>,
}

impl<P: Profile> Fragment<'_, P> {
    #[inline(always)]
    pub(super) fn depth(&self) -> Ball<P> {
        self.shared.depth(self.w)
    }

    /// The greatest possible nearness.
    #[inline(always)]
    pub(super) fn most_near(&self) -> f64 {
        self.w.middle + self.w.radius
    }

    /// How certain the cut-off decision is: the distance of q from its limit.
    pub(super) fn margin(&self) -> f64 {
        self.q.distance(self.shared.limit)
    }

    /// q divided by its limit.
    pub(super) fn rim(&self) -> f64 {
        self.q.middle / self.shared.limit.middle
    }

    #[inline(always)]
    pub(super) fn is_of(&self, surfel: Option<u32>) -> bool {
        surfel == Some(self.splat.surfel)
    }
}

/// Runs `visit` for the fragments of the pixels of a rectangle in a tile. It skips fragments that
/// certainly are outside, and fragments whose nearness certainly is below `least` of their pixel.
/// Every nearness is below +inf, and none is below NaN.
#[inline(always)]
pub(super) fn each_fragment<P: Profile>(
    splats: &SwiftSplats<P>,
    TilePart { tile, rect }: TilePart,
    least: impl Fn(usize) -> f64,
    mut visit: impl FnMut(&Fragment<'_, P>, usize),
) {
    let shared = &splats.shared;
    let limit = shared.limit.middle + shared.limit.radius;
    let (mut asked, mut columns) = (Vec::new(), Vec::new());
    splats.for_each(tile, |SwiftSplat { possible, swift }| {
        let PossibleSplat { splat, certain } = possible;
        asked.clear();
        each_pixel(splat, &rect, |pixel, at| {
            let least = least(pixel);
            // Written so that a NaN does not fail: both comparisons are false.
            let fails = |swift: &Swift| {
                let (q, w) = swift.fragment(shared, at);
                q > limit || w < least
            };
            if !(least == f64::INFINITY || swift.as_ref().is_some_and(fails)) {
                asked.push((pixel, at));
            }
        });
        if asked.is_empty() {
            return;
        }
        // Compute once everything that fragments of a column or a row share.
        let f = &splat.footprint;
        let offset = |at: u32, center: Ball<P>| Ball::from_f32(at as f32 + 0.5) - center;
        let Rect { x0, x1, .. } = splat.bounds.intersection(&rect);
        columns.clear();
        columns.extend((x0..x1).map(|x| f.column(offset(x, f.center.x))));
        for in_row in asked.chunk_by(|a, b| a.1.1 == b.1.1) {
            let row = f.row(offset(in_row[0].1.1, f.center.y));
            for &(pixel, (x, _)) in in_row {
                let (q, w) = f.crossing(shared, &columns[(x - x0) as usize], &row);
                let inside = decide::inside(q, shared.limit);
                if inside.possibly() {
                    visit(&Fragment { splat, drawn: *certain, q, w, inside, shared }, pixel);
                }
            }
        }
    });
}

/// The least nearness whose depth may be at most this one.
#[inline(always)]
pub(super) fn least_nearness<P: Profile>(shared: &Shared<Ball<P>>, depth: Ball<P>) -> f64 {
    let farthest = depth.middle + depth.radius;
    // A number that is not certain skips nothing, because comparisons with NaN are false.
    if !shared.perspective {
        -farthest - farthest.abs() * ROUNDINGS
    } else if farthest > 0.0 {
        (1.0 - ROUNDINGS) / farthest
    } else {
        f64::NAN
    }
}

impl Swift {
    /// The bounds of a splat; none if a radius is unbounded.
    fn new<P: Profile>(splat: &Splat<Ball<P>>) -> Option<Self> {
        let Splat { footprint: f, bounds, .. } = splat;
        let x = widest([bounds.x0, bounds.x1 - 1], f.center.x);
        let y = widest([bounds.y0, bounds.y1 - 1], f.center.y);
        // Written out because `map` is not inlined.
        let (ux, uy, vy) = (f.ux.magnitude(), f.uy.magnitude(), f.vy.magnitude());
        let (w0, wx, wy) = (f.w0.magnitude(), f.wx.magnitude(), f.wy.magnitude());
        let swift = Self {
            footprint: f.map(|number| number.middle),
            u: (ux * x + uy * y).radius,
            v: (vy * y).radius,
            w: ((w0 + wx * x) + wy * y).radius,
            offset: x.radius.at_least(y.radius),
            range: [f.w_far.middle + f.w_far.radius, f.w_near.middle + f.w_near.radius],
        };
        let sum = swift.u + swift.v + swift.w + swift.offset + swift.range[0] + swift.range[1];
        sum.is_finite().then_some(swift)
    }

    /// The least possible q of a fragment, and its greatest possible nearness.
    #[inline(always)]
    fn fragment<P: Profile>(&self, shared: &Shared<Ball<P>>, (x, y): (u32, u32)) -> (f64, f64) {
        let f = &self.footprint;
        let dx = f64::from(x as f32 + 0.5) - f.center.x;
        let dy = f64::from(y as f32 + 0.5) - f.center.y;
        let u = square((f.ux * dx + f.uy * dy).abs() - self.u);
        let v = square((f.vy * dy).abs() - self.v);
        let form = u + v;
        let w = f.plane(dx, dy);
        let q = if shared.ray_cast { self.ray_cast(shared, form, w, [dx, dy]) } else { form };
        let [farthest, nearest] = self.range;
        (q * (1.0 - ROUNDINGS), (w + self.w).at_least(farthest).at_most(nearest))
    }

    /// The least q, either of the disc by ray casting or of the low-pass filter.
    fn ray_cast<P: Profile>(
        &self,
        shared: &Shared<Ball<P>>,
        form: f64,
        w: f64,
        offset: [f64; 2],
    ) -> f64 {
        let reach = w.abs() + self.w;
        let disc = if shared.perspective { form / (reach * reach) } else { form };
        if shared.low_pass.middle > 0.0 {
            let [x, y] = offset.map_inline(|offset| square(offset.abs() - self.offset));
            disc.at_most((x + y) / shared.low_pass.middle)
        } else {
            disc
        }
    }
}

/// The square of a number; 0 if the number is below 0.
#[inline(always)]
fn square(value: f64) -> f64 {
    let value = value.at_least(0.0);
    value * value
}

/// The greatest offset of two columns, or rows, from a centre, with the greatest radius.
#[inline(always)]
fn widest<P: Profile>(ends: [u32; 2], center: Ball<P>) -> Ball<P> {
    let offset = |end: u32| Ball::from_f32(end as f32 + 0.5) - center;
    let (a, b) = (offset(ends[0]), offset(ends[1]));
    Ball::new(a.middle.abs().at_least(b.middle.abs()), a.radius.at_least(b.radius))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::Method;
    use crate::number::ball::{Gpu, Ieee};
    use crate::splat::fragment;
    use crate::verdict::ewa::tests::each_scene;

    /// Compares every fragment of a scene's splats with its bounds. Returns how many fragments
    /// there are, and how many the bounds skip.
    fn compare<P: Profile>(job: &Job<'_>, settings: &Settings) -> [usize; 2] {
        let splats = project::<P>(job, settings, Supposed::Nothing);
        let shared = &splats.shared;
        let mut found = [0; 2];
        for (tile, rect) in job.grid().rects().into_iter().enumerate() {
            splats.for_each(tile, |SwiftSplat { possible, swift }| {
                let swift = swift.expect("the bounds of these scenes are finite");
                let f = &possible.splat.footprint;
                each_pixel(&possible.splat, &rect, |_, at| {
                    let dx = Ball::from_f32(at.0 as f32 + 0.5) - f.center.x;
                    let dy = Ball::from_f32(at.1 as f32 + 0.5) - f.center.y;
                    assert!((f.ux * dx + f.uy * dy).radius <= swift.u);
                    assert!((f.vy * dy).radius <= swift.v);
                    assert!(f.plane(dx, dy).radius <= swift.w);
                    let (q, w) = fragment(shared, f, at);
                    let crossing = f.crossing(shared, &f.column(dx), &f.row(dy));
                    for (a, b) in [(crossing.0, q), (crossing.1, w)] {
                        assert_eq!(a.middle.to_bits(), b.middle.to_bits());
                        assert_eq!(a.radius.to_bits(), b.radius.to_bits());
                    }
                    let (least, most) = swift.fragment(shared, at);
                    assert!(least <= q.middle && most >= w.middle);
                    let limit = shared.limit.middle;
                    if least > limit {
                        assert!(!decide::inside(q, shared.limit).certainly());
                    }
                    found[0] += 1;
                    found[1] += usize::from(least > limit);
                });
            });
        }
        found
    }

    #[test]
    fn no_radius_exceeds_its_bound() {
        each_scene(|session, camera| {
            let Method::Ewa(settings) = *session.method() else { return };
            session.with_job(camera, |job| {
                for [all, outside] in
                    [compare::<Ieee>(job, &settings), compare::<Gpu>(job, &settings)]
                {
                    assert!(all > 1000 && outside > all / 20, "{outside} of {all}");
                }
            });
        });
    }
}
