//! Most fragments are far from every limit: bounds of the radii of all fragments of a splat, by which
//! these are told in `f64`.
//!
//! The radius of a sum or a product grows with the magnitudes and with the radii of its operands. So
//! the formulas of a fragment at the greatest offset in the splat's bounds, all terms positive, have
//! radii that no fragment of the splat exceeds.

use crate::composite::decide;
use crate::frame::Rect;
use crate::method::Job;
use crate::method::ewa::Settings;
use crate::method::ewa::possible::{self, PossibleSplat};
use crate::method::fragment::each_pixel;
use crate::method::prepare::Prepared;
use crate::number::ball::{Profile, Three};
use crate::number::{Ball, Real, Truth};
use crate::splat::{Footprint, Shared, Splat};

/// More than what the few operations round that are not in the bounds.
const ROUNDINGS: f64 = 16.0 / 16_777_216.0;

/// The splats of a picture, each with the bounds of its fragments, if it has any.
pub(crate) type SwiftSplats<P> = Prepared<Ball<P>, SwiftSplat<P>>;

/// A surfel that may be drawn, and bounds of its fragments.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SwiftSplat<P: Profile> {
    pub(super) possible: PossibleSplat<P>,
    swift: Option<Swift>,
}

/// Midpoints of a footprint, and the greatest radii of what its fragments are made of.
#[derive(Clone, Copy, Debug)]
struct Swift {
    footprint: Footprint<f64>,
    u: f64,
    v: f64,
    w: f64,
    offset: f64,
    /// The greatest that the least nearness of the disc may be, and its greatest.
    range: [f64; 2],
}

impl<P: Profile> SwiftSplat<P> {
    /// A splat with the bounds of its fragments.
    pub(super) fn new(possible: PossibleSplat<P>) -> Self {
        let swift = Swift::new(&possible.splat);
        Self { possible, swift }
    }

    /// The pixels that can be inside.
    pub(super) fn bounds(&self) -> Rect {
        self.possible.splat.bounds
    }
}

/// Projects the surfels that may be drawn.
pub(super) fn project<P: Profile>(job: &Job<'_>, settings: &Settings) -> SwiftSplats<P> {
    possible::project_into(job, settings, SwiftSplat::new, SwiftSplat::bounds)
}

/// The same of a part of a scene: of each of its surfels the number in the whole, and whether it certainly is
/// one of those that are drawn.
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
    /// The nearness.
    w: Ball<P>,
    pub(super) inside: Three,
    shared: &'a Shared<Ball<P>>,
}

impl<P: Profile> Fragment<'_, P> {
    #[inline(always)]
    pub(super) fn depth(&self) -> Ball<P> {
        self.shared.depth(self.w)
    }

    /// The greatest nearness.
    #[inline(always)]
    pub(super) fn most_near(&self) -> f64 {
        self.w.middle + self.w.radius
    }

    /// How certain it is whether the fragment is inside: the distance of q and its limit.
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

/// Runs `visit` for the fragments of the pixels of a rectangle in a tile that are not certainly
/// outside, nor certainly of a nearness below `least` of their pixel; +inf is above all, and NaN below.
#[inline(always)]
pub(super) fn each_fragment<P: Profile>(
    splats: &SwiftSplats<P>,
    (tile, rect): (usize, &Rect),
    least: impl Fn(usize) -> f64,
    mut visit: impl FnMut(&Fragment<'_, P>, usize),
) {
    let shared = &splats.shared;
    let limit = shared.limit.middle + shared.limit.radius;
    let (mut asked, mut columns) = (Vec::new(), Vec::new());
    splats.for_each(tile, |SwiftSplat { possible, swift }| {
        let PossibleSplat { splat, certain } = possible;
        asked.clear();
        each_pixel(splat, rect, |pixel, at| {
            let least = least(pixel);
            // Comparisons that NaN fails.
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
        // What fragments share is computed once.
        let f = &splat.footprint;
        let offset = |at: u32, center: Ball<P>| Ball::from_f32(at as f32 + 0.5) - center;
        let Rect { x0, x1, .. } = splat.bounds.intersection(rect);
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

/// The least nearness of which a depth may be at most this one.
#[inline(always)]
pub(super) fn least_nearness<P: Profile>(shared: &Shared<Ball<P>>, depth: Ball<P>) -> f64 {
    let farthest = depth.middle + depth.radius;
    // Any number that is not certain leaves nothing out: comparisons with NaN are false.
    if !shared.perspective {
        -farthest - farthest.abs() * ROUNDINGS
    } else if farthest > 0.0 {
        (1.0 - ROUNDINGS) / farthest
    } else {
        f64::NAN
    }
}

impl Swift {
    /// The bounds of a splat; none if a radius is not bounded.
    fn new<P: Profile>(splat: &Splat<Ball<P>>) -> Option<Self> {
        let Splat { footprint: f, bounds, .. } = splat;
        let x = widest([bounds.x0, bounds.x1 - 1], f.center.x);
        let y = widest([bounds.y0, bounds.y1 - 1], f.center.y);
        // Not by `map`, which is not inlined.
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

    /// The least q of a fragment, and its greatest nearness.
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

    /// The least q of the disc by ray casting, or of the low-pass filter.
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
            let [x, y] = offset.map(|offset| square(offset.abs() - self.offset));
            disc.at_most((x + y) / shared.low_pass.middle)
        } else {
            disc
        }
    }
}

/// The square of a number, of one below 0 nothing.
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

    /// Every fragment of a scene's splats against its bounds; how many fragments, and how many the
    /// bounds leave out.
    fn compare<P: Profile>(job: &Job<'_>, settings: &Settings) -> [usize; 2] {
        let splats = project::<P>(job, settings);
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
